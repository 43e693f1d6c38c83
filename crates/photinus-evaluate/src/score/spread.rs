//! Errors -> their bias and their size.

use serde::Serialize;

/// How errors are spread. `None` where there is no error to tell.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Spread {
    /// How many.
    pub count: usize,
    /// Mean, signed: reported minus true.
    pub bias: Option<f64>,
    /// Root of the mean square.
    pub rms: Option<f64>,
    /// Median of the absolute errors.
    pub median: Option<f64>,
    /// 95 % of the absolute errors are no more than this (nearest rank).
    pub p95: Option<f64>,
    /// The largest absolute error.
    pub max: Option<f64>,
}

impl Spread {
    /// The spread of some errors.
    pub(crate) fn of(errors: impl Iterator<Item = f64>) -> Self {
        let errors: Vec<f64> = errors.collect();
        let mut sizes: Vec<f64> = errors.iter().map(|error| error.abs()).collect();
        sizes.sort_unstable_by(f64::total_cmp);
        Self {
            count: errors.len(),
            bias: mean(errors.iter().copied()),
            rms: mean(errors.iter().map(|error| error * error)).map(f64::sqrt),
            median: quantile(&sizes, 0.5),
            p95: quantile(&sizes, 0.95),
            max: sizes.last().copied(),
        }
    }
}

/// The mean, summed in order; `None` of nothing.
pub(crate) fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (count, sum) = values.fold((0u64, 0.0), |(count, sum), value| (count + 1, sum + value));
    (count > 0).then(|| sum / count as f64)
}

/// A count as a share of another; `None` of nothing.
pub(crate) fn share(part: usize, whole: usize) -> Option<f64> {
    (whole > 0).then(|| part as f64 / whole as f64)
}

/// The value that `share` of the sorted values do not exceed, by nearest rank; `None` of nothing.
pub(crate) fn quantile(sorted: &[f64], share: f64) -> Option<f64> {
    let rank = (share * sorted.len() as f64).ceil() as usize;
    sorted.get(rank.max(1) - 1).copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn by_hand() {
        let spread = Spread::of([3.0, -4.0, 1.0, 0.0].into_iter());
        assert_eq!(spread.bias, Some(0.0));
        assert_eq!(spread.rms, Some(6.5f64.sqrt()));
        assert_eq!((spread.median, spread.p95, spread.max), (Some(1.0), Some(4.0), Some(4.0)));
        let nothing = Spread::of(std::iter::empty());
        assert_eq!((nothing.count, nothing.rms, nothing.median), (0, None, None));
    }

    #[test]
    fn nineteen_of_twenty_are_within_the_95_percent() {
        let sizes: Vec<f64> = (1..=20).map(f64::from).collect();
        assert_eq!(quantile(&sizes, 0.95), Some(19.0));
    }
}
