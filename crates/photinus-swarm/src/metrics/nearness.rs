//! Who came how near to whom.

use std::collections::BTreeSet;

use serde::Serialize;

use crate::scenario::Scenario;
use crate::world::{Partner, Touch};

/// A collision.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Collision {
    /// When it began, s.
    pub time_s: f64,
    /// A vehicle.
    pub vehicle: usize,
    /// The other one, or `null` for an obstacle.
    pub other: Option<usize>,
    /// The obstacle, by its place in the file (a gate is four).
    pub obstacle: Option<usize>,
}

#[derive(Debug)]
pub(super) struct Nearness {
    radii_m: Vec<f64>,
    touching: BTreeSet<(usize, bool, usize)>,
    pub(super) touches: Vec<Collision>,
    smallest_distance_m: f64,
    smallest_clearance_m: f64,
    smallest_obstacle_clearance_m: f64,
}

impl Nearness {
    pub(super) fn new(scenario: &Scenario) -> Self {
        Self {
            radii_m: scenario.vehicles.iter().map(|vehicle| vehicle.kind.build.radius_m).collect(),
            touching: BTreeSet::new(),
            touches: Vec::new(),
            smallest_distance_m: f64::INFINITY,
            smallest_clearance_m: f64::INFINITY,
            smallest_obstacle_clearance_m: f64::INFINITY,
        }
    }

    pub(super) fn take(&mut self, touch: &Touch) {
        let own_m = self.radii_m[touch.vehicle];
        let (key, clearance_m) = match touch.with {
            Partner::Vehicle(other) => {
                let clearance_m = touch.distance_m - own_m - self.radii_m[other];
                self.smallest_distance_m = self.smallest_distance_m.min(touch.distance_m);
                self.smallest_clearance_m = self.smallest_clearance_m.min(clearance_m);
                ((touch.vehicle, true, other), clearance_m)
            }
            Partner::Obstacle(index) => {
                let clearance_m = touch.distance_m - own_m;
                self.smallest_obstacle_clearance_m = self.smallest_obstacle_clearance_m.min(clearance_m);
                ((touch.vehicle, false, index), clearance_m)
            }
        };
        if clearance_m >= 0.0 {
            self.touching.remove(&key);
        } else if self.touching.insert(key) {
            let (other, obstacle) = match touch.with {
                Partner::Vehicle(other) => (Some(other), None),
                Partner::Obstacle(index) => (None, Some(index)),
            };
            let vehicle = touch.vehicle;
            self.touches.push(Collision { time_s: touch.time_s, vehicle, other, obstacle });
        }
    }

    pub(super) fn collisions(&self) -> usize {
        self.touches.iter().filter(|touch| touch.other.is_some()).count()
    }

    pub(super) fn obstacle_collisions(&self) -> usize {
        self.touches.len() - self.collisions()
    }

    pub(super) fn smallest_distance_m(&self) -> Option<f64> {
        finite(self.smallest_distance_m)
    }

    pub(super) fn smallest_clearance_m(&self) -> Option<f64> {
        finite(self.smallest_clearance_m)
    }

    pub(super) fn smallest_obstacle_clearance_m(&self) -> Option<f64> {
        finite(self.smallest_obstacle_clearance_m)
    }
}

fn finite(value: f64) -> Option<f64> {
    value.is_finite().then_some(value)
}
