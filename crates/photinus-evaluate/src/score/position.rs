//! Positions against truth, and whether their covariances keep their word.

use nalgebra::{Matrix3, Vector3};
use serde::Serialize;

use super::spread::{Spread, mean, share};
use crate::frames::Pair;

/// Half of a chi-square of 3 degrees of freedom is below this.
pub const CHI_SQUARE_3_50: f64 = 2.365_973_884_375_337_6;
/// 95 % of a chi-square of 3 degrees of freedom are below this.
pub const CHI_SQUARE_3_95: f64 = 7.814_727_903_251_178;

/// Estimated positions against truth.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PositionScore {
    /// Distance of the estimate from truth, m; `count` is how many have an estimate.
    pub error_m: Spread,
    /// Whether covariances keep their word.
    #[serde(flatten)]
    pub consistency: Consistency,
}

/// Whether covariances of three numbers keep their word.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Consistency {
    /// Those with a covariance that can be inverted.
    pub with_covariance: usize,
    /// Mean of the squared error over the covariance (normalised estimation error squared); 3 where covariances are right,
    /// more where they promise too much.
    pub nees: Option<f64>,
    /// Standard error of that mean, were errors Gaussian and independent: sqrt(6 / count).
    pub nees_standard_error: Option<f64>,
    /// The share of truth inside the 50 % ellipsoid; 0.5 where covariances are right.
    pub inside_50: Option<f64>,
    /// The share of truth inside the 95 % ellipsoid; 0.95 where covariances are right.
    pub inside_95: Option<f64>,
}

impl PositionScore {
    pub(crate) fn new(pairs: &[&Pair<'_>]) -> Self {
        let errors = || pairs.iter().filter_map(|pair| pair.position_error());
        Self {
            error_m: Spread::of(errors().map(|(error_m, _)| error_m.norm())),
            consistency: Consistency::new(errors()),
        }
    }
}

impl Consistency {
    /// Of errors and their covariances.
    pub(crate) fn new(errors: impl Iterator<Item = (Vector3<f64>, Option<Matrix3<f64>>)>) -> Self {
        let nees: Vec<f64> = errors.filter_map(|(error, covariance)| nees(&error, &covariance?)).collect();
        let count = nees.len();
        let inside = |limit: f64| share(nees.iter().filter(|&&nees| nees <= limit).count(), count);
        Self {
            with_covariance: count,
            nees: mean(nees.iter().copied()),
            nees_standard_error: (count > 0).then(|| (6.0 / count as f64).sqrt()),
            inside_50: inside(CHI_SQUARE_3_50),
            inside_95: inside(CHI_SQUARE_3_95),
        }
    }
}

impl Pair<'_> {
    /// The error of the position, m, with its covariance, m^2, where it has one.
    fn position_error(&self) -> Option<(Vector3<f64>, Option<Matrix3<f64>>)> {
        let error_m = Vector3::from(self.found.position_m?) - Vector3::from(self.truth.position_m);
        Some((error_m, self.found.position_covariance_m2.map(Matrix3::from)))
    }

    /// Squared error of the position over its covariance; `None` without a position or a covariance that can be inverted.
    pub fn nees(&self) -> Option<f64> {
        let (error_m, covariance_m2) = self.position_error()?;
        nees(&error_m, &covariance_m2?)
    }
}

/// Squared error over its covariance; `None` where that cannot be inverted.
fn nees(error: &Vector3<f64>, covariance: &Matrix3<f64>) -> Option<f64> {
    let nees = error.dot(&covariance.cholesky()?.solve(error));
    nees.is_finite().then_some(nees)
}

#[cfg(test)]
mod tests {
    use photinus_io::results::NeighbourRecord;

    use crate::hand_made::{found_at, record, there, truth};
    use crate::{Settings, evaluate};

    #[test]
    fn errors_and_their_squares_over_the_covariance_by_hand() {
        let truth: Vec<_> = (0..3).map(|frame| truth(frame, vec![there(1, [0.0, 0.0, 10.0])])).collect();
        let with = |position_m, covariance| NeighbourRecord {
            position_m: Some(position_m),
            position_covariance_m2: covariance,
            ..found_at([0.0, 0.0, 10.0])
        };
        let covariance = [[0.04, 0.0, 0.0], [0.0, 0.01, 0.0], [0.0, 0.0, 1.0]];
        let singular = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 0.0]];
        let results = [
            record(0, vec![], vec![with([0.2, 0.1, 11.0], Some(covariance))]),
            record(1, vec![], vec![with([0.0, 0.0, 13.0], Some(covariance))]),
            record(2, vec![], vec![with([0.0, 0.0, 10.0], Some(singular))]),
        ];
        let all = evaluate(&truth, &results, &Settings::default()).unwrap().scores.position.overall;
        let consistency = all.consistency;
        assert_eq!((all.error_m.count, consistency.with_covariance), (3, 2));
        assert!((all.error_m.rms.unwrap() - (10.05f64 / 3.0).sqrt()).abs() < 1e-12);
        assert!((consistency.nees.unwrap() - 6.0).abs() < 1e-9, "(3 + 9) / 2");
        assert_eq!((consistency.inside_50, consistency.inside_95), (Some(0.0), Some(0.5)));
        assert_eq!(consistency.nees_standard_error, Some(3f64.sqrt()));
    }
}
