//! What lies near a direction, without looking at everything: directions in the order of one of their axes.

use alloc::vec::Vec;

use nalgebra::{Matrix2, Vector3};

use super::motion::{Motion, Offset};
#[cfg(not(feature = "std"))]
use crate::float::Float as _;
use crate::locator::Sighting;

/// Sightings so far from a track, in squared standard deviations, are not its own.
const GATE: f64 = 36.0;

/// What is farther away is on another side, rad: a plane shows nothing of it.
const FARTHEST_RAD: f64 = 1.0;

/// Directions by their height.
#[derive(Debug, Default)]
pub(super) struct Directions {
    sorted: Vec<(f64, usize)>,
    /// The most that any of them is unsure, rad^2.
    widest_rad2: f64,
}

impl Directions {
    /// Those of sightings, by their index.
    pub(super) fn of_sightings(&mut self, sightings: &[Sighting]) {
        self.begin(sightings.iter().map(|sighting| *sighting.bearing.vector()).enumerate());
        let traces = sightings.iter().map(|sighting| sighting.covariance_rad2.trace());
        self.widest_rad2 = traces.fold(0.0, f64::max);
    }

    /// Takes the place of all that were there; each goes by its number.
    pub(super) fn begin(&mut self, directions: impl Iterator<Item = (usize, Vector3<f64>)>) {
        self.sorted.clear();
        self.sorted.extend(directions.map(|(number, direction)| (direction.y, number)));
        self.sorted.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    }

    pub(super) fn len(&self) -> usize {
        self.sorted.len()
    }

    /// All that may lie within `reach_rad` of a direction, and others.
    pub(super) fn near(&self, direction: &Vector3<f64>, reach_rad: f64) -> impl Iterator<Item = usize> + '_ {
        let (low, high) = (direction.y - reach_rad, direction.y + reach_rad);
        let first = self.sorted.partition_point(|&(y, _)| y < low);
        self.sorted[first..].iter().take_while(move |&&(y, _)| y <= high).map(|&(_, number)| number)
    }
}

/// The sightings within the gate of a track whose place has this covariance, rad^2.
pub(super) fn near(
    motion: &Motion,
    sightings: &[Sighting],
    directions: &Directions,
    place_rad2: &Matrix2<f64>,
    mut take: impl FnMut(usize, Offset),
) {
    let ahead = motion.ahead();
    let reach_rad = (GATE * (place_rad2.trace() + directions.widest_rad2)).sqrt().min(FARTHEST_RAD);
    for index in directions.near(&ahead, reach_rad) {
        let Sighting { bearing, covariance_rad2, .. } = &sightings[index];
        if (bearing.vector() - ahead).norm_squared() > reach_rad * reach_rad {
            continue;
        }
        let offset = motion.offset(bearing, covariance_rad2);
        let inverse = (place_rad2 + offset.noise).try_inverse();
        if inverse.is_some_and(|inverse| offset.value.dot(&(inverse * offset.value)) < GATE) {
            take(index, offset);
        }
    }
}
