//! Scores over all, and by the distance of truth.

use serde::Serialize;

/// The edges between bins of distance.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RangeBins(Vec<f64>);

impl RangeBins {
    /// Bins between these edges, m, and one beyond either end; `None` unless they are finite, above 0 and grow.
    pub fn new(edges_m: Vec<f64>) -> Option<Self> {
        let grow = edges_m.windows(2).all(|two| two[0] < two[1]);
        let in_order = grow && edges_m.iter().all(|&edge| edge > 0.0 && edge.is_finite());
        in_order.then_some(Self(edges_m))
    }

    /// The ends of each bin, m: the nearest begins at 0, the last has no end.
    fn ends(&self) -> impl Iterator<Item = (f64, Option<f64>)> {
        let starts = std::iter::once(0.0).chain(self.0.iter().copied());
        starts.zip(self.0.iter().copied().map(Some).chain([None]))
    }
}

impl Default for RangeBins {
    /// 1 m wide near by, wider farther away.
    fn default() -> Self {
        Self(vec![1.0, 2.0, 3.0, 4.0, 6.0, 8.0, 10.0, 12.0, 15.0, 20.0, 30.0, 50.0])
    }
}

/// A score over all, and by range.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ByRange<S> {
    /// Over all.
    pub overall: S,
    /// By range, near to far; where there was nothing to score there is no bin.
    pub bins: Vec<Bin<S>>,
}

/// A score within a range.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Bin<S> {
    /// It begins here, m, included.
    pub from_m: f64,
    /// It ends before, m; `None` for the last one.
    pub to_m: Option<f64>,
    /// The score within it.
    pub score: S,
}

impl<S> ByRange<S> {
    /// Scores `all`, and by themselves those of each bin; what has no range counts over all alone.
    pub(crate) fn new<T>(
        bins: &RangeBins,
        all: &[T],
        range_m: impl Fn(&T) -> Option<f64>,
        score: impl Fn(&[&T]) -> S,
    ) -> Self {
        let within = |from_m: f64, to_m: Option<f64>| -> Vec<&T> {
            let is_in = |range_m: f64| range_m >= from_m && to_m.is_none_or(|to_m| range_m < to_m);
            all.iter().filter(|one| range_m(one).is_some_and(is_in)).collect()
        };
        let binned = bins.ends().filter_map(|(from_m, to_m)| {
            let those = within(from_m, to_m);
            (!those.is_empty()).then(|| Bin { from_m, to_m, score: score(&those) })
        });
        Self { bins: binned.collect(), overall: score(&all.iter().collect::<Vec<_>>()) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_distance_is_in_one_bin_and_its_start_belongs_to_it() {
        let bins = RangeBins::new(vec![1.0, 2.0]).unwrap();
        let ranges = [Some(0.5), Some(1.0), Some(1.9), Some(1e9), None];
        let counts = ByRange::new(&bins, &ranges, |&range_m| range_m, |those| those.len());
        assert_eq!(counts.overall, 5);
        let bins: Vec<_> = counts.bins.iter().map(|bin| (bin.from_m, bin.to_m, bin.score)).collect();
        assert_eq!(bins, [(0.0, Some(1.0), 1), (1.0, Some(2.0), 2), (2.0, None, 1)]);
    }

    #[test]
    fn edges_that_do_not_grow_are_no_bins() {
        for edges in [vec![2.0, 1.0], vec![1.0, 1.0], vec![0.0], vec![f64::NAN], vec![1.0, f64::INFINITY]] {
            assert_eq!(RangeBins::new(edges), None);
        }
        assert!(RangeBins::new(vec![]).is_some(), "one bin for all");
    }
}
