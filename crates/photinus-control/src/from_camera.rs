//! What a camera located -> what a controller sees: turned into the level frame, and seen from the vehicle's own origin.

use nalgebra::{Rotation3, UnitVector3, Vector3};
use photinus::locator::{Distance, Neighbour, Sighting};
use photinus::ranging::Interval;
use photinus::tracking::Track;

use crate::{Normal, Seen};

/// How a camera is held at the time of its frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Held {
    /// Maps the camera's coordinates to the level frame's: the vehicle's tilt after the camera's mounting.
    pub level_from_camera: Rotation3<f64>,
    /// The camera's centre, from the vehicle's origin, in the level frame, m.
    pub camera_m: Vector3<f64>,
}

impl Held {
    /// A neighbour of a frame that was just taken, as the vehicle sees it. `sightings` are those that belong to it, `radius_m` is
    /// the distance of its furthest marker from its origin, `track` what it was followed as, if it was, and `number` the one to
    /// give it where it was not.
    ///
    /// The bearing's bound is strict: the origin is within `radius_m` of every marker, whose direction is strictly bounded, and no
    /// nearer than the near bound of the distance.
    pub fn seen<'a>(
        &self,
        neighbour: &Neighbour,
        sightings: impl Iterator<Item = &'a Sighting>,
        radius_m: f64,
        number: u64,
        track: Option<&Track>,
        identity: Option<u32>,
    ) -> Seen {
        let near_m = neighbour.distance.bounds.min_m();
        let mut spot_px = None;
        let around_rad = within_rad(radius_m, near_m) + within_rad(self.camera_m.norm(), near_m);
        let bound_rad = sightings
            .inspect(|sighting| spot_px = spot_px.max(Some(sighting.spot.area_px)))
            .map(|sighting| neighbour.bearing.angle_to(&sighting.bearing) + sighting.bound_rad + around_rad)
            .fold(core::f64::consts::PI, f64::min);
        let turn = self.level_from_camera.into_inner();
        let turned = |mean: Vector3<f64>, covariance| Normal {
            mean: turn * mean,
            covariance: turn * covariance * turn.transpose(),
        };
        let position = match (track, neighbour.position) {
            (Some(track), _) => Some(turned(track.position_m, track.position_covariance_m2)),
            (None, position) => position.map(|position| turned(position.mean_m, position.covariance_m2)),
        };
        Seen {
            track: track.map_or(number, |track| track.id),
            identity,
            bearing: UnitVector3::new_unchecked(turn * neighbour.bearing.vector()),
            bearing_bound_rad: bound_rad,
            distance: self.seen_from_origin(&neighbour.distance),
            position_m: position.map(|position| Normal { mean: position.mean + self.camera_m, ..position }),
            velocity_m_s: track.map(|track| turned(track.velocity_m_s, track.velocity_covariance_m2_s2)),
            heading: None,
            probability: track.map_or(neighbour.probability, |track| track.existence),
            spot_px: spot_px.map(f64::from),
            age_s: 0.0,
        }
    }

    /// Distances from the vehicle's origin instead of the camera's centre: bounds grow by how far these are apart.
    fn seen_from_origin(&self, distance: &Distance) -> Distance {
        let lever_m = self.camera_m.norm();
        let bounds = distance.bounds;
        let grown = Interval::new((bounds.min_m() - lever_m).max(0.0), bounds.max_m() + lever_m);
        Distance { bounds: grown.unwrap_or(bounds), ..*distance }
    }
}

/// The largest angle at which something within `radius_m` of a point appears from it, at `distance_m` or more from the point, rad.
fn within_rad(radius_m: f64, distance_m: f64) -> f64 {
    if radius_m < distance_m { libm::asin(radius_m / distance_m) } else { core::f64::consts::PI }
}
