//! A spot -> where it lies: bearing, covariance, bound, and the distances its size allows.

use super::Sighting;
use crate::camera::{Camera, largest_rad_per_px};
use crate::ranging::SpotCurve;
use crate::spots::Spot;

/// How much the scale of the image may grow across half a spot: what a bound is widened by.
const SCALE_CHANGE: f64 = 1.05;

/// Sights a spot that was seen to blink `signal`, if any; `None` outside the camera's field. How bright it is beside others
/// is told later.
pub(super) fn sight(
    camera: &Camera,
    curve: Option<&SpotCurve>,
    spot: &Spot,
    signal: Option<u32>,
) -> Option<Sighting> {
    let (bearing, jacobian) = camera.bearing_with_jacobian(spot.centre)?;
    let rad_per_px = largest_rad_per_px(&jacobian);
    let spot_covariance_rad2 = jacobian * spot.covariance_px2 * jacobian.transpose();
    let calibration = camera.calibration_covariance(spot.centre).unwrap_or_default();
    Some(Sighting {
        spot: spot.clone(),
        signal,
        log_light: None,
        rad_per_px,
        bearing,
        covariance_rad2: spot_covariance_rad2 + calibration,
        spot_covariance_rad2,
        bound_rad: (farthest_px(spot) * rad_per_px * SCALE_CHANGE).min(std::f64::consts::PI),
        range: curve.and_then(|curve| curve.distances(spot.area_px.max(1))),
    })
}

/// From the centre of a spot to the farthest corner of its pixels, px.
fn farthest_px(spot: &Spot) -> f64 {
    let reach = |low: u32, high: u32, at: f64| (at - (f64::from(low) - 0.5)).max(f64::from(high) + 0.5 - at);
    let across = reach(spot.extent.left, spot.extent.right, spot.centre.u);
    let down = reach(spot.extent.top, spot.extent.bottom, spot.centre.v);
    libm::hypot(across, down)
}
