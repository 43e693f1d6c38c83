//! A shape by bearings to a few neighbours with identities: no distances but one, which sets the size.
//!
//! The law is that of S. Zhao and D. Zelazo, "Bearing Rigidity and Almost Global Bearing-Only Formation Stabilization", TAC 2016,
//! eq. (14): each vehicle flies by `-sum P(g) g*`, with `g` the bearing that is seen, `g*` the one that is wanted and `P` the
//! projection across `g`. Directed sets of the least size suffice (A. Franchi et al., IJRR 2012; M. H. Trinh et al., "Bearing-Based
//! Formation Control of a Group of Agents with Leader-First Follower Structure", TAC 2019): one vehicle wants nothing, the second one
//! bearing and the distance to it, every further one two bearings that are not on one line, to vehicles before it.

use nalgebra::{UnitVector3, Vector3};

use super::{identified, in_level, limited};
use crate::{Controller, OwnState, Seen, Setpoint};

/// A bearing that is wanted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WantedBearing {
    /// To whom.
    pub identity: u32,
    /// Where that one shall be seen, in axes that all vehicles share (level where there is no heading).
    pub direction: UnitVector3<f64>,
    /// At what distance, m, where this bearing sets the size.
    pub distance_m: Option<f64>,
}

/// One vehicle's part of a shape.
#[derive(Clone, Debug, PartialEq)]
pub struct BearingFormation {
    /// The bearings that it keeps; none for the one that leads.
    pub wanted: Vec<WantedBearing>,
    /// Where the formation goes, m/s, in the shared axes.
    pub cruise_m_s: Vector3<f64>,
    /// Speed by one bearing that is off by a right angle, m/s.
    pub gain_m_s: f64,
    /// How fast an error of the distance is flown out, 1/s.
    pub distance_gain_per_s: f64,
    /// No faster, m/s.
    pub speed_m_s: f64,
}

impl BearingFormation {
    /// A part that stands where it is seen and sees as wanted.
    pub fn new(wanted: Vec<WantedBearing>) -> Self {
        Self { wanted, cruise_m_s: Vector3::zeros(), gain_m_s: 2.0, distance_gain_per_s: 0.8, speed_m_s: 2.0 }
    }
}

impl Controller for BearingFormation {
    fn command(&mut self, own: &OwnState, seen: &[Seen], _dt_s: f64) -> Setpoint {
        let mut velocity = in_level(own, &self.cruise_m_s);
        for wanted in &self.wanted {
            let Some(neighbour) = identified(seen, wanted.identity) else { continue };
            let is = neighbour.bearing.into_inner();
            let shall = in_level(own, &wanted.direction);
            velocity -= (shall - is * is.dot(&shall)) * self.gain_m_s;
            if let (Some(distance_m), Some(estimate)) = (wanted.distance_m, neighbour.distance.estimate) {
                velocity += is * (self.distance_gain_per_s * (estimate.distance_m - distance_m));
            }
        }
        Setpoint::velocity(limited(velocity, self.speed_m_s))
    }
}
