//! What the wind does to a robot that holds its place: the robot wanders slowly about it.

use core::f64::consts::TAU;

use nalgebra::Vector3;

use crate::sensor::hash;

/// A sum of slow sines along each axis, of random phase: smooth, so that accelerations, and with them tilts, exist.
#[derive(Clone, Debug, PartialEq)]
pub struct Wander {
    wind_m_s: f64,
    sines: Vec<Sine>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Sine {
    amplitude_m: Vector3<f64>,
    rate_rad_s: f64,
    phase_rad: Vector3<f64>,
}

impl Wander {
    /// Wandering per wind speed, rms along each axis, m per m/s: a multirotor on satellite navigation holds its place to
    /// about a decimetre in a breeze of 2 m/s.
    const PER_WIND_S: f64 = 0.05;
    const RATES_HZ: [f64; 5] = [0.07, 0.13, 0.23, 0.41, 0.73];

    /// No wind.
    pub fn still() -> Self {
        Self { wind_m_s: 0.0, sines: Vec::new() }
    }

    /// Wandering in a wind, for a seed.
    pub fn new(wind_m_s: f64, seed: u64) -> Self {
        let fall: f64 = Self::RATES_HZ.iter().map(|rate| 1.0 / (rate * rate)).sum();
        let sine = |(index, rate_hz): (usize, &f64)| {
            let phase = |axis: u64| {
                TAU * (hash(seed ^ (3 * index as u64 + axis)) >> 11) as f64 / (1_u64 << 53) as f64
            };
            // variance of a sine is half its amplitude squared; spectrum falls with the square of the rate
            let rms_m = Self::PER_WIND_S * wind_m_s * (1.0 / (rate_hz * rate_hz * fall)).sqrt();
            Sine {
                amplitude_m: Vector3::new(1.0, 1.0, 0.5) * (rms_m * core::f64::consts::SQRT_2),
                rate_rad_s: TAU * rate_hz,
                phase_rad: Vector3::new(phase(0), phase(1), phase(2)),
            }
        };
        if wind_m_s <= 0.0 {
            return Self::still();
        }
        Self { wind_m_s, sines: Self::RATES_HZ.iter().enumerate().map(sine).collect() }
    }

    /// The same wind for another seed.
    pub fn with_seed(&self, seed: u64) -> Self {
        Self::new(self.wind_m_s, seed)
    }

    /// How far from its place it is at a time, m.
    pub fn offset_m(&self, time_s: f64) -> Vector3<f64> {
        let at = |sine: &Sine| {
            sine.phase_rad
                .map(|phase| libm::sin(sine.rate_rad_s * time_s + phase))
                .component_mul(&sine.amplitude_m)
        };
        self.sines.iter().map(at).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wandering_has_its_rms_and_depends_on_the_seed() {
        let wander = Wander::new(4.0, 3);
        let count = 20_000;
        let squares: Vector3<f64> =
            (0..count).map(|i| wander.offset_m(f64::from(i) * 0.05)).map(|x| x.component_mul(&x)).sum();
        let rms_m = (squares / f64::from(count)).map(f64::sqrt);
        assert!((rms_m - Vector3::new(0.2, 0.2, 0.1)).norm() < 0.01, "{rms_m}");
        assert_ne!(wander, Wander::new(4.0, 4));
        assert_eq!(Wander::still().offset_m(3.0), Vector3::zeros());
    }
}
