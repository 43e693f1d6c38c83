//! What is known of every vehicle of the group, and what safety rests upon.

use core::fmt;

/// Limits that hold for every vehicle of the group; `docs/safety.md` says how to find them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Radius of a ball around the airframe's origin that holds the whole vehicle, m.
    pub radius_m: f64,
    /// No vehicle is ever faster, m/s.
    pub speed_m_s: f64,
    /// No vehicle is told to accelerate harder, m/s^2.
    pub acceleration_m_s2: f64,
    /// Every vehicle brakes at least as hard, m/s^2.
    pub braking_m_s2: f64,
    /// From a set-point to the time when it is flown, s: computing, link, tilt.
    pub delay_s: f64,
    /// Longest time from one set-point to the next, s.
    pub period_s: f64,
    /// How far a vehicle strays from the path that it was told to fly, and from the place where it stands, m.
    pub stray_m: f64,
    /// How far what a vehicle knows of its own velocity is from the truth, m/s.
    pub velocity_error_m_s: f64,
    /// How fast to fly towards where nothing is known, m/s.
    pub unknown_speed_m_s: f64,
}

/// A limit that no vehicle has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LimitsError {
    /// The name of the limit.
    pub limit: &'static str,
    /// What it was.
    pub value: f64,
    /// What it has to be.
    pub expected: &'static str,
}

impl fmt::Display for LimitsError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} is {}: expected {}", self.limit, self.value, self.expected)
    }
}

impl core::error::Error for LimitsError {}

impl Limits {
    /// A small multirotor of 0.8 m that flies up to 2 m/s, brakes at 4 m/s^2 and gets frames at 30 Hz.
    pub fn small_multirotor() -> Self {
        Self {
            radius_m: 0.4,
            speed_m_s: 2.0,
            acceleration_m_s2: 5.0,
            braking_m_s2: 4.0,
            delay_s: 0.1,
            period_s: 1.0 / 30.0,
            stray_m: 0.02,
            velocity_error_m_s: 0.05,
            unknown_speed_m_s: 0.3,
        }
    }

    /// Refuses what has no meaning.
    pub fn check(&self) -> Result<(), LimitsError> {
        let positive = [
            ("radius_m", self.radius_m),
            ("speed_m_s", self.speed_m_s),
            ("braking_m_s2", self.braking_m_s2),
            ("period_s", self.period_s),
        ];
        for (limit, value) in positive {
            if !(value.is_finite() && value > 0.0) {
                return Err(LimitsError { limit, value, expected: "a number greater than 0" });
            }
        }
        let others = [
            ("delay_s", self.delay_s),
            ("stray_m", self.stray_m),
            ("velocity_error_m_s", self.velocity_error_m_s),
            ("unknown_speed_m_s", self.unknown_speed_m_s),
        ];
        for (limit, value) in others {
            if !(value.is_finite() && value >= 0.0) {
                return Err(LimitsError { limit, value, expected: "0 or a number greater than 0" });
            }
        }
        if !(self.acceleration_m_s2.is_finite() && self.acceleration_m_s2 >= self.braking_m_s2) {
            let (limit, value) = ("acceleration_m_s2", self.acceleration_m_s2);
            return Err(LimitsError { limit, value, expected: "at least braking_m_s2" });
        }
        if self.velocity_error_m_s >= self.speed_m_s {
            let (limit, value) = ("velocity_error_m_s", self.velocity_error_m_s);
            return Err(LimitsError { limit, value, expected: "less than speed_m_s" });
        }
        Ok(())
    }

    /// Origins that are nearer than this are a collision, m.
    pub fn separation_m(&self) -> f64 {
        2.0 * self.radius_m
    }

    /// How far any vehicle still moves, at the most, if it brakes from its next set-point on, m: how far its commitment reaches.
    pub fn longest_reach_m(&self) -> f64 {
        let speed = self.speed_m_s;
        speed * self.blind_s() + speed * speed / (2.0 * self.braking_m_s2) + self.longest_stray_m()
    }

    /// How near an origin may be, at the least, for anybody to renew a commitment, m: nearer ones brake.
    pub fn clearance_m(&self) -> f64 {
        self.separation_m() + self.longest_reach_m()
    }

