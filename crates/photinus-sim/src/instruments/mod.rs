//! What the vehicle with the cameras measures of itself: gyro, gravity, odometry, each with its errors.
//!
//! Every error is a function of the scene's seed and of the number of the measurement.

mod gravity;
mod gyro;
mod odometry;
#[cfg(test)]
mod tests;

use nalgebra::Vector3;

pub use gravity::Gravity;
pub use gyro::Gyro;
pub use odometry::Odometry;

use crate::draw::{self, Use};

/// The instruments of the observer; those that it lacks write nothing, and gravity is then told exactly.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Instruments {
    /// Its gyro.
    pub gyro: Option<Gyro>,
    /// How well it knows where down is.
    pub gravity: Option<Gravity>,
    /// Its odometry.
    pub odometry: Option<Odometry>,
}

/// Three standard normal numbers of measurement `number`; `kind` tells apart what is drawn for it.
fn normals(seed: u64, what: Use, kind: u64, number: u64) -> Vector3<f64> {
    Vector3::from_fn(|axis, _| draw::normal(draw::key(seed, what, &[kind, number, axis as u64])))
}
