//! A shape by relative positions that are noisy, and say how noisy.
//!
//! The aim is that of V. Walter et al., "Distributed UAV Formation Control Robust to Relative Pose Measurement Noise" (arXiv
//! 2304.03057): no command that noise alone calls for. Covariances restrain it three times. Where each neighbour is, is carried on by
//! the own motion and corrected by the gain of Kalman, small where a sight is bad. Each neighbour says where the vehicle shall be;
//! these are weighed by their information, so that the bearings of several neighbours, which are good, decide what their
//! distances, which are bad, leave open. What is left of the error is shortened by some of its sigmas, so that an overshoot has a
//! stated probability.

use nalgebra::{Matrix3, Rotation3, Vector3};

use super::{identified, in_level, limited};
use crate::{Controller, Normal, OwnState, Seen, Setpoint};

/// For how long a neighbour goes on as it does, s: how fast what is known of it grows old.
const STEADY_S: f64 = 1.0;

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
    /// Filtered, weighed, and shortened by this many sigmas: 0 by none, 0.84 where an overshoot shall have a probability of 0.2.
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
    /// How fast neighbours move at least, beside the formation, as far as the filter reckons, m/s; when the vehicle itself moves
    /// faster, they are taken to do so, too.
    pub drift_m_s: f64,
    /// No faster, m/s.
    pub speed_m_s: f64,
    /// Where those that are wanted are believed to be, in the level frame.
    believed: Vec<(u32, Normal)>,
    /// The velocity that was commanded last beside the formation's, m/s, in the level frame.
    correction_m_s: Vector3<f64>,
}

impl PoseFormation {
    /// Restrained so that an overshoot has a probability of 0.2.
    pub fn new(wanted: Vec<WantedOffset>) -> Self {
        Self {
            wanted,
            cruise_m_s: Vector3::zeros(),
            gain_per_s: 1.2,
            restraint: Restraint::Sigmas(0.84),
            drift_m_s: 0.03,
            speed_m_s: 2.0,
            believed: Vec::new(),
            correction_m_s: Vector3::zeros(),
        }
    }

    /// Carries on where neighbours are, and corrects it by what is seen.
    fn believe(&mut self, own: &OwnState, seen: &[Seen], dt_s: f64) {
        let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), -own.turn_rad_s() * dt_s).into_inner();
        let cruise = in_level(own, &self.cruise_m_s);
        // Neighbours are taken to fly as the formation does; what the vehicle does beside it moves them the other way.
        let moves = own.velocity_m_s.map_or(self.correction_m_s, |velocity| velocity.mean - cruise);
        let speed = moves.norm().max(self.drift_m_s);
        let growth = Matrix3::identity() * (speed * speed * STEADY_S * dt_s);
        for (_, normal) in &mut self.believed {
            normal.mean = turn * normal.mean - moves * dt_s;
            normal.covariance = turn * normal.covariance * turn.transpose() + growth;
        }
        for wanted in &self.wanted {
            let fresh = identified(seen, wanted.identity).filter(|s| s.age_s <= dt_s);
            let Some(position) = fresh.and_then(|s| s.position_m) else { continue };
            match self.believed.iter_mut().find(|(identity, _)| *identity == wanted.identity) {
                Some((_, normal)) => *normal = corrected(normal, &position),
                None => self.believed.push((wanted.identity, position)),
            }
        }
    }

    /// The error of each wanted offset, m, with its covariance.
    fn errors(&self, own: &OwnState) -> impl Iterator<Item = (Vector3<f64>, Matrix3<f64>)> {
        self.wanted.iter().filter_map(|wanted| {
            let (_, position) = self.believed.iter().find(|(identity, _)| *identity == wanted.identity)?;
            let shall = in_level(own, &wanted.offset_m);
            // What the heading is off by turns the wanted offset.
            let sigma_rad = own.heading.map_or(0.0, |heading| heading.sigma_rad);
            let across = Vector3::z().cross(&shall) * sigma_rad;
            Some((position.mean - shall, position.covariance + across * across.transpose()))
        })
    }

    fn restrained(&self, own: &OwnState, sigmas: f64) -> Vector3<f64> {
        // Neighbours are off their own places by about as much as the vehicle is: far from the shape all count alike.
        let (sum, count) =
            self.errors(own).fold((0.0, 0.0), |(sum, n), (e, _)| (sum + e.norm_squared(), n + 1.0));
        let own_places = Matrix3::identity() * if count > 0.0 { sum / count } else { 0.0 };
        let (mut information, mut weighed) = (Matrix3::zeros(), Vector3::zeros());
        let mut scatter = Matrix3::zeros();
        for (error, covariance) in self.errors(own) {
            let Some(weight) = (covariance + own_places).try_inverse() else { continue };
            information += weight;
            weighed += weight * error;
            scatter += weight * covariance * weight;
        }
        let Some(inverse) = information.try_inverse() else { return Vector3::zeros() };
        let error = inverse * weighed;
        let size = error.norm();
        if size <= 0.0 {
            return error;
        }
        // How much of it, along itself, is noise of the sights.
        let along = error / size;
        let sigma = libm::sqrt(along.dot(&(inverse * scatter * inverse * along)).max(0.0));
        along * (size - sigmas * sigma).max(0.0)
    }

    /// The mean of what is seen now less what is wanted.
    fn plain(&self, own: &OwnState, seen: &[Seen]) -> Vector3<f64> {
        let (mut sum, mut count) = (Vector3::zeros(), 0.0);
        for wanted in &self.wanted {
            let Some(position) = identified(seen, wanted.identity).and_then(|s| s.position_m) else {
                continue;
            };
            sum += position.mean - in_level(own, &wanted.offset_m);
            count += 1.0;
        }
        if count > 0.0 { sum / count } else { sum }
    }
}

/// Kalman's correction of a place by a sight of it.
fn corrected(believed: &Normal, sight: &Normal) -> Normal {
    let Some(inverse) = (believed.covariance + sight.covariance).try_inverse() else { return *sight };
    let gain = believed.covariance * inverse;
    let covariance = believed.covariance - gain * believed.covariance;
    Normal {
        mean: believed.mean + gain * (sight.mean - believed.mean),
        covariance: (covariance + covariance.transpose()) * 0.5,
    }
}

impl Controller for PoseFormation {
    fn command(&mut self, own: &OwnState, seen: &[Seen], dt_s: f64) -> Setpoint {
        let error = match self.restraint {
            Restraint::None => self.plain(own, seen),
            Restraint::Sigmas(sigmas) => {
                self.believe(own, seen, dt_s);
                self.restrained(own, sigmas)
            }
        };
        self.correction_m_s = error * self.gain_per_s;
        Setpoint::velocity(limited(in_level(own, &self.cruise_m_s) + self.correction_m_s, self.speed_m_s))
    }
}
