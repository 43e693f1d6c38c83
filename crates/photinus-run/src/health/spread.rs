//! How numbers spread that were measured last.

use std::collections::VecDeque;

use serde::{Deserialize, Serialize};

/// This many of the last numbers are told of: 8 s of a camera with 60 frames a second.
const MOST: usize = 512;

/// How numbers spread.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Spread {
    /// Half of them are not above.
    pub p50: f64,
    /// Of a hundred, 99 are not above.
    pub p99: f64,
    /// The largest.
    pub max: f64,
}

/// The last numbers that were measured.
#[derive(Clone, Debug, Default)]
pub struct Recent(VecDeque<f64>);

impl Recent {
    /// Takes a number in; what is not finite is left out.
    pub fn add(&mut self, number: f64) {
        if !number.is_finite() {
            return;
        }
        if self.0.len() == MOST {
            self.0.pop_front();
        }
        self.0.push_back(number);
    }

    /// How they spread; `None` before the first.
    pub fn spread(&self) -> Option<Spread> {
        let mut sorted: Vec<f64> = self.0.iter().copied().collect();
        sorted.sort_unstable_by(f64::total_cmp);
        let last = sorted.len().checked_sub(1)?;
        // The smallest number that the share of all is not above.
        let at = |percent: usize| sorted[(percent * sorted.len()).div_ceil(100).saturating_sub(1).min(last)];
        Some(Spread { p50: at(50), p99: at(99), max: sorted[last] })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_last_numbers_count() {
        let mut recent = Recent::default();
        assert_eq!(recent.spread(), None);
        recent.add(7.0);
        recent.add(f64::NAN);
        assert_eq!(recent.spread(), Some(Spread { p50: 7.0, p99: 7.0, max: 7.0 }));
        let mut recent = Recent::default();
        (0..10).for_each(|_| recent.add(1e9));
        (1..=MOST).for_each(|number| recent.add(number as f64));
        assert_eq!(recent.spread(), Some(Spread { p50: 256.0, p99: 507.0, max: 512.0 }));
    }
}
