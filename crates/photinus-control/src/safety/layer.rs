//! The layer itself: the wanted set-point where it is safe, the safe one nearest to it, or braking.

use nalgebra::{Rotation3, Vector3};

use super::alternatives::alternatives;
use super::commitment::{Commitment, Underway};
use super::lost::Lost;
use super::places::{Ground, Place};
use super::told::Told;
use super::{Cone, Limits, LimitsError, Obstacle, Sector, Watch};
use crate::{Motion, OwnState, Seen, Setpoint};

/// How fast a wanted velocity is approached, 1/s.
const APPROACH_PER_S: f64 = 3.0;

/// What a guarded set-point rests upon.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Basis {
    /// The commitment keeps clear of everything: the proof holds.
    Proven,
    /// It leads towards where nothing is known, slowly: no proof, unless nobody is there.
    Slow,
    /// Nothing else was allowed: it brakes, or stands. The commitment before stays, and so does what it rested upon.
    Braking,
}

/// What may be flown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Guarded {
    /// An acceleration, with the yaw rate that was wanted.
    pub setpoint: Setpoint,
    /// What it rests upon.
    pub basis: Basis,
}

/// Stands in front of any controller.
#[derive(Clone, Debug, PartialEq)]
pub struct Safety {
    limits: Limits,
    told: Told,
    lost: Lost,
    underway: Underway,
    /// For how long it has been slow enough to part, s.
    slow_s: f64,
    places: Vec<Place>,
}

impl Safety {
    /// A layer for a vehicle at rest in a group with these limits.
    pub fn new(limits: Limits) -> Result<Self, LimitsError> {
        limits.check()?;
        let (told, lost, underway) = (Told::default(), Lost::default(), Underway::default());
        Ok(Self { limits, told, lost, underway, slow_s: 0.0, places: Vec::new() })
    }

    /// What is held of a track that is seen, or was and is taken to be still there: the sight that tells most, `age_s` ago.
    pub fn held(&self, track: u64) -> Option<&Seen> {
        self.lost.all().iter().find(|seen| seen.track == track)
    }

    /// The limits of the group.
    pub fn limits(&self) -> &Limits {
        &self.limits
    }

    /// What to fly instead of `wanted`, `dt_s` after the last call. `watch` says where nobody is who is not in `seen`; a track that is
    /// missing is taken to be still there until the watch has looked anew wherever it can be. `obstacles`
    /// are what a map shows, in the level frame. A vehicle that does not know its own velocity is told to stand.
    pub fn guard(
        &mut self,
        own: &OwnState,
        seen: &[Seen],
        watch: &Watch,
        obstacles: &[Obstacle],
        wanted: &Setpoint,
        dt_s: f64,
    ) -> Guarded {
        let dt_s = if dt_s >= 0.0 { dt_s } else { self.limits.period_s };
        let level_from_before = Rotation3::from_axis_angle(&Vector3::z_axis(), -own.turn_rad_s() * dt_s);
        self.told.pass(&level_from_before, dt_s, self.limits.delay_s);
        let limits = self.limits;
        let closing_m_s = 2.0 * limits.speed_m_s;
        self.lost.update(seen, &level_from_before, dt_s, closing_m_s, |old| is_gone(old, watch, &limits));
        let yaw_rate_rad_s = if wanted.yaw_rate_rad_s.is_finite() { wanted.yaw_rate_rad_s } else { 0.0 };
        let velocity = own.velocity_m_s.map(|v| v.mean).filter(|v| v.iter().all(|x| x.is_finite()));
        let Some(velocity) = velocity else {
            self.told.tell(Vector3::zeros());
            self.slow_s = 0.0;
            return Guarded { setpoint: Setpoint::stand().turning(yaw_rate_rad_s), basis: Basis::Braking };
        };
        self.told.carry_out(&mut self.underway, velocity, &self.limits);
        self.gather(velocity, watch, obstacles);
        let (acceleration, basis) = self.choose(wanted);
        let path = Commitment::new(&self.limits, &self.underway, acceleration);
        let is_slow =
            path.top_speed_m_s() + self.limits.velocity_error_m_s <= self.limits.parting_speed_m_s();
        self.slow_s = if is_slow { self.slow_s + dt_s } else { 0.0 };
        self.told.tell(acceleration);
        Guarded { setpoint: Setpoint::acceleration(acceleration).turning(yaw_rate_rad_s), basis }
    }

