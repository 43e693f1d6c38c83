//! Which reported neighbour is which vehicle: by direction and distance, each vehicle once.

use nalgebra::{UnitQuaternion, Vector3};
use photinus_control::Seen;

use crate::world::{Robot, World};

/// A reported neighbour and the vehicle that it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Paired {
    /// Which of those who were told.
    pub seen: usize,
    /// Which vehicle.
    pub target: usize,
    /// Where that is in the level frame of the one who looks, m.
    pub truth_m: Vector3<f64>,
}

/// Directions farther apart than this are of two, rad, besides what an airframe spans.
const DIRECTION_RAD: f64 = 0.15;
/// Half of what an airframe spans, m.
const SPAN_M: f64 = 0.5;
/// Distances that differ by more than this factor's logarithm are of two: a fifth to five times.
const LOG_RANGE: f64 = 1.6;
/// A factor of e in distance counts as much as this angle, rad.
const RAD_PER_LOG: f64 = 0.1;

/// Pairs those whom `observer` was told of with those who are there: the best first, until none is left within the gates.
pub fn pair(world: &World, observer: usize) -> Vec<Paired> {
    let robots = world.robots();
    let own = &robots[observer];
    let level_from_world = level_from_world(own);
    let truths: Vec<Vector3<f64>> = robots
        .iter()
        .map(|robot| level_from_world * (robot.state.position_m - own.state.position_m))
        .collect();
    let mut ways: Vec<(f64, usize, usize)> = Vec::new();
    for (index, seen) in own.seen.iter().enumerate() {
        for (target, truth_m) in truths.iter().enumerate().filter(|(target, _)| *target != observer) {
            ways.extend(cost(seen, truth_m).map(|cost| (cost, index, target)));
        }
    }
    ways.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)).then(a.2.cmp(&b.2)));
    let (mut taken_seen, mut taken_target) = (vec![false; own.seen.len()], vec![false; robots.len()]);
    let mut paired = Vec::new();
    for (_, seen, target) in ways {
        if !taken_seen[seen] && !taken_target[target] {
            (taken_seen[seen], taken_target[target]) = (true, true);
            paired.push(Paired { seen, target, truth_m: truths[target] });
        }
    }
    paired.sort_by_key(|paired| paired.seen);
    paired
}

/// The true level frame: without the error of the instruments.
pub(super) fn level_from_world(robot: &Robot) -> UnitQuaternion<f64> {
    UnitQuaternion::from_scaled_axis(Vector3::z() * -robot.state.heading_rad())
}

/// How badly a reported neighbour fits a true one; `None` where it does not fit at all.
fn cost(seen: &Seen, truth_m: &Vector3<f64>) -> Option<f64> {
    let distance_m = truth_m.norm();
    let angle_rad = libm::acos((seen.bearing.dot(truth_m) / distance_m).clamp(-1.0, 1.0));
    let told_m = seen.position_m.map_or(distance_m, |place| place.mean.norm());
    let log_range = libm::log(told_m.max(1e-3) / distance_m).abs();
    let near = angle_rad < DIRECTION_RAD + SPAN_M / distance_m && log_range < LOG_RANGE;
    near.then_some(angle_rad + RAD_PER_LOG * log_range)
}
