//! All that is said of a set-up.

use serde::Serialize;

use crate::battery::Battery;
use crate::eyes::Eyes;
use crate::layouts::{self, Layout};
use crate::range::{AtAspect, AtRange, Range, Reach};
use crate::setup::Setup;
use crate::spot::SpotTable;

/// Shares of the range at which aspects are shown.
const ASPECTS_AT: [f64; 3] = [0.25, 0.5, 0.75];
/// Lines of the table over distance for each doubling.
const PER_OCTAVE: f64 = 3.0;

/// All that is said of a set-up.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Plan {
    /// How far frames show one spot, which tells a direction.
    pub direction: Reach,
    /// How far frames show two, which a distance needs.
    pub distance: Reach,
    /// Yaw is told modulo this, rad.
    pub yaw_turn_rad: f64,
    /// Over distance, from a metre to where half of the frames tell one.
    pub over_distance: Vec<AtRange>,
    /// Over the aspect: at a quarter, a half and three quarters of that, each with its distance, m.
    pub over_aspect: Vec<(f64, Vec<AtAspect>)>,
    /// Layouts of as many LEDs at the wanted range, m, the best first.
    pub wanted_m: f64,
    /// Those layouts.
    pub layouts: Vec<Layout>,
    /// What the light costs, where the set-up says what carries it.
    pub battery: Option<Battery>,
    /// From where on the light harms no eye.
    pub eyes: Eyes,
}

impl Plan {
    /// Works it out: some seconds.
    pub fn new(setup: &Setup) -> Self {
        let table = SpotTable::new(setup);
        let mut range = Range::new(setup, &table, &setup.airframe);
        let [direction, distance] = range.reach();
        let farthest_m = distance.half_m.max(2.0);
        let steps = (libm::log2(farthest_m) * PER_OCTAVE).floor() as usize;
        let mut distances: Vec<f64> = (0..=steps).map(|step| libm::exp2(step as f64 / PER_OCTAVE)).collect();
        if farthest_m > 1.05 * distances[steps] {
            distances.push(farthest_m);
        }
        Self {
            direction,
            distance,
            yaw_turn_rad: core::f64::consts::TAU / range.turns() as f64,
            over_distance: distances.into_iter().map(|distance_m| range.at(distance_m)).collect(),
            over_aspect: ASPECTS_AT
                .map(|share| share * farthest_m)
                .map(|distance_m| (distance_m, range.aspects(distance_m)))
                .into(),
            wanted_m: setup.wanted_m,
            layouts: layouts::compare(setup, &table),
            battery: Battery::of(setup),
            eyes: Eyes::of(setup),
        }
    }
}
