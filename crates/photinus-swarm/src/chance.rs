//! Random numbers: every vehicle and every use has a stream of its own, so that nothing depends on who draws first.

use nalgebra::Vector3;
use rand_distr::{Distribution, StandardNormal, StandardUniform};
use rand_pcg::Pcg64;

/// What numbers are drawn for.
#[derive(Clone, Copy, Debug)]
pub enum Use {
    /// Gusts.
    Wind = 1,
    /// Attitude, gyro and velocity as a vehicle measures them.
    Instruments = 2,
    /// What stands in for perception.
    Seeing = 3,
    /// How bright LEDs are.
    Leds = 4,
    /// Where vehicles are put.
    Places = 5,
    /// When a vehicle's cameras and codes begin.
    Clocks = 6,
}

/// A stream of random numbers.
#[derive(Clone, Debug)]
pub struct Chance(Pcg64);

impl Chance {
    /// The stream of a run, a use and an owner.
    pub fn new(seed: u64, what: Use, owner: u64) -> Self {
        let state = (u128::from(seed) << 64) | u128::from(owner);
        Self(Pcg64::new(state, what as u128))
    }

    /// A standard normal number.
    pub fn normal(&mut self) -> f64 {
        StandardNormal.sample(&mut self.0)
    }

    /// Three standard normal numbers.
    pub fn normals(&mut self) -> Vector3<f64> {
        let [x, y, z] = [self.normal(), self.normal(), self.normal()];
        Vector3::new(x, y, z)
    }

    /// A number from 0 to just below 1.
    pub fn uniform(&mut self) -> f64 {
        StandardUniform.sample(&mut self.0)
    }
}
