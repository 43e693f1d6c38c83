//! Whether the proof of the safety layer applied: every assumption of `docs/safety.md` checked against the truth, frame by frame.

use nalgebra::{UnitQuaternion, UnitVector3, Vector3};
use photinus_control::safety::{Basis, Limits, Sector};
use photinus_control::{Motion, Seen};
use serde::Serialize;

use super::pairing::{Paired, level_from_world, pair};
use super::path::Path;
use crate::mind::Guard;
use crate::world::{Robot, World};

/// What was assumed and how often it was not so. Only what is counted in `slow` and below can excuse a collision.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Contract {
    /// Decisions that the layer took.
    pub decisions: usize,
    /// Those that rest upon the proof.
    pub proven: usize,
    /// Those that brake.
    pub braking: usize,
    /// Those that lead slowly to where nothing is known: outside of the proof.
    pub slow: usize,
    /// A1: a vehicle was faster than its limit.
    pub too_fast: usize,
    /// The highest speed, m/s.
    pub top_speed_m_s: f64,
    /// A1 and A2: a vehicle was farther from the path that it was told, braking at its end, than it may stray.
    pub strayed: usize,
    /// The farthest, m, besides what the error of the velocity explains.
    pub farthest_stray_m: f64,
    /// A2: what a vehicle took for its velocity was off by more than the limit.
    pub velocity_off: usize,
    /// The most, m/s.
    pub largest_velocity_error_m_s: f64,
    /// A3: tells of the frame whose bounds of distance or direction the truth was outside of.
    pub bounds_broken: usize,
    /// A3: what the layer held of a track, from an older frame, was not so of who is on it now: tracks that changed from one to another.
    pub held_broken: usize,
    /// A4: somebody was where the layer took it for known that nobody is, neither seen nor remembered.
    pub unseen_near: usize,
    /// The nearest of them, m.
    pub nearest_unseen_m: Option<f64>,
    /// A5: vehicles that at any time had no layer, did not obey it (a script flew them), or had other limits than the first.
    pub strangers: usize,
    /// A6: pairs that began nearer than allowed.
    pub began_too_near: usize,
    /// When the first of A1 to A6 was broken, s.
    pub first_broken_s: Option<f64>,
    /// Whether all were kept and no decision was slow: then the proof says that no two collided.
    pub proof_applied: bool,
}

impl Contract {
    /// How often any of A1 to A6 was found broken.
    fn broken(&self) -> usize {
        self.too_fast
            + self.strayed
            + self.velocity_off
            + self.bounds_broken
            + self.held_broken
            + self.unseen_near
            + self.strangers
            + self.began_too_near
    }
}

/// Keeps the accounts of a flight; of one without any layer there is nothing to keep.
#[derive(Debug)]
pub(super) struct Notary {
    contract: Contract,
    /// What all keep to: the limits of the first who has any.
    limits: Limits,
    /// Whether each has the layer and obeys it, so far.
    keeps: Vec<bool>,
    paths: Vec<Path>,
    /// The track on which each was last seen by each.
    last_seen: Vec<Vec<Option<u64>>>,
}

impl Notary {
    /// Of a flight that begins; `None` where no vehicle has the layer.
    pub(super) fn new(world: &World) -> Option<Self> {
        let robots = world.robots();
        let limits = *robots.iter().find_map(Robot::guard)?.limits();
        let least_m = limits.separation_m().max(4.0 * limits.stray_m);
        let pairs =
            robots.iter().enumerate().flat_map(|(index, a)| robots[..index].iter().map(move |b| (a, b)));
        let too_near = |(a, b): &(&Robot, &Robot)| (a.state.position_m - b.state.position_m).norm() < least_m;
        let contract = Contract { began_too_near: pairs.filter(too_near).count(), ..Contract::default() };
        Some(Self {
            contract,
            limits,
            keeps: vec![true; robots.len()],
            paths: robots.iter().map(|robot| Path::of_resting(robot.state.position_m)).collect(),
            last_seen: vec![vec![None; robots.len()]; robots.len()],
        })
    }

    /// Takes a frame, after everybody looked and decided.
    pub(super) fn take(&mut self, world: &World) {
        for (index, robot) in world.robots().iter().enumerate() {
            let obeyed = robot.guard().filter(|guard| robot.sees() && *guard.limits() == self.limits);
            self.keeps[index] &= obeyed.is_some();
            if let Some(guard) = obeyed {
                self.take_motion(index, robot, guard, world.time_s());
                self.take_sight(index, world, guard);
            }
        }
        self.contract.strangers = self.keeps.iter().filter(|keeps| !**keeps).count();
        if self.contract.broken() > 0 {
            self.contract.first_broken_s.get_or_insert(world.time_s());
        }
    }

