//! Where vehicles begin: drawn anew for every seed.

use core::f64::consts::TAU;

use nalgebra::Vector3;

use crate::chance::{Chance, Use};

/// How a group is laid out.
#[derive(Clone, Debug, PartialEq)]
pub struct Layout {
    /// How many.
    pub count: usize,
    /// Where.
    pub(crate) place: Place,
    /// How far each strays from there, sigma per axis, m.
    pub jitter_m: f64,
}

#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Place {
    At { places_m: Vec<Vector3<f64>>, headings_rad: Vec<f64> },
    Ring { centre_m: Vector3<f64>, radius_m: f64, facing_rad: f64 },
    Grid { centre_m: Vector3<f64>, spacing_m: f64, heading_rad: f64 },
    Random { centre_m: Vector3<f64>, half_m: Vector3<f64>, apart_m: f64, heading_rad: Option<f64> },
}

/// A place to begin at, with a heading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Start {
    pub(crate) position_m: Vector3<f64>,
    pub(crate) heading_rad: f64,
}

/// A crowd that does not fit after this many tries does not fit.
const TRIES: usize = 20_000;

impl Layout {
    /// The places of the group under a seed; `None` where that many do not fit so far apart.
    pub(crate) fn starts(&self, seed: u64, group: u64) -> Option<Vec<Start>> {
        let mut chance = Chance::new(seed, Use::Places, group);
        let mut starts = Vec::with_capacity(self.count);
        for index in 0..self.count {
            let start = match &self.place {
                Place::At { places_m, headings_rad } => Start {
                    position_m: places_m[index],
                    heading_rad: headings_rad.get(index).copied().unwrap_or(0.0),
                },
                Place::Ring { centre_m, radius_m, facing_rad } => {
                    let angle_rad = TAU * index as f64 / self.count as f64;
                    let (sin, cos) = libm::sincos(angle_rad);
                    let position_m = centre_m + Vector3::new(cos, sin, 0.0) * *radius_m;
                    Start { position_m, heading_rad: angle_rad + facing_rad }
                }
                Place::Grid { centre_m, spacing_m, heading_rad } => {
                    let side = (self.count as f64).sqrt().ceil() as usize;
                    let off = |at: usize| at as f64 - (side as f64 - 1.0) / 2.0;
                    let position_m =
                        centre_m + Vector3::new(off(index / side), off(index % side), 0.0) * *spacing_m;
                    Start { position_m, heading_rad: *heading_rad }
                }
                Place::Random { centre_m, half_m, apart_m, heading_rad } => {
                    let clear = |place: &Vector3<f64>, starts: &[Start]| {
                        starts.iter().all(|other| (other.position_m - place).norm() >= *apart_m)
                    };
                    let mut draw = || {
                        let [x, y, z] = [chance.uniform(), chance.uniform(), chance.uniform()];
                        centre_m + (Vector3::new(x, y, z) * 2.0 - Vector3::repeat(1.0)).component_mul(half_m)
                    };
                    let position_m = (0..TRIES).map(|_| draw()).find(|place| clear(place, &starts))?;
                    Start { position_m, heading_rad: heading_rad.unwrap_or_else(|| TAU * chance.uniform()) }
                }
            };
            let strays = chance.normals() * self.jitter_m;
            starts.push(Start { position_m: start.position_m + strays, ..start });
        }
        Some(starts)
    }
}
