//! How a vehicle shall fly.

use nalgebra::Vector3;

/// What the vehicle shall reach, in the level frame's axes, over ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Motion {
    /// A velocity, m/s.
    Velocity(Vector3<f64>),
    /// An acceleration, m/s^2, without gravity: zero keeps the velocity.
    Acceleration(Vector3<f64>),
}

/// A set-point: what flight controllers take over MAVLink or ROS 2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setpoint {
    /// How to move.
    pub motion: Motion,
    /// How fast to turn, rad/s, counter-clockwise seen from above.
    pub yaw_rate_rad_s: f64,
}

impl Setpoint {
    /// Come to rest and hold the heading.
    pub fn stand() -> Self {
        Self::velocity(Vector3::zeros())
    }

    /// Fly at `velocity_m_s`, in the level frame's axes, and hold the heading.
    pub fn velocity(velocity_m_s: Vector3<f64>) -> Self {
        Self { motion: Motion::Velocity(velocity_m_s), yaw_rate_rad_s: 0.0 }
    }

    /// Accelerate by `acceleration_m_s2`, in the level frame's axes, and hold the heading.
    pub fn acceleration(acceleration_m_s2: Vector3<f64>) -> Self {
        Self { motion: Motion::Acceleration(acceleration_m_s2), yaw_rate_rad_s: 0.0 }
    }

    /// The same motion while turning at `yaw_rate_rad_s`.
    pub fn turning(self, yaw_rate_rad_s: f64) -> Self {
        Self { yaw_rate_rad_s, ..self }
    }
}
