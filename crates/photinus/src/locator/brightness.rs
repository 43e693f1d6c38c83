//! How bright a spot is, and how sure that is.
//!
//! In: sightings with their spots. Out: the logarithm of the light of each, with what a saturated core hides put back. Its
//! variance was fitted to rendered frames (four ranges, two airframes, 39 000 spots): a part that all have, one that falls
//! with the light, and the light of others in the window.

use super::Sighting;
use crate::pose::LogLight;
use crate::spots::Spot;

/// Error of a logarithm of light that all spots have: where in a pixel they fall, how much of the halo is in the window.
const SIGMA: f64 = 0.05;
/// Error of a logarithm of light times the root of the light, grey levels^(1/2): noise of pixels and background.
const NOISE: f64 = 0.95;
/// Error per light of another spot over the own, at no distance; by e less every so much, px, and none beyond the last.
const OTHERS: f64 = 0.11;
const FALL_PX: f64 = 3.0;
const FAR_PX: f64 = 15.0;
/// Light that a saturated pixel hides, as a logarithm, up to so many pixels; beyond them that is unsure.
const HIDDEN_LOG: f64 = 0.037;
const MOST_HIDING_PX: u32 = 7;

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
            let (du, dv) = between(&sightings[own].spot, &sightings[other].spot);
            if dv > FAR_PX {
                break;
            }
            let near = libm::hypot(du, dv);
            if near < FAR_PX {
                disturb(sightings, own, other, near);
                disturb(sightings, other, own, near);
            }
        }
    }
}

fn between(a: &Spot, b: &Spot) -> (f64, f64) {
    (b.centre.u - a.centre.u, b.centre.v - a.centre.v)
}

/// A spot by itself; `None` where a detector measures no light.
fn alone(spot: &Spot) -> Option<LogLight> {
    let hidden = HIDDEN_LOG * f64::from(spot.saturated_px.min(MOST_HIDING_PX));
    let unsure = HIDDEN_LOG * f64::from(spot.saturated_px.saturating_sub(MOST_HIDING_PX));
    (spot.flux > 0.0).then(|| LogLight {
        value: libm::log(spot.flux) + hidden,
        sigma: (SIGMA * SIGMA + NOISE * NOISE / spot.flux + unsure * unsure).sqrt(),
    })
}

/// What the light of another spot adds to the error of one.
fn disturb(sightings: &mut [Sighting], own: usize, other: usize, near_px: f64) {
    let Some(others) = sightings[other].log_light else { return };
    if let Some(LogLight { value, sigma }) = &mut sightings[own].log_light {
        *sigma = libm::hypot(*sigma, OTHERS * libm::exp(others.value - *value - near_px / FALL_PX));
    }
}
