//! A group as the camera sees it: places in a plane, with the vertical where it is known.

use alloc::vec::Vec;

use nalgebra::{Matrix3, Rotation3, Unit, Vector2, Vector3};

#[cfg(not(feature = "std"))]
use crate::float::Float as _;
use crate::locator::context::Context;
use crate::locator::views::{Outline, firmness, view_axes};
use crate::pose::Pose;

/// Spots all in one place have no shape but what rounding leaves of them, which a target 10^15 m away would have.
const LEAST_SIZE: f64 = 1e-9;

/// The places of a group in the plane that touches the sphere of directions in their middle.
pub(super) struct Image<'a> {
    /// Axes of the plane in the camera frame: right, up (against gravity where it is known), ahead.
    pub(super) axes: Matrix3<f64>,
    /// Places from their middle, as many as spots.
    pub(super) places: &'a [Vector2<f64>],
    pub(super) middle: Vector2<f64>,
    /// Root of the summed squares of the places.
    pub(super) size: f64,
    /// Root mean square error of a place, per axis.
    pub(super) sigma: f64,
    /// Elevation of the camera seen from a level target, with gravity, rad.
    pub(super) elevation_rad: Option<f64>,
}

impl<'a> Image<'a> {
    pub(super) fn of(
        context: &Context<'_>,
        group: &[usize],
        places: &'a mut Vec<Vector2<f64>>,
    ) -> Option<Self> {
        let Context { sightings, gravity, .. } = *context;
        let members = || group.iter().map(|&index| &sightings[index]);
        let sum: Vector3<f64> = members().map(|sighting| sighting.bearing.vector()).sum();
        let ahead = Unit::try_new(sum, 1e-6)?;
        let up = match gravity {
            Some(down) => -down.into_inner(),
            None => -Vector3::y(),
        };
        let across = ahead.cross(&up);
        let right =
            Unit::try_new(across, 1e-9).unwrap_or_else(|| Unit::new_normalize(ahead.cross(&Vector3::x())));
        let up = right.cross(&ahead);
        places.clear();
        for sighting in members() {
            let bearing = sighting.bearing.vector();
            let depth = bearing.dot(&ahead);
            // Spots a right angle from their middle are no neighbour that a camera could be outside of.
            if depth < 1e-3 {
                return None;
            }
            places.push(Vector2::new(bearing.dot(&right), bearing.dot(&up)) / depth);
        }
        let count = group.len() as f64;
        let middle = places.iter().sum::<Vector2<f64>>() / count;
        for place in places.iter_mut() {
            *place -= middle;
        }
        let size = places.iter().map(Vector2::norm_squared).sum::<f64>().sqrt();
        // One spot that another disturbs must not make every shape a match: the geometric mean.
        let log_variance = members().map(|sighting| libm::log(sighting.covariance_rad2.trace() / 2.0));
        let variance = libm::exp(log_variance.sum::<f64>() / count);
        (size > LEAST_SIZE).then_some(Self {
            axes: Matrix3::from_columns(&[right.into_inner(), up, ahead.into_inner()]),
            places,
            middle,
            size,
            sigma: variance.sqrt(),
            elevation_rad: gravity.map(|down| libm::asin(ahead.dot(down).clamp(-1.0, 1.0))),
        })
    }

    /// The pose of an airframe at a place in the axes of the image, seen as from yaw and elevation, the image turned.
    pub(super) fn pose(
        &self,
        place_m: &Vector3<f64>,
        turn: Vector2<f64>,
        yaw_rad: f64,
        elevation_rad: f64,
    ) -> Pose {
        let [right, up, towards_camera] = view_axes(yaw_rad, elevation_rad);
        let rows = [right * turn.x - up * turn.y, right * turn.y + up * turn.x, -towards_camera];
        let image_from_body = Matrix3::from_rows(&rows.map(|row| row.transpose()));
        Pose {
            position_m: self.axes * place_m,
            camera_from_body: Rotation3::from_matrix_unchecked(self.axes * image_from_body),
        }
    }

    /// Cost of an elevation and of a turn (its cosine) against the vertical; none without gravity.
    pub(super) fn attitude_nats(&self, elevation_rad: f64, cos_turn: f64, tilt_sigma_rad: f64) -> f64 {
        self.elevation_rad.map_or(0.0, |expected_rad| {
            let off = elevation_rad - expected_rad;
            let turn = (1.0 - cos_turn) * firmness(elevation_rad);
            (0.5 * off * off + turn) / (tilt_sigma_rad * tilt_sigma_rad)
        })
    }

    /// The origin of an airframe that is seen as an outline `depth_m` away, in the axes of the image.
    pub(super) fn origin_m(&self, depth_m: f64, turn: Vector2<f64>, outline: &Outline) -> Vector3<f64> {
        let beside_m = self.middle * depth_m - turned(outline.middle_m, turn);
        Vector3::new(beside_m.x, beside_m.y, depth_m + outline.ahead_m)
    }
}

/// A place turned by a turn (cosine, sine).
pub(super) fn turned(place: Vector2<f64>, turn: Vector2<f64>) -> Vector2<f64> {
    Vector2::new(turn.x * place.x - turn.y * place.y, turn.y * place.x + turn.x * place.y)
}
