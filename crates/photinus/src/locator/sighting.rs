//! A spot -> where it lies: bearing, covariance, bound, and the distances its size allows.

use nalgebra::Matrix3;

use crate::camera::{Bearing, Camera, largest_rad_per_px};
use crate::pose::LogLight;
use crate::ranging::{Interval, SpotCurve};
use crate::spots::Spot;

/// A spot and where it lies.
#[derive(Clone, Debug, PartialEq)]
pub struct Sighting {
    /// The spot.
    pub spot: Spot,
    /// Which of the airframe's signals it was seen to blink, where that is known.
    pub signal: Option<u32>,
    /// Its light, in a unit that is the same all over the frame and for all frames, with what a saturated core hides put back; `None` where none
    /// was measured.
    pub log_light: Option<LogLight>,
    /// Its direction in the camera frame.
    pub bearing: Bearing,
    /// Covariance of the direction, rad^2, tangent to the sphere (rank 2): from the spot and, where the camera's file says
    /// how sure it is, from the calibration.
    pub covariance_rad2: Matrix3<f64>,
    /// The part of it that comes from the spot, and differs from spot to spot.
    pub spot_covariance_rad2: Matrix3<f64>,
    /// How far the direction turns per pixel there, where it turns most, rad/px.
    pub rad_per_px: f64,
    /// Two markers so far apart are told apart half of the time there, rad.
    pub resolution_rad: f64,
    /// The marker's true direction is no further from the bearing, rad: its light falls within the box of pixels that its
    /// spot spans. The camera's calibration is taken as exact.
    pub bound_rad: f64,
    /// Distances at which a spot of this size is possible, where the curve of spot sizes is known.
    pub range: Option<Interval>,
}

/// Two markers so far apart are told apart half of the time where points spread no wider than pixels are, px (rendered frames).
const LEAST_RESOLUTION_PX: f64 = 2.5;
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
    let spread_px = camera.optics().map_or(0.0, |optics| optics.spread.at(spot.centre).resolution_px());
    let calibration = camera.calibration_covariance(spot.centre).unwrap_or_default();
    Some(Sighting {
        spot: spot.clone(),
        signal,
        log_light: None,
        rad_per_px,
        resolution_rad: spread_px.max(LEAST_RESOLUTION_PX) * rad_per_px,
        bearing,
        covariance_rad2: spot_covariance_rad2 + calibration,
        spot_covariance_rad2,
        bound_rad: (farthest_px(spot) * rad_per_px * SCALE_CHANGE).min(core::f64::consts::PI),
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
