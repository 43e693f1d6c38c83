//! How the vehicle moves, by what others measure while frames come in: enter rates, attitudes and velocities as they arrive, from any thread; leaves how a camera
//! turned between two times, how fast it moves, and where down is.
//!
//! Times are on the clock of the frames' `time_s`. Only the last seconds are kept.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use nalgebra::{UnitQuaternion, Vector3};

/// What is kept, s.
const KEPT_S: f64 = 5.0;
/// What is kept of a source that sends without measure.
const MOST: usize = 10_000;

/// A velocity over the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Velocity {
    /// m/s, in whatever axes it is told in.
    pub velocity_m_s: Vector3<f64>,
    /// Standard deviation of its error, per axis, m/s.
    pub sigma_m_s: f64,
}

impl Velocity {
    /// Standard deviation of one of which nobody says it, m/s per axis: a good odometry's.
    const UNTOLD_SIGMA_M_S: f64 = 0.05;

    /// A velocity with its standard deviation per axis, where that is told: what is no positive number is not.
    #[must_use]
    pub fn new(velocity_m_s: Vector3<f64>, sigma_m_s: Option<f64>) -> Self {
        let told = sigma_m_s.filter(|sigma_m_s| *sigma_m_s > 0.0 && sigma_m_s.is_finite());
        Self { velocity_m_s, sigma_m_s: told.unwrap_or(Self::UNTOLD_SIGMA_M_S) }
    }

    /// A velocity with the variances along its axes, m^2/s^2: zeros, as of a message that nobody filled in, say nothing.
    #[must_use]
    pub fn with_variances(velocity_m_s: Vector3<f64>, variances_m2_s2: Vector3<f64>) -> Self {
        Self::new(velocity_m_s, Some(variances_m2_s2.mean().sqrt()))
    }

    /// The same in other axes.
    #[must_use]
    pub fn turned(&self, turn: &UnitQuaternion<f64>) -> Self {
        Self { velocity_m_s: turn * self.velocity_m_s, ..*self }
    }

    /// Between two, this share of the way.
    pub(crate) fn lerp(&self, to: &Self, share: f64) -> Self {
        Self {
            velocity_m_s: self.velocity_m_s.lerp(&to.velocity_m_s, share),
            sigma_m_s: self.sigma_m_s + share * (to.sigma_m_s - self.sigma_m_s),
        }
    }
}

/// What the vehicle says of its motion. A clone is the same motion.
#[derive(Clone, Debug, Default)]
pub struct Motion(Arc<Mutex<Known>>);

#[derive(Debug, Default)]
struct Known {
    rates: VecDeque<(f64, Vector3<f64>)>,
    attitudes: VecDeque<(f64, UnitQuaternion<f64>)>,
    velocities: VecDeque<(f64, Velocity)>,
}

impl Motion {
    /// A gyro: rad/s against the world in the body frame. What is not later than the last one is left out.
    pub fn rate(&self, time_s: f64, turn_rad_s: Vector3<f64>) {
        if turn_rad_s.iter().all(|rate| rate.is_finite()) {
            put(&mut self.known().rates, time_s, turn_rad_s);
        }
    }

    /// An attitude world_from_body, world with z up. What is not later than the last one is left out.
    pub fn attitude(&self, time_s: f64, world_from_body: UnitQuaternion<f64>) {
        if world_from_body.coords.iter().all(|part| part.is_finite()) {
            put(&mut self.known().attitudes, time_s, world_from_body);
        }
    }

    /// A velocity over the ground in the body frame. What is not later than the last one is left out.
    pub fn velocity(&self, time_s: f64, velocity: Velocity) {
        if velocity.velocity_m_s.iter().all(|part| part.is_finite()) {
            put(&mut self.known().velocities, time_s, velocity);
        }
    }

    /// The rates that are known, in the order of time.
    pub fn rates(&self) -> Vec<(f64, Vector3<f64>)> {
        self.known().rates.iter().copied().collect()
    }

    /// The attitudes that are known, in the order of time.
    pub fn attitudes(&self) -> Vec<(f64, UnitQuaternion<f64>)> {
        self.known().attitudes.iter().copied().collect()
    }

    /// The velocities that are known, in the order of time.
    pub fn velocities(&self) -> Vec<(f64, Velocity)> {
        self.known().velocities.iter().copied().collect()
    }

    fn known(&self) -> MutexGuard<'_, Known> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

fn put<T>(known: &mut VecDeque<(f64, T)>, time_s: f64, value: T) {
    let is_later = known.back().is_none_or(|last| last.0 < time_s);
    if !time_s.is_finite() || !is_later {
        return;
    }
    known.push_back((time_s, value));
    while known.len() > MOST || known.front().is_some_and(|first| first.0 < time_s - KEPT_S) {
        known.pop_front();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_seconds_are_kept_in_order_and_nonsense_is_not() {
        let motion = Motion::default();
        for step in 0..20_000_u32 {
            motion.rate(f64::from(step) * 1e-3, Vector3::x());
        }
        motion.rate(3.0, Vector3::y());
        motion.rate(f64::NAN, Vector3::y());
        motion.rate(30.0, Vector3::repeat(f64::NAN));
        let rates = motion.rates();
        assert!(rates.is_sorted_by(|a, b| a.0 < b.0));
        assert_eq!((rates.len(), rates.last()), (5001, Some(&(19.999, Vector3::x()))));
        let other = motion.clone();
        (0..20_000_u32).for_each(|step| other.attitude(f64::from(step) * 1e-6, UnitQuaternion::identity()));
        assert_eq!(motion.attitudes().len(), MOST);
    }
}
