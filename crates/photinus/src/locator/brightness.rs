//! How bright a spot is, and how sure that is.
//!
//! In: sightings with their spots. Out: the logarithm of the light of each. Where the detector
//! told a spot's light, that is it, with its sigma. Where it did not (spots of other detectors, the fixed threshold, what is full without a
//! point spread), the light in the window stands for it: its variance was fitted to rendered frames of one camera (eight ranges, two airframes, 39 000
//! spots): a part that all have, one that falls with the light, the light of others in the window, and what they cut off it.

use core::cmp::Ordering;

use super::Sighting;
use super::cells::{ByCell, Cells};
use super::neighbour::Located;
#[cfg(not(feature = "std"))]
use crate::float::Float as _;
use crate::optics::Vignetting;
use crate::pose::LogLight;
use crate::spots::{HIDDEN_LOG, HIDDEN_SIGMA, Spot};

/// Error of a logarithm of light against others of the frame that all spots have: where in a pixel they fall, how much of the
/// halo is in the window.
const SIGMA: f64 = 0.03;
/// Error of a logarithm of light times the root of the light, grey levels^(1/2): noise of pixels and background.
const NOISE: f64 = 0.75;
/// Error per light of another spot over the own, at no distance; by e less every this much, px, and none beyond the last.
const OTHERS: f64 = 0.11;
const FALL_PX: f64 = 3.0;
const FAR_PX: f64 = 15.0;
/// What is so much fainter, as a logarithm, adds nothing.
const NEGLIGIBLE_LOG: f64 = -12.0;
/// Error where another spot makes the window narrow, at no distance, and how far away that is, px.
const NARROWED: f64 = 0.25;
const NARROWED_PX: f64 = 4.2;

/// The unit of light, the same for all frames: grey levels at the exposure of the first whose exposure is known.
#[derive(Debug, Default)]
pub(super) struct Unit {
    exposure_s: Option<f64>,
}

impl Unit {
    /// How much more light a frame shows than it would at the unit's exposure, as a logarithm.
    pub(super) fn log_longer(&mut self, exposure_s: Option<f64>) -> f64 {
        exposure_s.map_or(0.0, |own| libm::log(own / *self.exposure_s.get_or_insert(own)))
    }
}

/// Tells the light of all sightings in an image of `size` (width, height) px, as bright as they were on the axis where the
/// lens's vignetting is known; of more than `most` the brightest come first, and of the others no more is told than by
/// themselves. `by_cell` is room to work in.
pub(super) fn tell(
    sightings: &mut [Sighting],
    vignetting: Option<&Vignetting>,
    most: usize,
    size: [usize; 2],
    by_cell: &mut ByCell,
) {
    for sighting in sightings.iter_mut() {
        sighting.log_light = alone(&sighting.spot);
        if let (Some(light), Some(vignetting)) = (&mut sighting.log_light, vignetting) {
            let (share, sigma) = vignetting.share(sighting.bearing.off_axis_rad());
            light.value -= libm::log(share);
            light.sigma = libm::hypot(light.sigma, sigma / share);
        }
    }
    if sightings.len() > most {
        sightings.sort_unstable_by(brightest_first);
    }
    let cells = Cells::new(size, FAR_PX);
    by_cell.sort(&cells, sightings);
    for own in 0..sightings.len().min(most) {
        let Sighting { spot, log_light, .. } = &sightings[own];
        let Some(light) = log_light.filter(|_| spot.light.is_none()) else { continue };
        let near = by_cell.near(&cells, sightings, own, FAR_PX);
        let others = near.map(|(other, gap_px)| disturbance(light, sightings[other].log_light, gap_px));
        let variance = light.sigma * light.sigma + others.sum::<f64>();
        sightings[own].log_light = Some(LogLight { sigma: variance.sqrt(), ..light });
    }
}

/// Tells light, and what is found of it, as at an exposure that is shorter by this factor, a logarithm.
pub(super) fn shorten(located: &mut Located, log_longer: f64) {
    let lights = located.sightings.iter_mut().filter_map(|sighting| sighting.log_light.as_mut());
    lights.chain(&mut located.detection_limit).for_each(|light| light.value -= log_longer);
}

/// The order of light; of light that is not known, that of places.
fn brightest_first(a: &Sighting, b: &Sighting) -> Ordering {
    let light = |sighting: &Sighting| sighting.log_light.map_or(f64::NEG_INFINITY, |light| light.value);
    let [here, there] = [a, b].map(|sighting| sighting.spot.centre);
    light(b).total_cmp(&light(a)).then(here.v.total_cmp(&there.v)).then(here.u.total_cmp(&there.u))
}

/// A spot by itself; `None` where a detector measures no light.
fn alone(spot: &Spot) -> Option<LogLight> {
    if let Some(light) = spot.light.filter(|light| light.value > 0.0) {
        return Some(LogLight { value: libm::log(light.value), sigma: light.sigma / light.value });
    }
    let (hidden, unsure) = if spot.saturated_px > 0 { (HIDDEN_LOG, HIDDEN_SIGMA) } else { (0.0, 0.0) };
    (spot.flux > 0.0).then(|| LogLight {
        value: libm::log(spot.flux) + hidden,
        sigma: (SIGMA * SIGMA + NOISE * NOISE / spot.flux + unsure * unsure).sqrt(),
    })
}

/// What another spot of this light adds to the variance of one's.
fn disturbance(own: LogLight, other: Option<LogLight>, gap_px: f64) -> f64 {
    let share = gap_px / NARROWED_PX;
    let square = |log: f64| if log < NEGLIGIBLE_LOG { 0.0 } else { libm::exp(2.0 * log) };
    let narrowed = NARROWED * NARROWED * square(-(share * share) * (share * share));
    let within = other.map_or(0.0, |other| square(other.value - own.value - gap_px / FALL_PX));
    narrowed + OTHERS * OTHERS * within
}
