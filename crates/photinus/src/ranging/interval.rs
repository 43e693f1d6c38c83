//! A range of distances that truth never leaves.

/// Distances from `min_m` to `max_m`, both included: 0 <= min <= max, the maximum possibly infinite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    min_m: f64,
    max_m: f64,
}

impl Interval {
    /// Any distance.
    pub const ANY: Self = Self { min_m: 0.0, max_m: f64::INFINITY };

    /// The distances from `min_m` to `max_m`; `None` unless 0 <= min <= max and min is finite.
    pub fn new(min_m: f64, max_m: f64) -> Option<Self> {
        (min_m >= 0.0 && min_m.is_finite() && min_m <= max_m).then_some(Self { min_m, max_m })
    }

    /// Nearest distance, m.
    pub fn min_m(&self) -> f64 {
        self.min_m
    }

    /// Farthest distance, m; infinite when there is no limit.
    pub fn max_m(&self) -> f64 {
        self.max_m
    }

    /// Whether a distance lies within.
    pub fn contains(&self, distance_m: f64) -> bool {
        (self.min_m..=self.max_m).contains(&distance_m)
    }

    /// The distances from the nearest of both to the farthest.
    pub fn hull(&self, other: &Self) -> Self {
        Self { min_m: self.min_m.min(other.min_m), max_m: self.max_m.max(other.max_m) }
    }

    /// The distances that are in both; `None` when there are none.
    pub fn intersect(&self, other: &Self) -> Option<Self> {
        Self::new(self.min_m.max(other.min_m), self.max_m.min(other.max_m))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_ordered_non_negative_ends_construct() {
        assert!(Interval::new(1.0, 2.0).is_some());
        assert!(Interval::new(0.0, f64::INFINITY).is_some());
        for (min_m, max_m) in [(2.0, 1.0), (-1.0, 1.0), (f64::NAN, 1.0), (1.0, f64::NAN)] {
            assert_eq!(Interval::new(min_m, max_m), None);
        }
        assert_eq!(Interval::new(f64::INFINITY, f64::INFINITY), None);
    }

    #[test]
    fn intersection_is_what_both_contain() {
        let a = Interval::new(1.0, 4.0).unwrap();
        let b = Interval::new(3.0, f64::INFINITY).unwrap();
        assert_eq!(a.intersect(&b), Interval::new(3.0, 4.0));
        assert_eq!(a.intersect(&Interval::new(5.0, 6.0).unwrap()), None);
        assert!(a.contains(1.0) && a.contains(4.0) && !a.contains(4.1));
    }
}
