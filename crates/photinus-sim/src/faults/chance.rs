//! Random numbers of a fault: a function of seed, place in the list, frame and what they are for.

use rand_pcg::Pcg64Mcg;

use crate::sensor::hash;

/// Where the random numbers of one fault start.
#[derive(Clone, Copy, Debug)]
pub(super) struct Chance(u64);

impl Chance {
    pub(super) fn new(seed: u64, place: u64) -> Self {
        Self(hash(seed ^ hash(place ^ 0xfa17)))
    }

    /// The numbers of one frame.
    pub(super) fn of_frame(&self, frame: u64) -> Self {
        Self(hash(self.0 ^ hash(frame)))
    }

    /// Number `index`, evenly between 0 and 1, 1 excluded.
    pub(super) fn share(&self, index: u64) -> f64 {
        (hash(self.0 ^ hash(!index)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// A stream of numbers for row `row`.
    pub(super) fn row(&self, row: usize) -> Pcg64Mcg {
        Pcg64Mcg::new(u128::from(hash(self.0 ^ hash(row as u64))) << 64 | u128::from(self.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_are_even_and_depend_on_everything() {
        let chance = Chance::new(7, 0);
        let count = 100_000;
        let shares = (0..count).map(|index| chance.share(index));
        let (mean, square) = shares.fold((0.0, 0.0), |(sum, squares), x| (sum + x, squares + x * x));
        let (mean, square) = (mean / count as f64, square / count as f64);
        // 1/2 and 1/3, by four standard errors
        assert!((mean - 0.5).abs() < 4.0 * (1.0 / 12.0 / count as f64).sqrt(), "{mean}");
        assert!((square - 1.0 / 3.0).abs() < 4.0 * (4.0 / 45.0 / count as f64).sqrt(), "{square}");
        let first = |chance: Chance| chance.share(0).to_bits();
        assert_eq!(first(chance), first(Chance::new(7, 0)));
        for other in [Chance::new(8, 0), Chance::new(7, 1), chance.of_frame(0), chance.of_frame(1)] {
            assert_ne!(first(chance), first(other));
        }
    }
}