    /// A1 and A2, and what was decided.
    fn take_motion(&mut self, index: usize, robot: &Robot, guard: &Guard, now_s: f64) {
        let Self { contract, paths, .. } = self;
        let (limits, path) = (guard.limits(), &mut paths[index]);
        let world_from_level = UnitQuaternion::from_scaled_axis(Vector3::z() * robot.state.heading_rad());
        let believed_m_s = world_from_level * robot.believed_velocity_m_s();
        let (place_m, velocity_m_s) = (robot.state.position_m, robot.state.velocity_m_s);

        let (speed_m_s, error_m_s) = (velocity_m_s.norm(), (believed_m_s - velocity_m_s).norm());
        let stray_m = path.off_m(&place_m, limits);
        contract.too_fast += usize::from(speed_m_s > limits.speed_m_s);
        contract.velocity_off += usize::from(error_m_s > limits.velocity_error_m_s);
        contract.strayed += usize::from(stray_m > limits.stray_m);
        contract.top_speed_m_s = contract.top_speed_m_s.max(speed_m_s);
        contract.largest_velocity_error_m_s = contract.largest_velocity_error_m_s.max(error_m_s);
        contract.farthest_stray_m = contract.farthest_stray_m.max(stray_m);

        if let Motion::Acceleration(told_m_s2) = robot.setpoint.motion {
            path.tell(world_from_level * told_m_s2, now_s, limits);
        }
        contract.decisions += 1;
        match guard.basis() {
            Basis::Braking => contract.braking += 1,
            Basis::Proven => contract.proven += 1,
            Basis::Slow => contract.slow += 1,
        }
        if guard.basis() != Basis::Braking {
            path.renew(place_m, believed_m_s, now_s, limits);
        }
    }

    /// A3 and A4.
    fn take_sight(&mut self, index: usize, world: &World, guard: &Guard) {
        let robots = world.robots();
        let robot = &robots[index];
        for Paired { seen, target, truth_m } in pair(world, index) {
            let told = &robot.seen[seen];
            // who was on that track before is not any more
            self.last_seen[index]
                .iter_mut()
                .filter(|track| **track == Some(told.track))
                .for_each(|track| *track = None);
            self.last_seen[index][target] = Some(told.track);
            let bounds = told.distance.bounds;
            // the last bit of a sum is no violation
            let slack_m = 1e-9 * truth_m.norm();
            let is_within = bounds.min_m() <= truth_m.norm() + slack_m
                && bounds.max_m() >= truth_m.norm() - slack_m
                && told.bearing.angle(&truth_m) <= told.bearing_bound_rad + 1e-6;
            self.contract.bounds_broken += usize::from(told.age_s <= 0.0 && !is_within);
            let held = guard.held(told.track).filter(|held| held.age_s > 0.0);
            let is_there = held.is_none_or(|held| can_be(held, &truth_m, 2.0 * self.limits.speed_m_s));
            self.contract.held_broken += usize::from(!is_there);
        }
        for (target, other) in robots.iter().enumerate().filter(|(target, _)| *target != index) {
            let way_m = level_from_world(robot) * (other.state.position_m - robot.state.position_m);
            let is_remembered =
                self.last_seen[index][target].is_some_and(|track| guard.held(track).is_some());
            let Some(direction) = UnitVector3::try_new(way_m, 1e-9).filter(|_| !is_remembered) else {
                continue;
            };
            if way_m.norm() < guard.empty_m(&direction) {
                self.contract.unseen_near += 1;
                let nearest_m = self.contract.nearest_unseen_m.get_or_insert(f64::INFINITY);
                *nearest_m = nearest_m.min(way_m.norm());
            }
        }
    }

    /// The accounts.
    pub(super) fn contract(self) -> Contract {
        let proof_applied = self.contract.broken() == 0 && self.contract.slow == 0;
        Contract { proof_applied, ..self.contract }
    }
}

/// Whether somebody can be at a place who was seen so, where two close in at `closing_m_s` at the most.
fn can_be(seen: &Seen, place_m: &Vector3<f64>, closing_m_s: f64) -> bool {
    let sector = Sector {
        axis: seen.bearing,
        half_angle_rad: seen.bearing_bound_rad,
        distances: seen.distance.bounds,
    };
    sector.distance_m(place_m) <= closing_m_s * seen.age_s + 1e-6
}
