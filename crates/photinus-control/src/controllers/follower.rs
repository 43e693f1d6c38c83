//! Follows one leader by sight: turns towards it and keeps a distance, from whatever side it happens to be on.
//!
//! After V. Walter, N. Staub, A. Franchi and M. Saska, "UVDAR System for Visual Relative Localization with application to
//! Leader-Follower Formations of Multirotor UAVs", RA-L 2019: the follower controls what it sees well. The distance is held along
//! the line of sight with the leader's velocity as feed-forward; across it only a share is taken over, so that a leader who flies
//! tight turns is followed on a shorter path, and the camera is turned by the rate of the line of sight before an error builds up.

use nalgebra::Vector3;

use super::{identified, likely, limited, place};
use crate::{Controller, OwnState, Seen, Setpoint};

/// How to follow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Follower {
    /// Whom; where `None`, whoever was nearest when nobody was followed.
    pub leader: Option<u32>,
    /// How far away, m.
    pub distance_m: f64,
    /// How far above the leader, m.
    pub above_m: f64,
    /// How fast an error of the distance is flown out, 1/s.
    pub gain_per_s: f64,
    /// How fast a velocity along the line of sight is matched, 1/s.
    pub along_per_s: f64,
    /// How fast a velocity across it is matched, 1/s.
    pub across_per_s: f64,
    /// How fast an error of the heading is turned out, 1/s.
    pub turn_per_s: f64,
    /// No faster, m/s.
    pub speed_m_s: f64,
    /// No harder, m/s^2.
    pub acceleration_m_s2: f64,
    /// A leader that was not seen for that long is waited for, s; until then it is taken to go on.
    pub patience_s: f64,
    /// Azimuth at which it was seen last, rad.
    last_azimuth_rad: f64,
    /// The track that is followed.
    track: Option<u64>,
}

impl Follower {
    /// Keeps `distance_m` from a leader that flies at up to 5 m/s.
    pub fn new(leader: Option<u32>, distance_m: f64) -> Self {
        Self {
            leader,
            distance_m,
            above_m: 0.0,
            gain_per_s: 1.0,
            along_per_s: 2.5,
            across_per_s: 0.8,
            turn_per_s: 4.0,
            speed_m_s: 6.0,
            acceleration_m_s2: 8.0,
            patience_s: 1.0,
            last_azimuth_rad: 0.0,
            track: None,
        }
    }

    fn leader<'a>(&self, seen: &'a [Seen]) -> Option<&'a Seen> {
        match self.leader {
            Some(identity) => identified(seen, identity),
            // whoever appears in between is no leader
            None => likely(seen).find(|seen| Some(seen.track) == self.track).or_else(|| {
                likely(seen).min_by(|a, b| a.distance.bounds.min_m().total_cmp(&b.distance.bounds.min_m()))
            }),
        }
    }
}

impl Controller for Follower {
    fn command(&mut self, own: &OwnState, seen: &[Seen], dt_s: f64) -> Setpoint {
        let leader = self.leader(seen).filter(|leader| leader.age_s <= self.patience_s);
        let Some((leader, at)) = leader.and_then(|leader| Some((leader, place(leader)?))) else {
            // Where it was, as far as the vehicle has turned since.
            self.last_azimuth_rad = wrapped(self.last_azimuth_rad - own.turn_rad_s() * dt_s);
            return Setpoint::stand().turning(self.turn_per_s * self.last_azimuth_rad);
        };
        self.track = Some(leader.track);
        let level = Vector3::new(at.x, at.y, 0.0);
        let range = level.norm().max(1e-3);
        let towards = level / range;
        let moves = leader.velocity_m_s.map_or_else(Vector3::zeros, |velocity| velocity.mean);
        let along = towards * moves.dot(&towards);
        let across = Vector3::new(moves.x, moves.y, 0.0) - along;
        let height = at.z + self.above_m;

        let wanted = towards * (self.gain_per_s * (range - self.distance_m));
        let mut acceleration = (wanted + along) * self.along_per_s + across * self.across_per_s;
        acceleration.z = self.along_per_s * (self.gain_per_s * height + moves.z);
        if let Some(own) = own.velocity_m_s {
            // Above its speed it only slows down.
            let over = own.mean - limited(own.mean, self.speed_m_s);
            acceleration -= over * self.along_per_s;
        }
        self.last_azimuth_rad = libm::atan2(at.y, at.x);
        let sight_rad_s = (at.x * moves.y - at.y * moves.x) / (range * range);
        Setpoint::acceleration(limited(acceleration, self.acceleration_m_s2))
            .turning(self.turn_per_s * self.last_azimuth_rad + sight_rad_s)
    }
}

/// An angle from -pi to pi.
fn wrapped(angle_rad: f64) -> f64 {
    let (sine, cosine) = libm::sincos(angle_rad);
    libm::atan2(sine, cosine)
}

#[cfg(test)]
mod tests {
    use nalgebra::{Matrix3, UnitVector3};
    use photinus::locator::Distance;
    use photinus::ranging::Interval;

    use super::*;
    use crate::Normal;

    fn seen(track: u64, x: f64, y: f64) -> Seen {
        let mean = Vector3::new(x, y, 0.0);
        let bounds = Interval::new(0.5 * mean.norm(), 2.0 * mean.norm()).unwrap();
        Seen {
            track,
            identity: None,
            bearing: UnitVector3::new_normalize(mean),
            bearing_bound_rad: 0.1,
            distance: Distance { estimate: None, bounds, perpendicular_m: None, inline_m: None },
            position_m: Some(Normal { mean, covariance: Matrix3::identity() * 0.01 }),
            velocity_m_s: None,
            heading: None,
            probability: 0.9,
            spot_px: None,
            age_s: 0.0,
        }
    }

    fn wants_to_turn(follower: &mut Follower, seen: &[Seen]) -> f64 {
        let own = OwnState::resting();
        follower.command(&own, seen, 0.05).yaw_rate_rad_s
    }

    #[test]
    fn who_appears_nearer_is_not_the_leader() {
        let mut follower = Follower::new(None, 6.0);
        let (leader, another) = (seen(1, 6.0, 1.0), seen(2, 2.0, -2.0));
        assert!(wants_to_turn(&mut follower, &[leader]) > 0.0);
        assert!(wants_to_turn(&mut follower, &[another, leader]) > 0.0);
        // alone, the nearest is followed
        assert!(wants_to_turn(&mut follower, &[another]) < 0.0);
        assert!(wants_to_turn(&mut follower, &[leader, another]) < 0.0);
    }
}
