//! When an LED shines: always, or a bit of its code word after the other.

use crate::snapshot::Lit;

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

    /// When it shines during a span that begins at `start_s`.
    pub fn light(&self, start_s: f64, span_s: f64, lit: &mut Lit) {
        let first = ((start_s + self.shift_s) / self.bit_s).floor();
        let mut shines = self.bit(first);
        lit.restart(shines);
        // counted, so that it ends for any numbers
        for number in 1..=(span_s / self.bit_s).ceil() as u64 {
            let bit = first + number as f64;
            let after_s = bit * self.bit_s - self.shift_s - start_s;
            if self.bit(bit) != shines && after_s < span_s {
                shines = !shines;
                lit.switch(after_s);
            }
        }
    }

    /// Whether it shines during a bit, counted from that of time 0.
    fn bit(&self, number: f64) -> bool {
        let index = number.rem_euclid(self.word.len() as f64) as usize;
        self.word[index.min(self.word.len() - 1)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn share(blink: &Blink, from_s: f64, to_s: f64) -> f64 {
        let mut lit = Lit::default();
        blink.light(from_s, to_s - from_s, &mut lit);
        lit.share(0.0, to_s - from_s)
    }

    #[test]
    fn an_led_that_switches_during_the_exposure_gives_part_of_its_light() {
        let blink = Blink::new(vec![true, false, false], 50.0, 0.0).unwrap();
        assert!((share(&blink, 0.001, 0.002) - 1.0).abs() < 1e-9);
        assert!((share(&blink, 0.0195, 0.0205) - 0.5).abs() < 1e-9, "half in bit 0, half in bit 1");
        assert!((share(&blink, 0.0597, 0.0607) - 0.7).abs() < 1e-9, "the word begins again at 60 ms");
        assert!((share(&blink, -0.0002, 0.0008) - 0.8).abs() < 1e-9, "before time 0 comes the last bit");
        let over_two_words = share(&blink, 0.0, 0.12);
        assert!((over_two_words - 1.0 / 3.0).abs() < 1e-9);
    }

    #[test]
    fn a_clock_shift_moves_the_bits() {
        let blink = Blink::new(vec![true, false], 60.0, 1.0 / 120.0).unwrap();
        assert!((share(&blink, 0.0, 1.0 / 60.0) - 0.5).abs() < 1e-9);
        assert_eq!(Blink::new(vec![], 60.0, 0.0), None);
        assert_eq!(Blink::new(vec![true], 0.0, 0.0), None);
    }
}
