//! Noise that costs little: a table of normal numbers, read from places that a hash of frame and pixel gives.
//!
//! The table is drawn once and scaled so that its mean is 0 and its variance 1.
//! A run of 64 pixels takes 64 numbers in a row; where they begin depends on seed, frame, row and run alone, so a frame is
//! the same whoever renders it and in which order.

use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;

/// Standard normal numbers, in an order without pattern.
#[derive(Clone, Debug)]
pub struct NoiseTable {
    numbers: Vec<f32>,
}

impl NoiseTable {
    /// Pixels that take their numbers from one place.
    pub const RUN: usize = 64;
    const STARTS: usize = 1 << 16;

    /// A table of 65 536 starts.
    pub fn new() -> Self {
        let mut random = Pcg64::new(0x0070_686f_7469_6e75, 0x7a);
        let mut numbers: Vec<f64> =
            (0..Self::STARTS + Self::RUN).map(|_| StandardNormal.sample(&mut random)).collect();
        let count = numbers.len() as f64;
        let mean = numbers.iter().sum::<f64>() / count;
        let variance = numbers.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / count;
        let scale = 1.0 / variance.sqrt();
        numbers.iter_mut().for_each(|x| *x = (*x - mean) * scale);
        Self { numbers: numbers.into_iter().map(|x| x as f32).collect() }
    }

    /// The numbers of run `run` under `key`.
    #[inline]
    pub fn run(&self, key: u64, run: u64) -> &[f32; Self::RUN] {
        let start = (hash(key ^ hash(run)) >> 48) as usize;
        self.numbers[start..].first_chunk().expect("the table is a run longer than its starts")
    }
}

impl Default for NoiseTable {
    fn default() -> Self {
        Self::new()
    }
}

/// A number without pattern from any number (the finaliser of SplitMix64, G. Steele et al., OOPSLA 2014).
#[inline]
pub(crate) fn hash(number: u64) -> u64 {
    let mut z = number.wrapping_add(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_standard_normal_and_runs_independent() {
        let table = NoiseTable::new();
        let runs: Vec<&[f32; 64]> = (0..20_000).map(|run| table.run(7, run)).collect();
        let count = (runs.len() * 64) as f64;
        let mean = |f: &dyn Fn(f64) -> f64| {
            runs.iter().flat_map(|run| run.iter()).map(|&x| f(f64::from(x))).sum::<f64>() / count
        };
        assert!(mean(&|x| x).abs() < 0.01);
        assert!((mean(&|x| x * x) - 1.0).abs() < 0.01);
        assert!((mean(&|x| x * x * x * x) - 3.0).abs() < 0.1, "{}", mean(&|x| x * x * x * x));
        let next: f64 =
            runs.windows(2).map(|w| f64::from(w[0][5]) * f64::from(w[1][5])).sum::<f64>() / 19_999.0;
        assert!(next.abs() < 0.03, "{next}");
        let begins = |key| table.run(key, 1).map(f32::to_bits);
        assert_ne!(begins(7), begins(8));
        assert_eq!(begins(7), begins(7));
    }
}
