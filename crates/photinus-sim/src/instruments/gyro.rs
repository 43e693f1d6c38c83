//! A gyro: how fast the body turns, with noise and a bias that wanders.

use nalgebra::Vector3;
use photinus_io::dataset::ImuRow;

use super::normals;
use crate::draw::Use;
use crate::motion::Motion;

/// A gyro.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gyro {
    /// Measurements per second.
    pub rate_hz: f64,
    /// Noise of a measurement along each axis, sigma, rad/s.
    pub noise_rad_s: f64,
    /// Bias along each axis when it is switched on, sigma, rad/s.
    pub bias_rad_s: f64,
    /// How far the bias wanders in a second along each axis, sigma, rad/s; it grows with the square root of time.
    pub bias_walk_rad_s: f64,
}

const ON: u64 = 0;
const WALK: u64 = 1;
const NOISE: u64 = 2;

impl Gyro {
    /// What it measures of a motion from time 0 to `until_s`, in the body frame. A measurement is the mean rate over the time
    /// between two, as a gyro integrates; its time is the middle of that.
    pub fn measure(&self, motion: &Motion, until_s: f64, seed: u64) -> impl Iterator<Item = ImuRow> {
        let (gyro, step_s) = (*self, 1.0 / self.rate_hz);
        let mut bias = normals(seed, Use::Gyro, ON, 0) * self.bias_rad_s;
        let mut before = motion.pose(-0.5 * step_s).rotation;
        (0..=(until_s * self.rate_hz).floor() as u64).map(move |number| {
            let time_s = number as f64 / gyro.rate_hz;
            let after = motion.pose(time_s + 0.5 * step_s).rotation;
            let turn: Vector3<f64> = before.rotation_to(&after).scaled_axis();
            // the turn from `before` to `after` is given in the world; a body measures it about its own axes
            let turn_rad_s = before.inverse() * turn / step_s;
            before = after;
            let noise = normals(seed, Use::Gyro, NOISE, number) * gyro.noise_rad_s;
            let measured = turn_rad_s + bias + noise;
            bias += normals(seed, Use::Gyro, WALK, number) * (gyro.bias_walk_rad_s * step_s.sqrt());
            ImuRow { time_s, turn_rad_s: measured }
        })
    }
}
