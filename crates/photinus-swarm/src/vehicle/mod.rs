//! A multirotor, to second order: enters a thrust and a rate of turn that are wanted, leaves where it is, how fast, how turned.
//!
//! ```text
//! wanted acceleration -> attitude and thrust within limits    autopilot
//! attitude, thrust    -> motion                               State::step
//! motion              -> what its own instruments say         instruments
//! ```
//!
//! It is a point with an attitude: thrust along the body's z axis and the rate of turn follow their commands with a lag of first order, and the air
//! drags in proportion to the speed against it, and to its square. Rotors, inertia and ground effect are left out.

mod autopilot;
mod instruments;
#[cfg(test)]
mod tests;
mod wind;

use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use photinus_sim::snapshot::Kinematics;

pub use autopilot::{Autopilot, Wanted};
pub use instruments::{Accuracy, Instruments, Own};
pub use wind::{Wind, WindField};

/// Standard gravity, m/s^2.
pub const GRAVITY_M_S2: f64 = 9.806_65;

/// A vehicle as it was built.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Build {
    /// Its mass, kg.
    pub mass_kg: f64,
    /// The largest thrust of all its rotors together, N.
    pub thrust_n: f64,
    /// The largest tilt that its autopilot asks for, rad.
    pub tilt_rad: f64,
    /// The largest rate of turn about each axis that its autopilot asks for, rad/s.
    pub turn_rad_s: f64,
    /// The largest speed that its autopilot goes for along the ground, m/s.
    pub speed_m_s: f64,
    /// Drag in proportion to the speed against the air, N per m/s: that of the rotors.
    pub drag_n_s_m: f64,
    /// Drag in proportion to its square, N per (m/s)^2: that of the frame.
    pub drag_n_s2_m2: f64,
    /// Radius of the ball that it needs: two that are nearer than the sum of theirs have collided, m.
    pub radius_m: f64,
    /// Time constant of the rotors' thrust, s.
    pub thrust_lag_s: f64,
    /// Time constant of the rate of turn, s.
    pub turn_lag_s: f64,
}

impl Default for Build {
    /// A quadrotor of 2 kg that weighs half of what its rotors lift.
    fn default() -> Self {
        Self {
            mass_kg: 2.0,
            thrust_n: 40.0,
            tilt_rad: 0.6,
            turn_rad_s: 4.0,
            speed_m_s: 5.0,
            drag_n_s_m: 0.3,
            drag_n_s2_m2: 0.03,
            radius_m: 0.4,
            thrust_lag_s: 0.04,
            turn_lag_s: 0.05,
        }
    }
}

/// What the autopilot asks of the rotors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Command {
    /// Thrust, N.
    pub thrust_n: f64,
    /// Rate of turn about the body's axes, rad/s.
    pub turn_rad_s: Vector3<f64>,
}

/// How a vehicle moves at an instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State {
    /// Where, in the world, m.
    pub position_m: Vector3<f64>,
    /// How fast, in the world, m/s.
    pub velocity_m_s: Vector3<f64>,
    /// The rotation world_from_body.
    pub attitude: UnitQuaternion<f64>,
    /// Rate of turn about the body's axes, rad/s.
    pub turn_rad_s: Vector3<f64>,
    /// Thrust along the body's z axis, N.
    pub thrust_n: f64,
}

impl State {
    /// Hovering at a place, with a heading (0 is along x, counted to the left).
    pub fn hover(build: &Build, position_m: Vector3<f64>, heading_rad: f64) -> Self {
        Self {
            position_m,
            velocity_m_s: Vector3::zeros(),
            attitude: UnitQuaternion::from_scaled_axis(Vector3::z() * heading_rad),
            turn_rad_s: Vector3::zeros(),
            thrust_n: build.mass_kg * GRAVITY_M_S2,
        }
    }

    /// The pose world_from_body.
    pub fn pose(&self) -> Isometry3<f64> {
        Isometry3::from_parts(Translation3::from(self.position_m), self.attitude)
    }

