//! Bounds of distance against truth, which must never leave them: every time that it does is listed.

use serde::Serialize;

use super::range::{ByRange, RangeBins};
use super::spread::{quantile, share};
use crate::frames::Pair;

/// Bounds of distance against truth.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Bounds {
    /// Over all, and by range.
    #[serde(flatten)]
    pub by_range: ByRange<BoundScore>,
    /// Each time that truth is outside, in order.
    pub violations: Vec<Violation>,
}

/// Whether truth is within the bounds, and how wide they are.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct BoundScore {
    /// Neighbours that were found.
    pub count: usize,
    /// Those whose true distance is from min to max.
    pub inside: usize,
    /// inside / count; less than 1 is a bug, or an assumption that does not hold.
    pub coverage: Option<f64>,
    /// Those whose max is known.
    pub bounded: usize,
    /// Median of max - min, m; those without a max count as infinitely wide.
    pub median_width_m: Option<f64>,
    /// The same as a share of the true distance.
    pub median_relative_width: Option<f64>,
}

/// Truth outside the bounds.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Violation {
    /// The frame.
    pub frame: u64,
    /// The neighbour of truth.
    pub id: u32,
    /// Its distance, m.
    pub distance_m: f64,
    /// What it is said never to be less than, m.
    pub min_m: f64,
    /// What it is said never to be more than, m.
    pub max_m: Option<f64>,
    /// By how much it is, m: negative when nearer than min, positive when farther than max.
    pub by_m: f64,
}

impl Bounds {
    pub(crate) fn new(pairs: &[Pair<'_>], bins: &RangeBins) -> Self {
        Self {
            by_range: ByRange::new(bins, pairs, |pair| Some(pair.truth.distance_m), BoundScore::new),
            violations: pairs.iter().filter_map(Violation::of).collect(),
        }
    }
}

impl Violation {
    fn of(pair: &Pair<'_>) -> Option<Self> {
        let (distance_m, bounds) = (pair.truth.distance_m, &pair.found.distance_m);
        let (near_m, far_m) = (distance_m - bounds.min, bounds.max.map_or(0.0, |max| distance_m - max));
        let by_m = if near_m < 0.0 { near_m } else { far_m.max(0.0) };
        (by_m != 0.0).then_some(Self {
            frame: pair.frame,
            id: pair.truth.id,
            distance_m,
            min_m: bounds.min,
            max_m: bounds.max,
            by_m,
        })
    }
}

impl BoundScore {
    fn new(pairs: &[&Pair<'_>]) -> Self {
        let inside = pairs.iter().filter(|pair| Violation::of(pair).is_none()).count();
        let median = |width: fn(f64, &Pair<'_>) -> f64| {
            let mut widths: Vec<f64> = pairs
                .iter()
                .map(|pair| {
                    let bounds = &pair.found.distance_m;
                    bounds.max.map_or(f64::INFINITY, |max| width(max - bounds.min, pair))
                })
                .collect();
            widths.sort_unstable_by(f64::total_cmp);
            quantile(&widths, 0.5).filter(|width| width.is_finite())
        };
        Self {
            count: pairs.len(),
            inside,
            coverage: share(inside, pairs.len()),
            bounded: pairs.iter().filter(|pair| pair.found.distance_m.max.is_some()).count(),
            median_width_m: median(|width_m, _| width_m),
            median_relative_width: median(|width_m, pair| width_m / pair.truth.distance_m),
        }
    }
}

#[cfg(test)]
mod tests {
    use photinus_io::results::{Distance, NeighbourRecord};

    use crate::hand_made::{found_at, record, there, truth};
    use crate::{Settings, evaluate};

    #[test]
    fn every_time_that_truth_is_outside_is_listed() {
        let bounds =
            [(8.0, Some(12.0)), (10.0, Some(10.0)), (10.5, Some(12.0)), (2.0, Some(9.0)), (3.0, None)];
        let truth: Vec<_> = (0..5).map(|frame| truth(frame, vec![there(7, [0.0, 6.0, 8.0])])).collect();
        let results: Vec<_> = bounds
            .into_iter()
            .zip(0..)
            .map(|((min, max), frame)| {
                let there = found_at([0.0, 6.0, 8.0]);
                let distance_m = Distance { min, max, ..there.distance_m };
                record(frame, vec![], vec![NeighbourRecord { distance_m, ..there }])
            })
            .collect();
        let scores = evaluate(&truth, &results, &Settings::default()).unwrap().scores.bounds;
        let all = scores.by_range.overall;
        assert_eq!((all.count, all.inside, all.bounded), (5, 3, 4));
        assert_eq!(all.coverage, Some(0.6));
        assert_eq!((all.median_width_m, all.median_relative_width), (Some(4.0), Some(0.4)));
        let listed: Vec<_> = scores.violations.iter().map(|v| (v.frame, v.id, v.by_m)).collect();
        assert_eq!(listed, [(2, 7, -0.5), (3, 7, 1.0)]);
    }
}
