//! A shape by relative positions that are noisy, and say how noisy.
//!
//! The aim is that of V. Walter et al., "Distributed UAV Formation Control Robust to Relative Pose Measurement Noise" (arXiv
//! 2304.03057): a command that overshoots only with a stated probability. Two things are done with the covariances. Each neighbour
//! says where the vehicle shall be; these are weighed by their information, so that the bearings of several neighbours, which are
//! good, decide what their distances, which are bad, leave open. What is left of the error is shortened by as many of its sigmas as
//! makes an overshoot that unlikely (the *restraint*): far away it matters little, near the goal noise moves nobody.

use nalgebra::{Matrix3, Vector3};

use super::{identified, in_level, limited};
use crate::{Controller, OwnState, Seen, Setpoint};

/// Where a neighbour shall be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WantedOffset {
    /// Whom.
    pub identity: u32,
    /// Where that one shall be, from the vehicle, m, in axes that all vehicles share (level where there is no heading).
    pub offset_m: Vector3<f64>,
}

/// What covariances do to the command.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Restraint {
    /// Nothing: the plain gradient, the mean of the errors times the gain.
    None,
    /// Weighed by information, and shortened by so many sigmas: 0.84 overshoots with a probability of 0.2 a step.
    Sigmas(f64),
}

/// One vehicle's part of a shape.
#[derive(Clone, Debug, PartialEq)]
pub struct PoseFormation {
    /// Whom it holds its place by.
    pub wanted: Vec<WantedOffset>,
    /// Where the formation goes, m/s, in the shared axes.
    pub cruise_m_s: Vector3<f64>,
    /// How fast an error is flown out, 1/s.
    pub gain_per_s: f64,
    /// What covariances do.
    pub restraint: Restraint,
    /// No faster, m/s.
    pub speed_m_s: f64,
}

impl PoseFormation {
    /// Restrained to overshoot in one step of five.
    pub fn new(wanted: Vec<WantedOffset>) -> Self {
        Self {
            wanted,
            cruise_m_s: Vector3::zeros(),
            gain_per_s: 0.8,
            restraint: Restraint::Sigmas(0.84),
            speed_m_s: 2.0,
        }
    }

    /// Where each neighbour puts the vehicle's error, m, with the covariance of it.
    fn errors(&self, own: &OwnState, seen: &[Seen]) -> impl Iterator<Item = (Vector3<f64>, Matrix3<f64>)> {
        self.wanted.iter().filter_map(|wanted| {
            let position = identified(seen, wanted.identity)?.position_m?;
            let shall = in_level(own, &wanted.offset_m);
            // What the heading is off by turns the wanted offset.
            let sigma_rad = own.heading.map_or(0.0, |heading| heading.sigma_rad);
            let across = Vector3::z().cross(&shall) * sigma_rad;
            Some((position.mean - shall, position.covariance + across * across.transpose()))
        })
    }

    fn plain(&self, own: &OwnState, seen: &[Seen]) -> Vector3<f64> {
        let (sum, count) =
            self.errors(own, seen).fold((Vector3::zeros(), 0.0), |(sum, n), (e, _)| (sum + e, n + 1.0));
        if count > 0.0 { sum / count } else { sum }
    }

    fn restrained(&self, own: &OwnState, seen: &[Seen], sigmas: f64) -> Vector3<f64> {
        let (mut information, mut weighed) = (Matrix3::zeros(), Vector3::zeros());
        for (error, covariance) in self.errors(own, seen) {
            let Some(inverse) = covariance.try_inverse() else { return self.plain(own, seen) };
            information += inverse;
            weighed += inverse * error;
        }
        let Some(covariance) = information.try_inverse() else { return Vector3::zeros() };
        let error = covariance * weighed;
        let size = error.norm();
        if size <= 0.0 {
            return error;
        }
        let along = error / size;
        let sigma = libm::sqrt(along.dot(&(covariance * along)).max(0.0));
        along * (size - sigmas * sigma).max(0.0)
    }
}

impl Controller for PoseFormation {
    fn command(&mut self, own: &OwnState, seen: &[Seen], _dt_s: f64) -> Setpoint {
        let error = match self.restraint {
            Restraint::None => self.plain(own, seen),
            Restraint::Sigmas(sigmas) => self.restrained(own, seen, sigmas),
        };
        let velocity = in_level(own, &self.cruise_m_s) + error * self.gain_per_s;
        Setpoint::velocity(limited(velocity, self.speed_m_s))
    }
}