    /// How far away a neighbour has to be seen for full speed towards it, m, if it is seen `age_s` late: the range of sight that
    /// the claim needs.
    pub fn sight_m(&self, age_s: f64) -> f64 {
        self.clearance_m() + self.longest_reach_m() + 2.0 * self.speed_m_s * age_s
    }

    /// From a set-point to the first time when another one can be flown, s.
    pub(super) fn blind_s(&self) -> f64 {
        self.delay_s + self.period_s
    }

    /// How long any vehicle takes, at the most, from its last set-point until it stands, s.
    pub(super) fn stopping_s(&self) -> f64 {
        self.blind_s() + self.speed_m_s / self.braking_m_s2
    }

    /// How far a vehicle that brakes from `speed_m_s` is from where its knowledge of its own velocity puts it, m: the error lasts
    /// until it brakes, and changes how far it brakes.
    pub(super) fn stray_at_m(&self, speed_m_s: f64) -> f64 {
        let error = self.velocity_error_m_s;
        self.stray_m + error * (self.blind_s() + (speed_m_s + error) / self.braking_m_s2)
    }

    pub(super) fn longest_stray_m(&self) -> f64 {
        self.stray_at_m(self.speed_m_s)
    }

    /// How fast to part from those who are too near, m/s: slow enough that the line of sight turns by less than
    /// [`PARTING_TURN_RAD`] while a commitment lasts, and that all of the way since anybody else's commitment, who stops in
    /// [`Self::stopping_s`], is within what that one keeps clear.
    pub(super) fn parting_speed_m_s(&self) -> f64 {
        let (blind, braking) = (self.blind_s(), self.braking_m_s2);
        // Both: 2 v (blind + v / a) <= separation sin(turn).
        let turning = largest(0.5 * self.separation_m() * libm::sin(PARTING_TURN_RAD), blind, 1.0 / braking);
        // v (stopping + blind) + v^2 / 2a + strays <= longest reach.
        let room = self.longest_reach_m() - 2.0 * self.longest_stray_m();
        turning.min(largest(room, self.stopping_s() + blind, 0.5 / braking)).min(self.speed_m_s)
    }
}

/// The largest x for which `linear x + square x^2 <= most`; zero where none is.
fn largest(most: f64, linear: f64, square: f64) -> f64 {
    if most <= 0.0 {
        0.0
    } else {
        (libm::sqrt(linear * linear + 4.0 * square * most) - linear) / (2.0 * square)
    }
}

/// How far the line of sight between two who part may turn while a commitment lasts, rad.
pub(super) const PARTING_TURN_RAD: f64 = 15.0 * core::f64::consts::PI / 180.0;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_without_meaning_are_refused_by_name() {
        let good = Limits::small_multirotor();
        assert_eq!(good.check(), Ok(()));
        for (bad, name) in [
            (Limits { radius_m: 0.0, ..good }, "radius_m"),
            (Limits { speed_m_s: f64::NAN, ..good }, "speed_m_s"),
            (Limits { braking_m_s2: -1.0, ..good }, "braking_m_s2"),
            (Limits { acceleration_m_s2: 1.0, ..good }, "acceleration_m_s2"),
            (Limits { delay_s: f64::INFINITY, ..good }, "delay_s"),
            (Limits { velocity_error_m_s: 3.0, ..good }, "velocity_error_m_s"),
        ] {
            let error = bad.check().unwrap_err();
            assert!(error.limit == name && error.to_string().contains(name), "{error}");
        }
    }

    #[test]
    fn parting_is_as_fast_as_turn_and_room_allow() {
        let l = Limits::small_multirotor();
        let v = l.parting_speed_m_s();
        let sine = 2.0 * v * (l.blind_s() + v / l.braking_m_s2) / l.separation_m();
        let way =
            v * (l.stopping_s() + l.blind_s()) + 0.5 * v * v / l.braking_m_s2 + 2.0 * l.longest_stray_m();
        let (turn, room) = (libm::asin(sine) - PARTING_TURN_RAD, way - l.longest_reach_m());
        assert!(
            turn.max(room).max(-1e-9) < 1e-9 && (turn.abs() < 1e-9 || room.abs() < 1e-9),
            "{turn} {room}"
        );
    }
}
