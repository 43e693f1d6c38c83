//! When an LED shines: always, or a bit of its code word after the other.

/// The signal of one LED over time.
#[derive(Clone, Debug, PartialEq)]
pub struct Blink {
    word: Vec<bool>,
    bit_s: f64,
    shift_s: f64,
}

impl Blink {
    /// An LED that repeats `word`, `rate_hz` bits per second on the camera's clock, the first bit beginning at
    /// `-shift_s`; `None` for an empty word or a rate that is not positive.
    pub fn new(word: Vec<bool>, rate_hz: f64, shift_s: f64) -> Option<Self> {
        let legal = !word.is_empty() && rate_hz.is_finite() && rate_hz > 0.0 && shift_s.is_finite();
        legal.then(|| Self { word, bit_s: 1.0 / rate_hz, shift_s })
    }

    /// Which share of the time between two instants the LED shines, 0 to 1.
    pub fn share(&self, from_s: f64, to_s: f64) -> f64 {
        let duration_s = to_s - from_s;
        if duration_s <= 0.0 {
            return 0.0;
        }
        let (from, to) = ((from_s + self.shift_s) / self.bit_s, (to_s + self.shift_s) / self.bit_s);
        let mut on = 0.0;
        let mut bit = from.floor();
        while bit < to {
            let index = bit.rem_euclid(self.word.len() as f64) as usize;
            if self.word[index.min(self.word.len() - 1)] {
                on += to.min(bit + 1.0) - from.max(bit);
            }
            bit += 1.0;
        }
        (on / (to - from)).clamp(0.0, 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_led_that_switches_during_the_exposure_gives_part_of_its_light() {
        let blink = Blink::new(vec![true, false, false], 50.0, 0.0).unwrap();
        assert!((blink.share(0.001, 0.002) - 1.0).abs() < 1e-9);
        assert!((blink.share(0.0195, 0.0205) - 0.5).abs() < 1e-9, "half in bit 0, half in bit 1");
        assert!((blink.share(0.0597, 0.0607) - 0.7).abs() < 1e-9, "the word begins again at 60 ms");
        assert!((blink.share(-0.0002, 0.0008) - 0.8).abs() < 1e-9, "before time 0 comes the last bit");
        let over_two_words = blink.share(0.0, 0.12);
        assert!((over_two_words - 1.0 / 3.0).abs() < 1e-9);
    }

    #[test]
    fn a_clock_shift_moves_the_bits() {
        let blink = Blink::new(vec![true, false], 60.0, 1.0 / 120.0).unwrap();
        assert!((blink.share(0.0, 1.0 / 60.0) - 0.5).abs() < 1e-9);
        assert_eq!(Blink::new(vec![], 60.0, 0.0), None);
        assert_eq!(Blink::new(vec![true], 0.0, 0.0), None);
    }
}
