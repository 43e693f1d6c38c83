//! The part of the world that is watched: what a camera shows and no mask hides.

use super::{Bearing, Camera};
#[cfg(not(feature = "std"))]
use crate::float::Float as _;
use crate::frame::Mask;

/// Nearer to the image's border a spot may be cut off or missed, px.
const MARGIN_PX: f64 = 2.0;

/// The directions in which spots are looked for.
#[derive(Clone, Copy, Debug)]
pub struct Watched<'a> {
    camera: &'a Camera,
    mask: Option<&'a Mask>,
}

impl<'a> Watched<'a> {
    /// What `camera` shows where `mask` does not say to ignore.
    pub fn new(camera: &'a Camera, mask: Option<&'a Mask>) -> Self {
        Self { camera, mask }
    }

    /// Whether a spot in this direction would show whole.
    pub fn sees(&self, bearing: &Bearing) -> bool {
        let Some(pixel) = self.camera.pixel(bearing) else { return false };
        let [right, bottom] =
            [self.camera.width(), self.camera.height()].map(|side| side as f64 - 1.0 - MARGIN_PX);
        let within = (MARGIN_PX..=right).contains(&pixel.u) && (MARGIN_PX..=bottom).contains(&pixel.v);
        within
            && !self.mask.is_some_and(|mask| mask.ignores(pixel.u.round() as usize, pixel.v.round() as usize))
    }
}
