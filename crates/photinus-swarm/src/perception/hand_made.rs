//! What is seen, made by hand, for tests.

use nalgebra::{Matrix3, Unit, Vector3};
use photinus::locator::Distance;
use photinus::ranging::Interval;
use photinus_control::{Normal, Seen};

/// Somebody on track 1, said to be at a place, m, with bounds of half of its distance and twice of it.
pub(super) fn seen(mean: Vector3<f64>, covariance: Matrix3<f64>) -> Seen {
    let bounds = Interval::new(0.5 * mean.norm(), 2.0 * mean.norm()).unwrap();
    Seen {
        track: 1,
        identity: None,
        bearing: Unit::new_normalize(mean),
        bearing_bound_rad: 0.1,
        distance: Distance { estimate: None, bounds, perpendicular_m: None, inline_m: None },
        position_m: Some(Normal { mean, covariance }),
        velocity_m_s: None,
        heading: None,
        probability: 1.0,
        spot_px: None,
        age_s: 0.0,
    }
}
