//! The same velocity as all others, when nobody knows where he is: nothing but relative velocities and places enters.
//!
//! After J. Horyna et al., "Swarming Without an Anchor", RA-L 2025: a group that holds itself by mutual sight damps every
//! disturbance but one, the drift of all together, which nobody can see. Each vehicle accelerates towards the mean velocity and the
//! remembered places of those it sees (the synchronization of double integrators), weighed by how well each is known.

use nalgebra::{Rotation3, Vector3};

use super::{likely, limited, place};
use crate::{Controller, OwnState, Seen, Setpoint};

/// Gains, and the constellation that is held.
#[derive(Clone, Debug, PartialEq)]
pub struct VelocityConsensus {
    /// How fast velocities are matched, 1/s.
    pub velocity_gain_per_s: f64,
    /// How hard remembered places are held, 1/s^2; zero lets the constellation go.
    pub place_gain_per_s2: f64,
    /// Sigma of a relative velocity that counts half, m/s.
    pub velocity_sigma_m_s: f64,
    /// No harder, m/s^2.
    pub acceleration_m_s2: f64,
    /// Where each track was when it was first seen, m, in the level frame of now.
    remembered: Vec<(u64, Vector3<f64>)>,
}

impl VelocityConsensus {
    /// Matches velocities within a second or so, and holds the constellation in which it begins.
    pub fn new() -> Self {
        Self {
            velocity_gain_per_s: 1.5,
            place_gain_per_s2: 0.5,
            velocity_sigma_m_s: 0.3,
            acceleration_m_s2: 4.0,
            remembered: Vec::new(),
        }
    }
}

impl Default for VelocityConsensus {
    fn default() -> Self {
        Self::new()
    }
}

impl Controller for VelocityConsensus {
    fn command(&mut self, own: &OwnState, seen: &[Seen], dt_s: f64) -> Setpoint {
        let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), -own.turn_rad_s() * dt_s);
        self.remembered.iter_mut().for_each(|(_, place)| *place = turn * *place);
        self.remembered.retain(|(track, _)| seen.iter().any(|s| s.track == *track));
        let (mut sum, mut weights) = (Vector3::zeros(), 0.0);
        for neighbour in likely(seen) {
            let (Some(at), Some(velocity)) = (place(neighbour), neighbour.velocity_m_s) else { continue };
            let wanted = match self.remembered.iter().find(|(track, _)| *track == neighbour.track) {
                Some((_, wanted)) => *wanted,
                None => {
                    self.remembered.push((neighbour.track, at));
                    at
                }
            };
            let half = self.velocity_sigma_m_s * self.velocity_sigma_m_s;
            let weight = half / (half + velocity.covariance.trace() / 3.0);
            sum +=
                (velocity.mean * self.velocity_gain_per_s + (at - wanted) * self.place_gain_per_s2) * weight;
            weights += weight;
        }
        let mean = if weights > 0.0 { sum / weights } else { sum };
        Setpoint::acceleration(limited(mean, self.acceleration_m_s2))
    }
}
