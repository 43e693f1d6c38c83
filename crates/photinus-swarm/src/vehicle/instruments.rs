//! What a vehicle measures of itself: attitude, rate of turn, velocity and height, each with noise and a bias.

use nalgebra::{UnitQuaternion, Vector3};

use super::State;
use crate::chance::{Chance, Use};

/// How good the instruments are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Accuracy {
    /// Error of roll and pitch that stays for a flight, sigma, rad.
    pub tilt_bias_rad: f64,
    /// Error of roll and pitch from reading to reading, sigma, rad.
    pub tilt_noise_rad: f64,
    /// Error of the heading that stays for a flight, sigma, rad.
    pub heading_bias_rad: f64,
    /// Error of the gyro that stays for a flight, per axis, sigma, rad/s.
    pub gyro_bias_rad_s: f64,
    /// Error of the gyro from reading to reading, per axis, sigma, rad/s.
    pub gyro_noise_rad_s: f64,
    /// Error of the velocity that stays for a flight, per axis, sigma, m/s.
    pub velocity_bias_m_s: f64,
    /// Error of the velocity from reading to reading, per axis, sigma, m/s.
    pub velocity_noise_m_s: f64,
    /// Error of the height from reading to reading, sigma, m.
    pub height_noise_m: f64,
}

impl Default for Accuracy {
    /// A flight controller of a few hundred euros with optical flow and a barometer.
    fn default() -> Self {
        Self {
            tilt_bias_rad: 0.01,
            tilt_noise_rad: 0.005,
            heading_bias_rad: 0.05,
            gyro_bias_rad_s: 0.005,
            gyro_noise_rad_s: 0.01,
            velocity_bias_m_s: 0.02,
            velocity_noise_m_s: 0.1,
            height_noise_m: 0.05,
        }
    }
}

/// What a vehicle knows of itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Own {
    /// When, s.
    pub time_s: f64,
    /// The rotation world_from_body, as far as it knows.
    pub attitude: UnitQuaternion<f64>,
    /// Rate of turn about the body's axes, rad/s.
    pub turn_rad_s: Vector3<f64>,
    /// Velocity in the level frame (x along the heading, z up), m/s.
    pub velocity_m_s: Vector3<f64>,
    /// Height above where the world has z = 0, m.
    pub height_m: f64,
}

impl Own {
    /// The rotation level_from_body: what is left of the attitude without its heading.
    pub fn level_from_body(&self) -> UnitQuaternion<f64> {
        let ahead = self.attitude * Vector3::x();
        let heading_rad = libm::atan2(ahead.y, ahead.x);
        UnitQuaternion::from_scaled_axis(Vector3::z() * -heading_rad) * self.attitude
    }
}

/// The instruments of one vehicle.
#[derive(Clone, Debug)]
pub struct Instruments {
    accuracy: Accuracy,
    chance: Chance,
    attitude_bias: UnitQuaternion<f64>,
    gyro_bias_rad_s: Vector3<f64>,
    velocity_bias_m_s: Vector3<f64>,
}

impl Instruments {
    /// The instruments of a vehicle of a run.
    pub fn new(accuracy: Accuracy, seed: u64, vehicle: u64) -> Self {
        let mut chance = Chance::new(seed, Use::Instruments, vehicle);
        let tilt = chance.normals() * accuracy.tilt_bias_rad;
        let heading_rad = chance.normal() * accuracy.heading_bias_rad;
        let gyro_bias_rad_s = chance.normals() * accuracy.gyro_bias_rad_s;
        let velocity_bias_m_s = chance.normals() * accuracy.velocity_bias_m_s;
        let attitude_bias = UnitQuaternion::from_scaled_axis(Vector3::new(tilt.x, tilt.y, heading_rad));
        Self { accuracy, chance, attitude_bias, gyro_bias_rad_s, velocity_bias_m_s }
    }

    /// How good they are.
    pub fn accuracy(&self) -> &Accuracy {
        &self.accuracy
    }

    /// Reads all of them.
    pub fn read(&mut self, state: &State, time_s: f64) -> Own {
        let Self { accuracy, chance, .. } = self;
        let tilt = chance.normals() * accuracy.tilt_noise_rad;
        let noise = UnitQuaternion::from_scaled_axis(Vector3::new(tilt.x, tilt.y, 0.0));
        let gyro = chance.normals() * accuracy.gyro_noise_rad_s;
        let velocity = chance.normals() * accuracy.velocity_noise_m_s;
        let height_m = chance.normal() * accuracy.height_noise_m;
        // flow is measured in the vehicle: in axes that turn with it, whatever it believes its heading to be
        let level_from_world = UnitQuaternion::from_scaled_axis(Vector3::z() * -state.heading_rad());
        Own {
            time_s,
            attitude: self.attitude_bias * noise * state.attitude,
            turn_rad_s: state.turn_rad_s + self.gyro_bias_rad_s + gyro,
            velocity_m_s: level_from_world * state.velocity_m_s + self.velocity_bias_m_s + velocity,
            height_m: state.position_m.z + height_m,
        }
    }
}