    /// Collects what a commitment has to keep clear of.
    fn gather(&mut self, velocity: Vector3<f64>, watch: &Watch, obstacles: &[Obstacle]) {
        let limits = self.limits;
        // Both may have moved since a sight that is this old.
        let own_speed = |age_s: f64| {
            (velocity.norm() + limits.velocity_error_m_s + limits.acceleration_m_s2 * age_s)
                .min(limits.speed_m_s)
        };
        let grown_m = |age_s: f64| (limits.speed_m_s + own_speed(age_s)) * age_s;
        let parts = self.slow_s > limits.stopping_s();
        self.places.clear();
        for s in self.lost.all() {
            let sector =
                Sector { axis: s.bearing, half_angle_rad: bound_rad(s), distances: s.distance.bounds };
            // An age that is no number may be any.
            let age_s = if s.age_s.is_nan() { f64::INFINITY } else { s.age_s.max(0.0) };
            self.places.push(Place::Neighbour { sector, grown_m: grown_m(age_s), parts });
        }
        let unknown =
            watch.unknown().map(|(sector, age_s)| Place::Unknown { sector, grown_m: grown_m(age_s), parts });
        self.places.extend(unknown);
        self.places.extend(obstacles.iter().map(|body| Place::Body(*body)));
        self.places.retain(|place| place.matters(&limits));
    }

    /// The acceleration nearest to the wanted one that leads into a commitment that is allowed.
    fn choose(&self, wanted: &Setpoint) -> (Vector3<f64>, Basis) {
        let limits = &self.limits;
        let then = self.underway.velocity();
        let brake = within(-then / limits.period_s, limits.braking_m_s2);
        let wanted = match wanted.motion {
            Motion::Acceleration(acceleration) => acceleration,
            Motion::Velocity(wanted) => (wanted - then) * APPROACH_PER_S,
        };
        if !wanted.iter().all(|x| x.is_finite()) {
            return (brake, Basis::Braking);
        }
        let most = limits.speed_m_s - limits.velocity_error_m_s;
        let slowed = |acceleration: Vector3<f64>| {
            let acceleration = within(acceleration, limits.acceleration_m_s2);
            (within(then + acceleration * limits.period_s, most) - then) / limits.period_s
        };
        let wanted = slowed(wanted);
        if let Some(basis) = self.basis(wanted) {
            return (wanted, basis);
        }
        let mut best: Option<(f64, Vector3<f64>, Basis)> = None;
        for acceleration in alternatives(wanted, brake, limits.acceleration_m_s2).map(slowed) {
            let off = (acceleration - wanted).norm_squared();
            if best.is_some_and(|(least, ..)| least <= off) {
                continue;
            }
            if let Some(basis) = self.basis(acceleration) {
                best = Some((off, acceleration, basis));
            }
        }
        best.map_or((brake, Basis::Braking), |(_, acceleration, basis)| (acceleration, basis))
    }

    /// What a commitment to an acceleration rests upon; `None` where it is not allowed.
    fn basis(&self, next: Vector3<f64>) -> Option<Basis> {
        let limits = &self.limits;
        let path = Commitment::new(limits, &self.underway, next);
        if next.norm() > limits.acceleration_m_s2 * (1.0 + 1e-9)
            || path.top_speed_m_s() > limits.speed_m_s * (1.0 + 1e-9)
        {
            return None;
        }
        let mut ground = Ground::Clear;
        for place in &self.places {
            ground = ground.max(place.allows(limits, &path));
            if ground == Ground::Blocked {
                return None;
            }
        }
        Some(if ground == Ground::Slow { Basis::Slow } else { Basis::Proven })
    }
}

/// Whether the watch speaks for one who is not seen any more: it has looked anew wherever that one can be by now.
fn is_gone(old: &Seen, watch: &Watch, limits: &Limits) -> bool {
    if old.age_s.is_nan() {
        return true;
    }
    if old.age_s <= watch.patience_s() {
        return false;
    }
    let (near_m, moved_m) = (old.distance.bounds.min_m(), 2.0 * limits.speed_m_s * old.age_s);
    let turned_rad = if moved_m < near_m { libm::asin(moved_m / near_m) } else { core::f64::consts::PI };
    let cone = Cone { axis: old.bearing, half_angle_rad: bound_rad(old) + turned_rad };
    watch.is_newer(&cone, old.age_s)
}

/// How far a neighbour's direction is from its bearing, rad: anywhere, where that is no number.
fn bound_rad(seen: &Seen) -> f64 {
    let is_known = seen.bearing_bound_rad >= 0.0 && seen.bearing.iter().all(|x| x.is_finite());
    if is_known { seen.bearing_bound_rad.min(core::f64::consts::PI) } else { core::f64::consts::PI }
}

/// A vector shortened to a length.
fn within(vector: Vector3<f64>, most: f64) -> Vector3<f64> {
    let norm = vector.norm();
    if norm > most { vector * (most / norm) } else { vector }
}
