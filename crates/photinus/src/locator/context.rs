//! What a frame tells before anybody is looked for: handed down, never changed in passing.

use nalgebra::{Unit, Vector3};

use super::Sighting;
use super::near::Near;
use super::places::Place;
use super::whereabouts::{PerFrame, Whereabouts};
use crate::camera::Watched;
use crate::pose::LogLight;

/// A frame's observations, and what bears on all of them.
#[derive(Clone, Copy)]
pub(super) struct Context<'a> {
    pub(super) sightings: &'a [Sighting],
    /// The same by direction.
    pub(super) near: &'a Near,
    /// Down in the camera frame, where it is known.
    pub(super) gravity: Option<&'a Unit<Vector3<f64>>>,
    /// Where the camera looks.
    pub(super) watched: Watched<'a>,
    /// Light of an LED straight ahead at 1 m, where the frame tells it.
    pub(super) power: Option<LogLight>,
    /// Light at which a marker is found half of the time, in the unit of the sightings' light, and how much that differs from marker to marker.
    pub(super) detection_limit: Option<LogLight>,
    /// How often a marker that must show does not.
    pub(super) miss_rate: f64,
    /// How far neighbours tilt, per axis, rad.
    pub(super) tilt_sigma_rad: f64,
    /// How many times as much as supposed the power of LEDs spreads.
    pub(super) light_times: f64,
    /// Logarithm of the density of each observation as clutter, per sr and per unit of the logarithm of its light.
    pub(super) clutter: &'a [f64],
    /// Logarithm of how many neighbours there are per sr.
    pub(super) log_neighbours: f64,
    /// Where they were, as far as frames before told.
    pub(super) known: Option<KnownWhereabouts<'a>>,
}

/// Where neighbours were.
#[derive(Clone, Copy)]
pub(super) struct KnownWhereabouts<'a> {
    pub(super) whereabouts: &'a Whereabouts,
    pub(super) per_frame: PerFrame<'a>,
    /// Of each observation.
    pub(super) places: &'a [Place],
}

impl Context<'_> {
    /// The logarithm of how much likelier a neighbour is at an observation and at a distance than anywhere.
    pub(super) fn log_likelier(&self, observation: usize, distance_m: f64) -> f64 {
        self.known.map_or(0.0, |KnownWhereabouts { whereabouts, per_frame, places }| {
            let Place { cell, rad2_per_px2, .. } = places[observation];
            whereabouts.log_likelier(&per_frame, (cell, rad2_per_px2), distance_m)
        })
    }

    /// How much likelier observations are one neighbour than clutter, as a logarithm, where that has this logarithm of the density.
    pub(super) fn gain(&self, group: &[usize], log_density: f64) -> f64 {
        log_density + self.log_neighbours - group.iter().map(|&spot| self.clutter[spot]).sum::<f64>()
    }
}
