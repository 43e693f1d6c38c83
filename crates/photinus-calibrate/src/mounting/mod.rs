//! Places in the image of what is known in the body frame -> how the camera sits on its vehicle.
//!
//! ```text
//! start    the rotation that turns what is known towards what is seen (Wahba's problem), outliers held down
//! refine   least squares of residuals in pixels (resection), robust, then without what deviates too far
//! ```
//!
//! From directions alone comes the rotation; from positions also the camera's place. The covariance is that of the residuals as
//! they turned out, so it holds when the stated sigmas are wrong by a factor.

mod error;
mod start;
#[cfg(test)]
mod tests;

use nalgebra::{Matrix3, Matrix6, UnitQuaternion, Vector3};

use crate::resection::{Free, Pose, Refined, refine};
pub use crate::resection::{Known, Observation};
use crate::robust::{self, Loss};
pub use error::MountingError;
pub(crate) use start::nearest_rotation;

/// How a camera sits on its vehicle.
#[derive(Clone, Debug, PartialEq)]
pub struct Mounting {
    /// The rotation body_from_camera.
    pub body_from_camera: UnitQuaternion<f64>,
    /// Covariance of that rotation as a small turn about the body's axes, rad^2.
    pub rotation_covariance_rad2: Matrix3<f64>,
    /// The camera's centre in the body frame with its covariance (m, m^2), where positions were given.
    pub centre: Option<(Vector3<f64>, Matrix3<f64>)>,
    /// Lengths of the residuals, one per observation, in the sigmas that were stated.
    pub residuals: Vec<f64>,
    /// Indices of the observations that deviate too far and were left out.
    pub outliers: Vec<usize>,
    /// Scatter of the residuals along one axis, in the sigmas that were stated: 1 where those were right.
    pub scatter: f64,
}

/// Fewest observations for a rotation, and with the camera's place.
pub const FEWEST: (usize, usize) = (3, 5);
/// Residuals below this are rounding, in sigmas.
const LEAST_SIGMA: f64 = 1e-6;
/// A turn known to no better than this is not known: 2 deg.
const MOST_TURN_RAD: f64 = 0.035;
/// A place known to no better than this is not known.
const MOST_PLACE_M: f64 = 0.5;

/// Calibrates a mounting.
///
/// # Errors
/// [`MountingError`] for too few observations, for observations that do not tell the rotation or the place, and when half of
/// them or more do not fit.
pub fn calibrate(observations: &[Observation]) -> Result<Mounting, MountingError> {
    let has_position = observations.iter().any(|seen| matches!(seen.known, Known::Position(_)));
    let (free, fewest) = match has_position {
        true => (Free::RotationAndCentre, FEWEST.1),
        false => (Free::Rotation, FEWEST.0),
    };
    if observations.len() < fewest {
        return Err(MountingError::TooFew { given: observations.len(), needed: fewest });
    }
    let start = Pose { body_from_camera: start::rotation(observations), centre_m: Vector3::zeros() };
    let near = robustly(observations, start, free).ok_or(MountingError::AtTheCamera)?;
    let lengths = lengths(observations, &near.pose);
    let sigma = robust::sigma(lengths.iter().copied()).max(LEAST_SIGMA);
    let (kept, outliers): (Vec<usize>, Vec<usize>) =
        (0..observations.len()).partition(|&index| !robust::is_outlier(lengths[index], sigma));
    if kept.len() < fewest || 2 * outliers.len() >= observations.len() {
        return Err(MountingError::DoNotFit { outliers: outliers.len(), observations: observations.len() });
    }
    let used: Vec<Observation> = kept.iter().map(|&index| observations[index]).collect();
    let found = refine(&used, near.pose, free, Loss::Squares).ok_or(MountingError::AtTheCamera)?;
    finish(observations, &used, &found, free, outliers)
}

/// The pose that most observations agree with: the scale of the loss shrinks to that of the residuals.
fn robustly(observations: &[Observation], start: Pose, free: Free) -> Option<Refined> {
    let mut pose = start;
    let mut refined = None;
    for _ in 0..4 {
        let scale = 2.0 * robust::sigma(lengths(observations, &pose).into_iter()).max(1e-9);
        let found = refine(observations, pose, free, Loss::Cauchy(scale))?;
        pose = found.pose;
        refined = Some(found);
    }
    refined
}

fn lengths(observations: &[Observation], pose: &Pose) -> Vec<f64> {
    let length = |seen| pose.residual(seen).map_or(f64::INFINITY, |(residual, _)| residual.norm());
    observations.iter().map(length).collect()
}

fn finish(
    observations: &[Observation],
    used: &[Observation],
    found: &Refined,
    free: Free,
    outliers: Vec<usize>,
) -> Result<Mounting, MountingError> {
    let unknowns = if free == Free::Rotation { 3 } else { 6 };
    let squared = lengths(used, &found.pose).iter().map(|length| length * length).sum::<f64>();
    let variance = squared / (2 * used.len() - unknowns) as f64;
    let unit = covariance(&found.information).ok_or(MountingError::Alike { turn_rad: f64::INFINITY })?;
    // residuals may be all zero; what was stated is then all that is known
    let covariance = unit * if variance > 0.0 { variance } else { 1.0 };
    let rotation: Matrix3<f64> = covariance.fixed_view::<3, 3>(0, 0).into();
    let place: Matrix3<f64> = covariance.fixed_view::<3, 3>(3, 3).into();
    let turn_rad = largest_sigma(&rotation);
    if turn_rad.is_nan() || turn_rad > MOST_TURN_RAD {
        return Err(MountingError::Alike { turn_rad });
    }
    let place_m = largest_sigma(&place);
    if free == Free::RotationAndCentre && (place_m.is_nan() || place_m > MOST_PLACE_M) {
        return Err(MountingError::PlaceUnknown { place_m });
    }
    Ok(Mounting {
        body_from_camera: found.pose.body_from_camera,
        rotation_covariance_rad2: rotation,
        centre: (free == Free::RotationAndCentre).then_some((found.pose.centre_m, place)),
        residuals: lengths(observations, &found.pose),
        outliers,
        scatter: variance.sqrt(),
    })
}

/// The inverse of an information matrix whose unknowns differ in scale; `None` where it has none.
fn covariance(information: &Matrix6<f64>) -> Option<Matrix6<f64>> {
    let scale = Matrix6::from_diagonal(&information.diagonal().map(|entry| 1.0 / entry.sqrt()));
    let inverse = (scale * information * scale).cholesky()?.inverse();
    Some(scale * inverse * scale).filter(|covariance| covariance.iter().all(|entry| entry.is_finite()))
}

fn largest_sigma(covariance: &Matrix3<f64>) -> f64 {
    covariance.symmetric_eigenvalues().max().sqrt()
}
