//! A large group as a whole against the outlines of all that shows: by size and slimness.

use nalgebra::{Vector2, Vector3};

use super::image::{Image, turned};
use crate::locator::views::{Outline, Spread, UNSEEN_NATS};

/// How far the outline of a group may be from that of a view, in slimness.
const SLIMNESS_SIGMA: f64 = 0.08;
/// An outline so far off is no match, nats.
const FAR_NATS: f64 = 30.0;

/// The place of the airframe if the group is all of a view that shows, and what that costs; `None` when far from it.
pub(super) fn compare(
    spread: &Spread,
    outline: &Outline,
    image: &Image<'_>,
    tilt_sigma_rad: f64,
) -> Option<(Vector3<f64>, f64)> {
    let missing = outline.markers.checked_sub(image.places.len())?;
    let off = (spread.slimness - outline.slimness) / SLIMNESS_SIGMA;
    let misfit = 0.5 * off * off;
    if misfit > FAR_NATS || outline.size_m <= 0.0 {
        return None;
    }
    let (sin, cos) = libm::sincos(spread.axis_rad - outline.axis_rad);
    let attitude = image.attitude_nats(outline.elevation_rad, cos.abs(), tilt_sigma_rad);
    let nats = misfit + attitude - outline.log_prior + UNSEEN_NATS * missing as f64;
    // The axis is known but for half a turn: with the less likely half the middle would be on the other side.
    let turn = if cos < 0.0 { Vector2::new(-cos, -sin) } else { Vector2::new(cos, sin) };
    let depth_m = outline.size_m / spread.size;
    Some((image.origin(depth_m, turned(outline.middle_m, turn), outline.ahead_m), nats))
}
