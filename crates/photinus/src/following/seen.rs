//! What each sighting of a frame is worth to all tracks near it, told once.

use crate::locator::Sighting;

/// Looks of a spot count by no more than this factor, as a logarithm: they are told by the frame alone.
const MOST_LOOKS: f64 = 3.0;

/// A sighting, as far as no track matters.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seen {
    /// Its light with standard deviation.
    pub(super) light: Option<(f64, f64)>,
    /// How much more likely it looks as it does if it is a marker than if it is clutter.
    pub(super) looks: f64,
    /// How dense markers are there that were never seen before.
    pub(super) new_per_sr: f64,
    pub(super) rad_per_px: f64,
    pub(super) resolution_rad: f64,
}

impl Seen {
    pub(super) fn of(sighting: &Sighting, new_per_sr: f64) -> Self {
        let light = sighting.log_light.map(|log_light| {
            let light = libm::exp(log_light.value);
            (light, light * log_light.sigma)
        });
        let looks = libm::exp(sighting.spot.marker_log_odds.clamp(-MOST_LOOKS, MOST_LOOKS));
        Self {
            light,
            looks,
            new_per_sr,
            rad_per_px: sighting.rad_per_px,
            resolution_rad: sighting.resolution_rad,
        }
    }
}
