//! Distances against truth: the estimate, and the paper's two.

use serde::Serialize;

use super::spread::{Spread, mean, share};
use crate::frames::Pair;

/// Estimated distances against truth.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct DistanceScore {
    /// Neighbours that were found.
    pub found: usize,
    /// Estimate minus truth, m; `count` is how many have an estimate.
    pub error_m: Spread,
    /// The same as a share of the true distance.
    pub relative_error: Spread,
    /// Mean of the squared error over the squared sigma; 1 where sigmas are right.
    pub nees: Option<f64>,
}

impl DistanceScore {
    pub(crate) fn new(pairs: &[&Pair<'_>]) -> Self {
        let (error_m, relative_error) = spreads(pairs, |pair| pair.found.distance_m.estimate);
        let nees = |pair: &&Pair<'_>| {
            let distance = &pair.found.distance_m;
            let normalised = (distance.estimate? - pair.truth.distance_m) / distance.sigma?;
            Some(normalised * normalised).filter(|squared| squared.is_finite())
        };
        Self { found: pairs.len(), error_m, relative_error, nees: mean(pairs.iter().filter_map(nees)) }
    }
}

/// The paper's l_A and l_B against truth (V. Walter, M. Saska, A. Franchi, ICUAS 2018, equations 5 and 6).
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PaperScore {
    /// l_A minus truth, m.
    pub perpendicular_error_m: Spread,
    /// The same as a share of the true distance.
    pub perpendicular_relative_error: Spread,
    /// l_B minus truth, m.
    pub inline_error_m: Spread,
    /// The same as a share of the true distance.
    pub inline_relative_error: Spread,
    /// How many have both.
    pub both: usize,
    /// The share of them with l_B <= truth <= l_A, as the paper says of a level target.
    pub between: Option<f64>,
}

impl PaperScore {
    pub(crate) fn new(pairs: &[&Pair<'_>]) -> Self {
        let (perpendicular_error_m, perpendicular_relative_error) =
            spreads(pairs, |pair| pair.found.distance_m.perpendicular);
        let (inline_error_m, inline_relative_error) = spreads(pairs, |pair| pair.found.distance_m.inline);
        let between: Vec<bool> = pairs
            .iter()
            .filter_map(|pair| {
                let (near_m, far_m) = (pair.found.distance_m.inline?, pair.found.distance_m.perpendicular?);
                Some((near_m..=far_m).contains(&pair.truth.distance_m))
            })
            .collect();
        Self {
            perpendicular_error_m,
            perpendicular_relative_error,
            inline_error_m,
            inline_relative_error,
            both: between.len(),
            between: share(between.iter().filter(|&&between| between).count(), between.len()),
        }
    }
}

/// What is reported minus truth, m and as a share of truth.
fn spreads(pairs: &[&Pair<'_>], reported_m: impl Fn(&Pair<'_>) -> Option<f64>) -> (Spread, Spread) {
    let errors: Vec<(f64, f64)> = pairs
        .iter()
        .filter_map(|pair| reported_m(pair).map(|reported_m| (reported_m, pair.truth.distance_m)))
        .map(|(reported_m, truth_m)| (reported_m - truth_m, (reported_m - truth_m) / truth_m))
        .collect();
    (Spread::of(errors.iter().map(|error| error.0)), Spread::of(errors.iter().map(|error| error.1)))
}

#[cfg(test)]
mod tests {
    use photinus_io::results::{Distance, NeighbourRecord};

    use crate::hand_made::{found_at, record, there, truth};
    use crate::{Settings, evaluate};

    fn told(estimate: Option<f64>, perpendicular: Option<f64>, inline: Option<f64>) -> NeighbourRecord {
        let there = found_at([0.0, 0.0, 10.0]);
        let distance_m = Distance { estimate, sigma: Some(0.5), min: 1.0, max: None, perpendicular, inline };
        NeighbourRecord { distance_m, ..there }
    }

    #[test]
    fn errors_by_hand() {
        let truth: Vec<_> = (0..4).map(|frame| truth(frame, vec![there(1, [0.0, 0.0, 10.0])])).collect();
        let found = [
            told(Some(11.0), Some(12.0), Some(9.0)),
            told(Some(8.0), Some(9.5), Some(9.0)),
            told(Some(10.0), Some(10.0), None),
            told(None, None, None),
        ];
        let results: Vec<_> =
            found.into_iter().zip(0..).map(|(found, frame)| record(frame, vec![], vec![found])).collect();
        let scores = evaluate(&truth, &results, &Settings::default()).unwrap().scores;

        let distance = scores.distance.overall;
        assert_eq!((distance.found, distance.error_m.count), (4, 3));
        assert!((distance.error_m.bias.unwrap() + 1.0 / 3.0).abs() < 1e-12);
        assert!((distance.error_m.rms.unwrap() - (5.0f64 / 3.0).sqrt()).abs() < 1e-12);
        assert!((distance.relative_error.rms.unwrap() - (0.05f64 / 3.0).sqrt()).abs() < 1e-12);
        assert!((distance.nees.unwrap() - 20.0 / 3.0).abs() < 1e-12);

        let paper = scores.paper.overall;
        assert_eq!((paper.both, paper.between), (2, Some(0.5)));
        assert!((paper.perpendicular_error_m.bias.unwrap() - 0.5).abs() < 1e-12);
        assert_eq!(paper.inline_error_m.bias, Some(-1.0));
        assert_eq!(paper.inline_relative_error.max, Some(0.1));
    }
}
