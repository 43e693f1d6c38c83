//! Quantiles of a stream that may never end, in a memory that does not grow.

use sketches_ddsketch::{Config, DDSketch};

/// Values are known to this share of themselves.
const RELATIVE_ERROR: f64 = 0.002;
/// Bins: 1 to 1e12 at this error. What is smaller than the smallest of them counts as the smallest.
const MOST_BINS: u32 = 8192;

/// The distribution of positive numbers.
#[derive(Clone)]
pub struct Quantiles(DDSketch);

impl Default for Quantiles {
    fn default() -> Self {
        Self(DDSketch::new(Config::new(RELATIVE_ERROR, MOST_BINS, 1e-12)))
    }
}

impl std::fmt::Debug for Quantiles {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Quantiles of {}", self.count())
    }
}

impl Quantiles {
    /// Counts a number; what is not finite is not counted.
    pub fn add(&mut self, value: f64) {
        if value.is_finite() {
            self.0.add(value);
        }
    }

    /// How many were counted.
    pub fn count(&self) -> usize {
        self.0.count()
    }

    /// The smallest number, exactly.
    pub fn smallest(&self) -> Option<f64> {
        self.0.min()
    }

    /// The largest number, exactly.
    pub fn largest(&self) -> Option<f64> {
        self.0.max()
    }

    /// The number that a share of all is not above, to 0.2 %.
    pub fn at(&self, share: f64) -> Option<f64> {
        let (smallest, largest) = (self.smallest()?, self.largest()?);
        // The middle of a bin may lie outside of what was counted.
        self.0.quantile(share).ok().flatten().map(|value| value.clamp(smallest, largest))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_those_of_the_sorted_numbers() {
        let mut numbers: Vec<f64> =
            (0..100_000_u64).map(|n| 1e-6 * libm::exp(((n * 7_919) % 100_000) as f64 * 1e-4)).collect();
        let mut quantiles = Quantiles::default();
        numbers.iter().for_each(|&number| quantiles.add(number));
        quantiles.add(f64::NAN);
        numbers.sort_unstable_by(f64::total_cmp);
        for share in [0.0, 0.5, 0.99, 0.999, 1.0] {
            let exact = numbers[(share * (numbers.len() - 1) as f64) as usize];
            let told = quantiles.at(share).unwrap();
            assert!((told / exact - 1.0).abs() < 0.0025, "{share}: {told} not {exact}");
        }
        assert_eq!(quantiles.count(), numbers.len());
        assert_eq!(quantiles.smallest(), numbers.first().copied());
        assert_eq!(quantiles.largest(), numbers.last().copied());
        assert_eq!(Quantiles::default().at(0.5), None);
    }

    #[test]
    fn memory_does_not_grow() {
        let mut quantiles = Quantiles::default();
        let mut value = 1e-9;
        while value < 1e12 {
            quantiles.add(value);
            value *= 1.0001;
        }
        assert!(quantiles.0.length() <= MOST_BINS as usize, "{} bins", quantiles.0.length());
    }
}
