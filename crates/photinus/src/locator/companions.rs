//! Which observations lie beside each other: clutter comes in clumps (a glint and its neighbour, a window's two edges).
//!
//! In: the observations of a frame. Out: of each, those near it, with how dense clutter is at it if the other one is clutter. Clumps have no scale of
//! their own: a companion is as likely at any logarithm of distance, and about as bright.

use alloc::vec::Vec;
use core::f64::consts::{PI, TAU};

use super::Sighting;
use super::cells::{ByCell, Cells};
#[cfg(not(feature = "std"))]
use crate::float::Float as _;
use crate::normal;

/// A point of clutter has this many companions.
const COMPANIONS: f64 = 0.2;
/// They are so far away, px: apart from it, and no further than structures of a scene are large.
const NEAREST_PX: f64 = 2.5;
const FARTHEST_PX: f64 = 100.0;
/// Standard deviation of the logarithm of their light over its own.
const LIGHT_SIGMA: f64 = 0.7;
/// Where more observations are near each other than this, on average, clutter is dense whether or not it clumps: those further off are left out.
const MOST_NEAR: f64 = 16.0;

impl Companion {
    /// That density where observations are clutter that comes and goes as likely as `shares` tells.
    pub(super) fn density_at(&self, shares: &[f64]) -> f64 {
        shares[self.observation] * self.density
    }
}

/// The companions of each observation of a frame.
#[derive(Debug)]
pub(super) struct Companions {
    by_cell: ByCell,
    list: Vec<Companion>,
    ends: Vec<usize>,
}

/// An observation beside another.
#[derive(Clone, Copy, Debug)]
pub(super) struct Companion {
    pub(super) observation: usize,
    /// Density of clutter at the one, per px^2 and per unit of the logarithm of light, that the other brings if it is clutter.
    pub(super) density: f64,
}

impl Companions {
    /// None yet, with room for those of a frame of a thousand observations.
    pub(super) fn new() -> Self {
        Self {
            by_cell: ByCell::default(),
            list: Vec::with_capacity(1024 * MOST_NEAR as usize),
            ends: Vec::with_capacity(1024),
        }
    }

    /// Finds them in an image of `size` (width, height) px. Without `with_light` the density is one of places alone.
    pub(super) fn find(&mut self, sightings: &[Sighting], size: [usize; 2], with_light: bool) {
        let per_px2 = sightings.len() as f64 / (size[0] * size[1]) as f64;
        let reach_px = (MOST_NEAR / (PI * per_px2)).sqrt().clamp(NEAREST_PX, FARTHEST_PX);
        let cells = Cells::new(size, reach_px);
        self.by_cell.sort(&cells, sightings);
        self.list.clear();
        self.ends.clear();
        for (index, own) in sightings.iter().enumerate() {
            let near = self.by_cell.near(&cells, sightings, index, reach_px);
            self.list.extend(near.map(|(observation, gap_px)| {
                let density = density(gap_px, own, &sightings[observation], with_light);
                Companion { observation, density }
            }));
            self.ends.push(self.list.len());
        }
    }

    /// Those of an observation.
    pub(super) fn of(&self, observation: usize) -> &[Companion] {
        let start = if observation == 0 { 0 } else { self.ends[observation - 1] };
        &self.list[start..self.ends[observation]]
    }
}

/// Even over the logarithm of distance, and log-normal in light.
fn density(gap_px: f64, own: &Sighting, other: &Sighting, with_light: bool) -> f64 {
    let gap_px = gap_px.max(NEAREST_PX);
    let place = COMPANIONS / (TAU * libm::log(FARTHEST_PX / NEAREST_PX) * gap_px * gap_px);
    let lights = own.log_light.zip(other.log_light).filter(|_| with_light);
    about_as_bright(place, lights.map(|(own, other)| own.value - other.value), LIGHT_SIGMA)
}

/// A density of places, of clutter about as bright as something: log-normal where it is known how much brighter it is.
pub(super) fn about_as_bright(place: f64, brighter: Option<f64>, sigma: f64) -> f64 {
    brighter.map_or(place, |brighter| place * normal::density(brighter / sigma, sigma))
}
