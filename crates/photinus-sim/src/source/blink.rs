//! When an LED shines: a bit of its code word after the other, by a clock of its own.

use crate::clock::Clock;
use crate::draw::{self, Use};
use crate::snapshot::Lit;

/// The signal of one LED over time.
#[derive(Clone, Debug, PartialEq)]
pub struct Blink {
    word: Vec<bool>,
    bit_s: f64,
    clock: Clock,
    jitter_s: f64,
    seed: u64,
}

impl Blink {
    /// An edge never strays farther than this share of a bit, so that edges stay in order.
    const FARTHEST_STRAY: f64 = 0.45;

    /// An LED that repeats `word`, `rate_hz` bits per second, the first bit beginning when `clock` reads 0; `None` for an empty
    /// word or a rate that is not positive.
    pub fn new(word: Vec<bool>, rate_hz: f64, clock: Clock) -> Option<Self> {
        let legal = !word.is_empty() && rate_hz.is_finite() && rate_hz > 0.0 && clock.offset_s.is_finite();
        legal.then(|| Self { word, bit_s: 1.0 / rate_hz, clock, jitter_s: 0.0, seed: 0 })
    }

    /// The same with edges that stray, each by a normal number of this sigma (s) that depends on `seed` and the edge alone; a
    /// vehicle's LEDs stray together when they share a seed.
    #[must_use]
    pub fn with_jitter(self, jitter_s: f64, seed: u64) -> Self {
        Self { jitter_s, seed, ..self }
    }

    /// When it shines during a span that begins at `start_s`.
    pub fn light(&self, start_s: f64, span_s: f64, lit: &mut Lit) {
        // an edge strays by less than half a bit: the bit before the nominal one has surely begun
        let first = (self.clock.reading_s(start_s) / self.bit_s).floor() - 1.0;
        let mut shines = self.bit(first);
        lit.restart(shines);
        // counted, so that it ends for any numbers
        for number in 1..=(span_s / self.bit_s).ceil() as u64 + 2 {
            let bit = first + number as f64;
            let after_s = self.edge_s(bit) - start_s;
            if self.bit(bit) == shines {
                continue;
            }
            if after_s <= 0.0 {
                shines = !shines;
                lit.restart(shines);
            } else if after_s < span_s {
                shines = !shines;
                lit.switch(after_s);
            }
        }
    }

    /// Whether it shines during a bit, counted from that which begins when the clock reads 0.
    fn bit(&self, number: f64) -> bool {
        let index = number.rem_euclid(self.word.len() as f64) as usize;
        self.word[index.min(self.word.len() - 1)]
    }

    /// The time of the world at which a bit begins, s.
    fn edge_s(&self, number: f64) -> f64 {
        let even_s = self.clock.time_s(number * self.bit_s);
        if self.jitter_s <= 0.0 {
            return even_s;
        }
        let farthest_s = Self::FARTHEST_STRAY * self.bit_s;
        let stray = draw::normal(draw::key(self.seed, Use::Edge, &[number as i64 as u64]));
        even_s + (self.jitter_s * stray).clamp(-farthest_s, farthest_s)
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

    fn shifted(offset_s: f64) -> Clock {
        Clock { offset_s, ppm: 0.0 }
    }

    #[test]
    fn an_led_that_switches_during_the_exposure_gives_part_of_its_light() {
        let blink = Blink::new(vec![true, false, false], 50.0, shifted(0.0)).unwrap();
        assert!((share(&blink, 0.001, 0.002) - 1.0).abs() < 1e-9);
        assert!((share(&blink, 0.0195, 0.0205) - 0.5).abs() < 1e-9, "half in bit 0, half in bit 1");
        assert!((share(&blink, 0.0597, 0.0607) - 0.7).abs() < 1e-9, "the word begins again at 60 ms");
        assert!((share(&blink, -0.0002, 0.0008) - 0.8).abs() < 1e-9, "before time 0 comes the last bit");
        let over_two_words = share(&blink, 0.0, 0.12);
        assert!((over_two_words - 1.0 / 3.0).abs() < 1e-9);
    }

    #[test]
    fn a_clock_shift_moves_the_bits() {
        let blink = Blink::new(vec![true, false], 60.0, shifted(1.0 / 120.0)).unwrap();
        assert!((share(&blink, 0.0, 1.0 / 60.0) - 0.5).abs() < 1e-9);
        assert_eq!(Blink::new(vec![], 60.0, shifted(0.0)), None);
        assert_eq!(Blink::new(vec![true], 0.0, shifted(0.0)), None);
    }

    /// The share by asking a clock at many instants, said plainly: which bit it is at, by counting edges that have passed.
    #[test]
    fn shares_are_those_of_looking_at_the_clock_many_times() {
        let word = [true, false, false, true, true, false, true];
        let (rate_hz, clock) = (60.0, Clock { offset_s: 0.013, ppm: 900.0 });
        for jitter_s in [0.0, 1e-3] {
            let blink = Blink::new(word.to_vec(), rate_hz, clock).unwrap().with_jitter(jitter_s, 5);
            let stray_s = |bit: i64| jitter_s * draw::normal(draw::key(5, Use::Edge, &[bit as u64]));
            // an independent edge list: bit k begins at (k / rate - offset) / (1 + ppm) and strays
            let edges: Vec<f64> =
                (-5..400).map(|bit| (bit as f64 / rate_hz - 0.013) / 1.0009 + stray_s(bit)).collect();
            let shines = |time_s: f64| {
                let bit = edges.partition_point(|edge_s| *edge_s <= time_s) as i64 - 1 - 5;
                word[bit.rem_euclid(7) as usize]
            };
            let (mut partly, samples) = (0, 4000);
            for exposure in 0..300 {
                let (from_s, to_s) = (f64::from(exposure) * 0.0167, f64::from(exposure) * 0.0167 + 0.004);
                let lit = (0..samples)
                    .filter(|i| shines(from_s + 0.004 * (f64::from(*i) + 0.5) / f64::from(samples)))
                    .count() as f64;
                let (counted, computed) = (lit / f64::from(samples), share(&blink, from_s, to_s));
                assert!((counted - computed).abs() < 1e-3, "{exposure}: {computed} not {counted}");
                partly += u32::from(computed > 0.01 && computed < 0.99);
            }
            assert!(partly > 20, "{partly} of 300 exposures hold an edge");
        }
    }

    #[test]
    fn edges_stray_by_their_sigma_and_stay_in_order() {
        let jittered = |jitter_s| {
            Blink::new(vec![true, false], 100.0, Clock::default()).unwrap().with_jitter(jitter_s, 8)
        };
        let blink = jittered(2e-4);
        let strays: Vec<f64> =
            (0..100_000).map(|i| blink.edge_s(f64::from(i)) - f64::from(i) * 0.01).collect();
        let mean = strays.iter().sum::<f64>() / 1e5;
        let sigma = (strays.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / 1e5).sqrt();
        assert!(mean.abs() < 3e-6 && (sigma / 2e-4 - 1.0).abs() < 0.01, "{mean} {sigma}");
        let wild = jittered(0.01);
        assert!((0..10_000).all(|i| wild.edge_s(f64::from(i)) < wild.edge_s(f64::from(i + 1))));
    }
}