    /// The heading: where the body's x axis points along the ground, rad to the left of the world's x.
    pub fn heading_rad(&self) -> f64 {
        let ahead = self.attitude * Vector3::x();
        libm::atan2(ahead.y, ahead.x)
    }

    /// Acceleration in air that moves with `wind_m_s`, m/s^2.
    pub fn acceleration_m_s2(&self, build: &Build, wind_m_s: &Vector3<f64>) -> Vector3<f64> {
        acceleration(build, &self.attitude, self.thrust_n, &(self.velocity_m_s - wind_m_s))
    }

    /// What the renderer wants to know.
    pub fn kinematics(&self, build: &Build, wind_m_s: &Vector3<f64>) -> Kinematics {
        Kinematics {
            pose: self.pose(),
            velocity_m_s: self.velocity_m_s,
            acceleration_m_s2: self.acceleration_m_s2(build, wind_m_s),
            turn_rad_s: self.turn_rad_s,
        }
    }

    /// Moves on by `step_s`, by the midpoint rule: the error of a step grows with its third power. Thrust and rate follow their
    /// commands exactly as a lag of first order does.
    pub fn step(&mut self, build: &Build, command: &Command, wind_m_s: &Vector3<f64>, step_s: f64) {
        let after = |now: f64, wanted: f64, lag_s: f64, after_s: f64| {
            wanted + (now - wanted) * libm::exp(-after_s / lag_s)
        };
        let half_s = 0.5 * step_s;
        let thrust_n = command.thrust_n.clamp(0.0, build.thrust_n);
        let most = build.turn_rad_s;
        let turn = |axis: usize, after_s| {
            let wanted = command.turn_rad_s[axis].clamp(-most, most);
            after(self.turn_rad_s[axis], wanted, build.turn_lag_s, after_s)
        };
        let [turn_half, turn_end] = [half_s, step_s]
            .map(|after_s| Vector3::new(turn(0, after_s), turn(1, after_s), turn(2, after_s)));
        let start_m_s2 = self.acceleration_m_s2(build, wind_m_s);
        let velocity_half = self.velocity_m_s + start_m_s2 * half_s;
        let quarter = (self.turn_rad_s + turn_half) * (0.5 * half_s);
        let attitude_half = self.attitude * UnitQuaternion::from_scaled_axis(quarter);
        let thrust_half = after(self.thrust_n, thrust_n, build.thrust_lag_s, half_s);
        let half_m_s2 = acceleration(build, &attitude_half, thrust_half, &(velocity_half - wind_m_s));
        self.position_m += velocity_half * step_s;
        self.velocity_m_s += half_m_s2 * step_s;
        let mut attitude = self.attitude * UnitQuaternion::from_scaled_axis(turn_half * step_s);
        // products of unit quaternions lose their length bit by bit
        attitude.renormalize();
        self.attitude = attitude;
        self.turn_rad_s = turn_end;
        self.thrust_n = after(self.thrust_n, thrust_n, build.thrust_lag_s, step_s);
    }

    /// Whether every number of it is one.
    pub fn is_finite(&self) -> bool {
        let vectors = [self.position_m, self.velocity_m_s, self.turn_rad_s];
        let finite = vectors.iter().all(|vector| vector.iter().all(|value| value.is_finite()));
        finite && self.attitude.coords.iter().all(|value| value.is_finite()) && self.thrust_n.is_finite()
    }
}

/// Newton's law: thrust along the body's z axis, weight, and drag of the air.
fn acceleration(
    build: &Build,
    attitude: &UnitQuaternion<f64>,
    thrust_n: f64,
    through_air_m_s: &Vector3<f64>,
) -> Vector3<f64> {
    let drag_n_s_m = build.drag_n_s_m + build.drag_n_s2_m2 * through_air_m_s.norm();
    let force_n = attitude * (Vector3::z() * thrust_n) - through_air_m_s * drag_n_s_m;
    force_n / build.mass_kg - Vector3::z() * GRAVITY_M_S2
}
