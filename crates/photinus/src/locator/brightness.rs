//! How bright a spot is, and how sure that is.
//!
//! In: sightings with their spots. Out: the logarithm of the light of each. Where the camera's
//! point spread told a spot's light, that is it, with its sigma. Where none did (spots of other detectors, the fixed threshold, what is no point),
//! the light in the window stands for it: its variance was fitted to rendered frames of one camera (eight ranges, two airframes, 39 000
//! spots): a part that all have, one that falls with the light, the light of others in the window, and what they cut off it.

use super::Sighting;
use crate::pose::LogLight;
use crate::spots::Spot;

/// Error of a logarithm of light against others of the frame that all spots have: where in a pixel they fall, how much of the
/// halo is in the window.
const SIGMA: f64 = 0.03;
/// Error of a logarithm of light times the root of the light, grey levels^(1/2): noise of pixels and background.
const NOISE: f64 = 0.75;
/// Error per light of another spot over the own, at no distance; by e less every so much, px, and none beyond the last.
const OTHERS: f64 = 0.11;
const FALL_PX: f64 = 3.0;
const FAR_PX: f64 = 15.0;
/// Error where another spot makes the window narrow, at no distance, and how far away that is, px.
const NARROWED: f64 = 0.25;
const NARROWED_PX: f64 = 4.2;
/// Logarithm of the light of a saturated spot over what its pixels show, where no point spread told it, and its error: several times as much
/// may be hidden.
const HIDDEN_LOG: f64 = 0.3;
const HIDDEN_SIGMA: f64 = 0.6;

/// Tells the light of all sightings. `order` is room to work in.
pub(super) fn tell(sightings: &mut [Sighting], order: &mut Vec<usize>) {
    order.clear();
    order.extend(0..sightings.len());
    order.sort_unstable_by(|&a, &b| {
        sightings[a].spot.centre.v.total_cmp(&sightings[b].spot.centre.v).then(a.cmp(&b))
    });
    for sighting in sightings.iter_mut() {
        sighting.log_light = alone(&sighting.spot);
    }
    for (place, &own) in order.iter().enumerate() {
        for &other in &order[place + 1..] {
            let [here, there] = [own, other].map(|index| sightings[index].spot.centre);
            if there.v - here.v > FAR_PX {
                break;
            }
            let gap_px = libm::hypot(there.u - here.u, there.v - here.v);
            if gap_px < FAR_PX {
                let [own_light, other_light] = [own, other].map(|index| sightings[index].log_light);
                disturb(&mut sightings[own], other_light, gap_px);
                disturb(&mut sightings[other], own_light, gap_px);
            }
        }
    }
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

/// What another spot of this light adds to the error of one.
fn disturb(own: &mut Sighting, other: Option<LogLight>, gap_px: f64) {
    let Some(LogLight { value, sigma }) = &mut own.log_light else { return };
    if own.spot.light.is_some() {
        return;
    }
    let share = gap_px / NARROWED_PX;
    let narrowed = NARROWED * libm::exp(-(share * share) * (share * share));
    let within = other.map_or(0.0, |other| OTHERS * libm::exp(other.value - *value - gap_px / FALL_PX));
    *sigma = libm::hypot(*sigma, libm::hypot(narrowed, within));
}
