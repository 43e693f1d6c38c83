//! What the sizes of spots say of a distance when no curve of spot sizes is known: little, and only softly.

#[cfg(not(feature = "std"))]
use crate::float::Float as _;
use crate::locator::Sighting;

/// What it costs that spots of these sizes are at a distance, where no curve of spot sizes is known.
pub(super) fn size_nats(sightings: &[Sighting], group: &[usize], distance_m: f64) -> f64 {
    const SIGMA: f64 = 0.25;
    let members = || group.iter().map(|&index| &sightings[index]).filter(|sighting| sighting.range.is_none());
    let nats = |sighting: &Sighting| {
        let plausible = plausible_m(sighting);
        let beyond = (plausible.nearest_m / distance_m).max(distance_m / plausible.farthest_m);
        let off = libm::log(beyond.max(1.0)) / SIGMA;
        0.5 * off * off
    };
    members().map(nats).sum::<f64>() / members().count().max(1) as f64
}

/// Distances at which a spot of this size is nothing out of the ordinary.
///
/// For the camera of the paper (13) puts a spot of S pixels at sqrt(31.5 / S) m; other cameras, exposures and thresholds
/// see it from half to six times as far: on frames rendered for the default contrast 0.4 to 6.4 times, 2.6 in the middle.
pub(super) fn plausible_m(sighting: &Sighting) -> Plausible {
    let area_px = f64::from(sighting.spot.area_px);
    Plausible {
        nearest_m: 0.5 * (31.5 / (area_px + 0.5)).sqrt(),
        farthest_m: 6.0 * (31.5 / (area_px - 0.5).max(0.05)).sqrt(),
    }
}

pub(super) struct Plausible {
    pub(super) nearest_m: f64,
    pub(super) farthest_m: f64,
}
