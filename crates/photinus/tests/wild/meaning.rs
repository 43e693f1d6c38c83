//! What has a meaning.

use nalgebra::Matrix3;
use photinus::pose::{Mode, Pose};
use proptest::prelude::*;
use proptest::test_runner::TestCaseError;

/// How far away a guess of a pose may be, m.
pub(crate) const FARTHEST_M: f64 = 100.0;

/// What rounding may take from a covariance: a share of its largest element, and something besides.
struct Rounding {
    share: f64,
    besides: f64,
}

fn check_covariance(covariance: &Matrix3<f64>, rounding: &Rounding) -> Result<(), TestCaseError> {
    prop_assert!(covariance.iter().all(|number| number.is_finite()), "{covariance}");
    let tolerance = rounding.share * covariance.amax() + rounding.besides;
    prop_assert!((covariance - covariance.transpose()).amax() <= tolerance, "{covariance}");
    prop_assert!(covariance.symmetric_eigenvalues().min() >= -tolerance, "{covariance} {tolerance:e}");
    Ok(())
}

/// A pose and its covariances: of the position, m^2, and of the attitude, rad^2. `share` of them may be lost where variances
/// of very different size stand side by side.
pub(crate) fn check_told(
    pose: &Pose,
    position_m2: &Matrix3<f64>,
    turn_rad2: &Matrix3<f64>,
    share: f64,
) -> Result<(), TestCaseError> {
    check_pose(pose)?;
    // The squares of distances cancel.
    let besides = 1e-14 * (FARTHEST_M * FARTHEST_M + pose.position_m.norm_squared());
    check_covariance(position_m2, &Rounding { share, besides })?;
    check_covariance(turn_rad2, &Rounding { share, besides: 1e-14 })
}

fn check_pose(pose: &Pose) -> Result<(), TestCaseError> {
    prop_assert!(pose.position_m.iter().all(|number| number.is_finite()), "{pose:?}");
    let turn = pose.camera_from_body.matrix();
    prop_assert!((turn * turn.transpose() - Matrix3::identity()).norm() < 1e-6, "{pose:?}");
    Ok(())
}

pub(crate) fn check_modes(modes: &[Mode], share: f64) -> Result<(), TestCaseError> {
    let weight: f64 = modes.iter().map(|mode| mode.weight).sum();
    prop_assert!((weight - 1.0).abs() < 1e-9, "modes weigh {weight}");
    for mode in modes {
        prop_assert!((0.0..=1.0 + 1e-12).contains(&mode.weight), "{mode:?}");
        check_told(&mode.pose, &mode.position_covariance_m2, &mode.orientation_covariance_rad2, share)?;
    }
    Ok(())
}
