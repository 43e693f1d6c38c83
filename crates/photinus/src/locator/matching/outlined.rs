//! A large group as a whole against the outlines of all that shows: by size and slimness.

use nalgebra::{Vector2, Vector3};

use super::image::Image;
use crate::locator::views::{Outline, Spread};

/// How far the outline of a group may be from that of a view, in slimness.
const SLIMNESS_SIGMA: f64 = 0.08;
/// An outline so far off is no match, nats.
const FAR_NATS: f64 = 30.0;

/// A group laid over an outline.
pub(super) struct Overlaid {
    /// What it costs that the group is all of the view that shows, nats.
    pub(super) nats: f64,
    /// The airframe's place in the axes of the image.
    pub(super) place_m: Vector3<f64>,
    /// The turn of the image against the view; the outline fits half a turn further as well.
    pub(super) turn: Vector2<f64>,
}

/// Lays the group over an outline; `None` when it is far from it.
pub(super) fn overlay(
    spread: &Spread,
    outline: &Outline,
    image: &Image<'_>,
    tilt_sigma_rad: f64,
    unseen_nats: f64,
) -> Option<Overlaid> {
    let missing = outline.markers.checked_sub(image.places.len())?;
    let off = (spread.slimness - outline.slimness) / SLIMNESS_SIGMA;
    let misfit = 0.5 * off * off;
    if misfit > FAR_NATS || outline.size_m <= 0.0 {
        return None;
    }
    let (sin, cos) = libm::sincos(spread.axis_rad - outline.axis_rad);
    let attitude = image.attitude_nats(outline.elevation_rad, cos.abs(), tilt_sigma_rad);
    let nats = misfit + attitude - outline.log_prior + unseen_nats * missing as f64;
    // The axis is known but for half a turn: with the less likely half the middle would be on the other side.
    let turn = if cos < 0.0 { Vector2::new(-cos, -sin) } else { Vector2::new(cos, sin) };
    let place_m = image.origin_m(outline.size_m / spread.size, turn, outline);
    Some(Overlaid { nats, place_m, turn })
}
