//! Ways to fly by what is seen, one a file, each with its source. None of them avoids collisions for certain: the safety layer
//! ([`crate::safety`]) stands behind every one.

mod bearing_formation;
mod boids;
mod consensus;
mod follower;
mod pose_formation;

pub use bearing_formation::{BearingFormation, WantedBearing};
pub use boids::{Boids, RangeTest};
pub use consensus::VelocityConsensus;
pub use follower::Follower;
pub use pose_formation::{PoseFormation, Restraint, WantedOffset};

use nalgebra::Vector3;

use crate::{Normal, OwnState, Seen};

/// Neighbours that are less likely than this are not flown by.
pub const LEAST_PROBABILITY: f64 = 0.5;

fn likely(seen: &[Seen]) -> impl Iterator<Item = &Seen> {
    seen.iter().filter(|s| s.probability >= LEAST_PROBABILITY)
}

/// Who blinks an identity and is likely there: whoever was seen last, where two tracks claim it.
fn identified(seen: &[Seen], identity: u32) -> Option<&Seen> {
    likely(seen).filter(|s| s.identity == Some(identity)).min_by(|a, b| a.age_s.total_cmp(&b.age_s))
}

/// The part of a vector that is no longer than `most`.
fn limited(vector: Vector3<f64>, most: f64) -> Vector3<f64> {
    let norm = vector.norm();
    if norm > most { vector * (most / norm) } else { vector }
}

/// A vector of axes that all vehicles share in the level frame: turned by the vehicle's heading, unturned where it knows none.
fn in_level(own: &OwnState, shared: &Vector3<f64>) -> Vector3<f64> {
    let (sine, cosine) = libm::sincos(-own.heading.map_or(0.0, |heading| heading.angle_rad));
    Vector3::new(cosine * shared.x - sine * shared.y, sine * shared.x + cosine * shared.y, shared.z)
}

/// Where a neighbour is, or the bearing at the estimated distance, without covariance; `None` where nothing tells how far.
fn place(seen: &Seen) -> Option<Vector3<f64>> {
    let along = || seen.distance.estimate.map(|e| seen.bearing.into_inner() * e.distance_m);
    seen.position_m.map(|position: Normal| position.mean).or_else(along)
}
