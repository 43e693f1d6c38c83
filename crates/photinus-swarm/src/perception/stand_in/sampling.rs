//! Flights by rendered frames -> samples to fit the table to.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::{Unit, Vector3};
use photinus_control::{Normal, Seen};

use super::axes;
use super::fit::{Phantoms, Sample, Told, fit, name_s, spot_law};
use super::table::StandInTable;
use crate::metrics::pair;
use crate::perception::{InView, in_view};
use crate::vehicle::State;
use crate::world::World;

/// What flights told of neighbours whose places are known.
#[derive(Clone, Debug, Default)]
pub struct Sampling {
    steady: Samples,
    blinking: Samples,
    flights: usize,
    followed_since: BTreeMap<(usize, u64), f64>,
    names_s: Vec<f64>,
}

/// Those of neighbours whose LEDs do one thing.
#[derive(Clone, Debug, Default)]
struct Samples {
    all: Vec<Sample>,
    phantoms: BTreeSet<(usize, usize, u64)>,
    phantom_s: f64,
    looked_s: f64,
}

impl Samples {
    fn phantoms(&self) -> Phantoms {
        Phantoms { count: self.phantoms.len(), told_s: self.phantom_s, looked_s: self.looked_s }
    }
}

impl Sampling {
    /// A flight begins.
    pub fn begin(&mut self) {
        self.flights += 1;
        self.followed_since.clear();
    }

    /// Takes a frame, after everybody looked. Instruments should be without error: their errors are not those of the eyes.
    pub fn take(&mut self, world: &World) {
        let period_s = world.scenario().period_s();
        let moment = world.moment();
        let mut views = Vec::new();
        for (observer, robot) in world.robots().iter().enumerate() {
            in_view(&moment, observer, &mut views);
            let paired = pair(world, observer);
            let flight = self.flights;
            let into = if world.scenario().codes.is_some() { &mut self.blinking } else { &mut self.steady };
            let works = &moment.vehicles[observer].cameras_work;
            into.looked_s += period_s * works.iter().filter(|works| **works).count() as f64;
            into.all.extend(views.iter().map(|view| {
                let pair = paired.iter().find(|pair| pair.target == view.target);
                let told = pair.map(|pair| {
                    let relative = relative_velocity(&robot.state, &world.robots()[view.target].state);
                    told(&robot.seen[pair.seen], &pair.truth_m, &relative)
                });
                let InView { target, distance_m, markers, light, .. } = *view;
                // pairs of different flights are different pairs
                let pair = (flight * 1000 + observer, target);
                Sample { pair, time_s: moment.time_s, distance_m, markers, light, told }
            }));
            for (index, seen) in robot.seen.iter().enumerate() {
                if !paired.iter().any(|pair| pair.seen == index) {
                    into.phantoms.insert((flight, observer, seen.track));
                    into.phantom_s += period_s;
                }
            }
            robot.seen.iter().for_each(|seen| self.hear(observer, seen, moment.time_s));
        }
    }

    fn hear(&mut self, observer: usize, seen: &Seen, time_s: f64) {
        let since_s = *self.followed_since.entry((observer, seen.track)).or_insert(time_s);
        if seen.identity.is_some() && since_s.is_finite() {
            self.names_s.push(time_s - since_s);
            self.followed_since.insert((observer, seen.track), f64::NEG_INFINITY);
        }
    }

    /// How many samples there are.
    pub fn len(&self) -> usize {
        self.steady.all.len() + self.blinking.all.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The table that they give.
    pub fn table(&self) -> StandInTable {
        StandInTable {
            name_s: name_s(&self.names_s),
            spot_px: spot_law(self.steady.all.iter()),
            steady: fit(&self.steady.all, self.steady.phantoms()),
            blinking: fit(&self.blinking.all, self.blinking.phantoms()),
        }
    }
}

/// The velocity of another against one's own, in the true level frame, m/s.
fn relative_velocity(own: &State, other: &State) -> Vector3<f64> {
    let level = nalgebra::UnitQuaternion::from_scaled_axis(Vector3::z() * -own.heading_rad());
    level * (other.velocity_m_s - own.velocity_m_s)
}

fn told(seen: &Seen, truth_m: &Vector3<f64>, velocity_m_s: &Vector3<f64>) -> Told {
    let distance_m = truth_m.norm();
    let place = seen.position_m.unwrap_or(Normal::exactly(seen.bearing.into_inner() * distance_m));
    let told_m = place.mean.norm();
    let [along, left, up] = axes(&Unit::new_normalize(*truth_m));
    let off = place.mean / told_m;
    let sigma = |axis: &Vector3<f64>| axis.dot(&(place.covariance * axis)).max(0.0).sqrt() / told_m;
    let velocity = seen.velocity_m_s.unwrap_or(Normal::exactly(*velocity_m_s));
    let wrong_m_s = velocity.mean - velocity_m_s;
    let log = |value_m: f64| libm::log(value_m.max(1e-3) / distance_m);
    let is_fresh = seen.age_s <= 0.0;
    // those of an older frame are of where it was then
    let bounds = Some(seen.distance.bounds).filter(|_| is_fresh);
    let estimates = seen.distance.perpendicular_m.zip(seen.distance.inline_m);
    Told {
        log_range: log(told_m),
        across_rad: [off.dot(&left), off.dot(&up)],
        range_sigma: sigma(&along),
        across_sigma_rad: sigma(&left),
        velocity_m_s: [wrong_m_s.dot(&along), wrong_m_s.dot(&left), wrong_m_s.dot(&up)],
        velocity_sigma_m_s: (velocity.covariance.trace() / 3.0).max(0.0).sqrt(),
        log_bounds: [
            bounds.map(|bounds| log(bounds.min_m())),
            bounds.map(|bounds| bounds.max_m()).filter(|far_m| far_m.is_finite()).map(log),
        ],
        log_estimates: estimates.map(|(perpendicular_m, inline_m)| [log(perpendicular_m), log(inline_m)]),
        bearing_bound_rad: seen.bearing_bound_rad,
        spot_px: seen.spot_px.filter(|_| is_fresh),
        is_fresh,
    }
}
