//! One neighbour's bearing -> the own heading, where both positions are known: what drifts in a compass does not drift in a camera.
//!
//! The founding paper's part VI: RTK-GNSS tells both positions, the compass is off by degrees, the bearing is not.

use nalgebra::{UnitVector3, Vector3};

use super::group::azimuth_rad;
use crate::{Heading, Normal};

/// How far a vehicle's level frame is turned against the axes in which `own_m` and `neighbour_m` are known, m, by the bearing of
/// the neighbour in the level frame, sure to `bearing_sigma_rad` across. `None` where the neighbour is so nearly straight above or
/// below that its azimuth says nothing.
pub fn heading_from_bearing(
    own_m: &Normal,
    neighbour_m: &Normal,
    bearing: &UnitVector3<f64>,
    bearing_sigma_rad: f64,
) -> Option<Heading> {
    let offset = neighbour_m.mean - own_m.mean;
    let (far, level) = (libm::hypot(offset.x, offset.y), libm::hypot(bearing.x, bearing.y));
    if !(far > 0.0 && level > 0.0) {
        return None;
    }
    // Across the line of sight, level: what turns it.
    let across = Vector3::new(-offset.y, offset.x, 0.0) / far;
    let variance_m2 = across.dot(&((own_m.covariance + neighbour_m.covariance) * across));
    let sigma_rad =
        libm::sqrt(variance_m2 / (far * far) + (bearing_sigma_rad / level) * (bearing_sigma_rad / level));
    let turned = azimuth_rad(&offset) - azimuth_rad(bearing);
    let (sine, cosine) = libm::sincos(turned);
    (sigma_rad < 0.5).then(|| Heading { angle_rad: libm::atan2(sine, cosine), sigma_rad })
}
