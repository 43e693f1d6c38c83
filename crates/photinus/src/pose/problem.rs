//! What a pose costs, and how the cost changes: the negative logarithm of the posterior density of one assignment of spots
//! to markers, with the normal equations of its Gauss-Newton step.
//!
//! The step is dimensionless, [delta; omega]: position += distance * delta, camera_from_body *= exp(omega), so that delta is
//! along the camera's axes and omega along the body's: omega_z is yaw. In these coordinates the prior on position is flat,
//! which is the prior that prefers no direction and no scale: even over the sphere and over the logarithm of distance.
//!
//! Terms, each with unit variance when the pose is true:
//!
//! ```text
//! bearing   map (x / |x| - direction), x = R p + t                        two per spot, Huber beyond 3.5 sigma
//! light     ln f - ln I(camera in body) + 2 ln |x| - c                    one per spot, c (the LED's power) solved for
//! tilt      x and y of "up" in the body frame over the tilt's sigma       two, where gravity is known
//! elevation z of the direction to the camera in the body frame, weak      one, where it is not; and "up" is the image's, weak
//! size      (ln distance - mean) / sigma                                  one, where nothing else tells distance
//! ```

use nalgebra::{Matrix3, Matrix6, Rotation3, RowVector3, Unit, Vector3, Vector6};

use super::light::Light;
use super::observation::{Observation, Whitened};
use super::settings::Settings;
use crate::airframe::Airframe;

/// Beyond so many sigma the pull of a bearing no longer grows.
const HUBER: f64 = 3.5;
/// Without gravity: how far a camera is above or below a neighbour's own horizon, the sine's sigma.
const ELEVATION_SIGMA: f64 = 0.6;
/// Without gravity: how far a neighbour is from upright in the image, the sine's sigma. It keeps what nothing tells from
/// being anything.
const IMAGE_TILT_SIGMA: f64 = 1.0;
/// The place of the light of markers that melt into one spot is known to this share of how far it is from the first of them.
const MELTED_SHARE: f64 = 0.1;
/// How much farther than a pose markers are looked from to tell whether any melt near it.
const MELTING_ROOM: f64 = 1.5;
/// What it costs, nats, that a spot among an airframe's own is none of its markers: a spot that is one is likelier by its
/// sigma of a third of a milliradian against the few hundredths of a radian around the others, and strangers are rare.
const STRANGER_NATS: f64 = 14.0;
/// The same as a density over directions, for groups of different size.
pub(crate) const STRANGER_LOG_DENSITY: f64 = 2.0;

/// Where an airframe is and how it is turned, in the camera frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// The airframe's origin, m.
    pub position_m: Vector3<f64>,
    /// Its attitude: maps the body's coordinates to the camera's.
    pub camera_from_body: Rotation3<f64>,
}

impl Pose {
    /// The pose after a step [delta; omega].
    pub(super) fn stepped(&self, step: &Vector6<f64>) -> Self {
        let distance_m = self.position_m.norm();
        let [delta, omega] = [step.fixed_rows::<3>(0), step.fixed_rows::<3>(3)];
        Self {
            position_m: self.position_m + distance_m * delta,
            camera_from_body: self.camera_from_body * Rotation3::new(omega.into_owned()),
        }
    }

    /// Where the camera is in the body frame, m.
    pub fn camera_in_body_m(&self) -> Vector3<f64> {
        -(self.camera_from_body.inverse() * self.position_m)
    }
}

/// A normal distribution of the logarithm of distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LogDistance {
    /// Mean.
    pub mean: f64,
    /// Standard deviation.
    pub sigma: f64,
}

/// One assignment of spots to markers.
#[derive(Clone, Copy, Debug)]
pub(super) struct Problem<'a> {
    pub(super) airframe: &'a Airframe,
    pub(super) settings: &'a Settings,
    pub(super) observations: &'a [Observation],
    pub(super) whitened: &'a [Whitened],
    /// The marker of each spot; `None` for a spot that is not used.
    pub(super) markers: &'a [Option<u16>],
    /// Away from the ground, camera frame.
    pub(super) up: Option<Unit<Vector3<f64>>>,
    pub(super) size: Option<LogDistance>,
    /// Light below which a marker is not found; 0 where unknown.
    pub(super) faintest_light: f64,
    /// Whether markers may melt into one spot.
    pub(super) melting: bool,
}

/// The cost of a pose, nats, with gradient and Gauss-Newton information for a step [delta; omega].
#[derive(Clone, Copy, Debug)]
pub(super) struct Normal {
    pub(super) nats: f64,
    pub(super) gradient: Vector6<f64>,
    pub(super) information: Matrix6<f64>,
}

impl Normal {
    pub(super) fn zero() -> Self {
        Self { nats: 0.0, gradient: Vector6::zeros(), information: Matrix6::zeros() }
    }

    /// Adds a residual of unit variance with its row of derivatives.
    pub(super) fn add(&mut self, residual: f64, row: &Vector6<f64>) {
        self.nats += 0.5 * residual * residual;
        self.add_weighted(1.0, residual, row);
    }

    /// Adds a row to gradient and information with a weight, and nothing to the cost.
    pub(super) fn add_weighted(&mut self, weight: f64, residual: f64, row: &Vector6<f64>) {
        for column in 0..6 {
            let scaled = weight * row[column];
            self.gradient[column] += scaled * residual;
            for line in 0..=column {
                self.information[(line, column)] += scaled * row[line];
            }
        }
    }

    fn finish(&mut self) {
        self.information.fill_lower_triangle_with_upper_triangle();
    }
}

impl Problem<'_> {
    /// Cost and normal equations at a pose.
    pub(super) fn normal(&self, pose: &Pose) -> Normal {
        let mut normal = Normal::zero();
        normal.nats = STRANGER_NATS * self.markers.iter().filter(|marker| marker.is_none()).count() as f64;
        self.add_bearings(pose, &mut normal);
        if self.settings.use_brightness {
            Light::of(self, pose).add_to(&mut normal);
        }
        self.add_attitude(pose, &mut normal);
        if let Some(LogDistance { mean, sigma }) = self.size {
            let distance_m = pose.position_m.norm();
            let direction = pose.position_m / (distance_m * sigma);
            let row = Vector6::new(direction.x, direction.y, direction.z, 0.0, 0.0, 0.0);
            normal.add((libm::log(distance_m) - mean) / sigma, &row);
        }
        normal.finish();
        normal
    }

    /// The spots in use with the marker of each.
    pub(super) fn used(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        let marker = |(spot, marker): (usize, &Option<u16>)| marker.map(|marker| (spot, usize::from(marker)));
        self.markers.iter().enumerate().filter_map(marker)
    }

    /// Squared misfit of a spot's bearing, in units of its variance.
    pub(super) fn misfit(&self, pose: &Pose, spot: usize, marker: usize) -> f64 {
        let Whitened { direction, map, .. } = &self.whitened[spot];
        let (arm_m, factor) = self.seen_at_m(spot, marker, &pose.camera_in_body_m());
        let place_m = pose.camera_from_body * arm_m + pose.position_m;
        (map * (place_m.normalize() - direction) * factor).norm_squared()
    }

    /// Whether a marker without a spot may melt into one that has, anywhere near a pose.
    pub(super) fn may_melt(&self, pose: &Pose) -> bool {
        let camera_in_body_m = pose.camera_in_body_m() * MELTING_ROOM;
        let free = |marker: &usize| !self.markers.contains(&u16::try_from(*marker).ok());
        let melts = |(spot, seen)| {
            let mut others = (0..self.airframe.markers().len()).filter(free);
            others.any(|other| self.are_one(spot, seen, other, &camera_in_body_m))
        };
        self.used().any(melts)
    }

    /// Whether two markers are one spot for a camera at a place in the body frame.
    pub(super) fn are_one(&self, spot: usize, a: usize, b: usize, camera_in_body_m: &Vector3<f64>) -> bool {
        let [a_m, b_m] = [a, b].map(|marker| self.airframe.markers()[marker].position_m);
        let between_m = b_m - a_m;
        let range2_m2 = (camera_in_body_m - a_m).norm_squared();
        let along_m = between_m.dot(&(camera_in_body_m - a_m));
        let across2_m2 = between_m.norm_squared() - along_m * along_m / range2_m2;
        let limit_rad = self.observations[spot].resolution_rad;
        across2_m2 < limit_rad * limit_rad * range2_m2
    }

    /// Where the light of a spot comes from in the body frame, m: its marker, with those that melt into it and have no spot
    /// of their own; and how far that is known, as a factor on its residual.
    fn seen_at_m(&self, spot: usize, marker: usize, camera_in_body_m: &Vector3<f64>) -> (Vector3<f64>, f64) {
        let markers = self.airframe.markers();
        let alone_m = markers[marker].position_m;
        if !self.melting {
            return (alone_m, 1.0);
        }
        let mut at_m = alone_m;
        let mut light = None;
        for (other, beside) in markers.iter().enumerate() {
            if other == marker
                || !self.are_one(spot, marker, other, camera_in_body_m)
                || self.markers.contains(&u16::try_from(other).ok())
            {
                continue;
            }
            let more = self.airframe.intensity(other, camera_in_body_m);
            let light =
                light.get_or_insert_with(|| self.airframe.intensity(marker, camera_in_body_m).max(1e-3));
            *light += more;
            at_m += (beside.position_m - at_m) * (more / *light);
        }
        if light.is_none() {
            return (at_m, 1.0);
        }
        let off_rad = MELTED_SHARE * (at_m - alone_m).norm() / camera_in_body_m.norm();
        let sigma2_rad2 = self.observations[spot].variance_rad2();
        (at_m, (sigma2_rad2 / (sigma2_rad2 + off_rad * off_rad)).sqrt())
    }

    fn add_bearings(&self, pose: &Pose, normal: &mut Normal) {
        let distance_m = pose.position_m.norm();
        let camera_from_body = pose.camera_from_body.matrix();
        let camera_in_body_m = pose.camera_in_body_m();
        for (spot, marker) in self.used() {
            let (arm_m, factor) = self.seen_at_m(spot, marker, &camera_in_body_m);
            let place_m = camera_from_body * arm_m + pose.position_m;
            let range_m = place_m.norm();
            let seen = place_m / range_m;
            let Whitened { direction, map, .. } = &self.whitened[spot];
            if factor < 1.0 {
                normal.nats -= 2.0 * libm::log(factor);
            }
            let residual = map * (seen - direction) * factor;
            let by_place = (map - map * seen * seen.transpose()) * (factor / range_m);
            let by_turn = by_place * camera_from_body;
            let square = residual.norm_squared();
            let weight = if square > HUBER * HUBER {
                let off = square.sqrt();
                normal.nats += HUBER * (off - 0.5 * HUBER);
                HUBER / off
            } else {
                normal.nats += 0.5 * square;
                1.0
            };
            for axis in 0..2 {
                let across = by_place.row(axis) * distance_m;
                let turn: RowVector3<f64> = by_turn.row(axis).into_owned();
                // d(R exp(omega) p) = R (omega x p), so that the row by omega is p x (R' row').
                let turn = arm_m.cross(&turn.transpose());
                let row = Vector6::new(across[0], across[1], across[2], turn.x, turn.y, turn.z);
                normal.add_weighted(weight, residual[axis], &row);
            }
        }
    }

    fn add_attitude(&self, pose: &Pose, normal: &mut Normal) {
        let body_from_camera = pose.camera_from_body.matrix().transpose();
        let (up, sigma) = match &self.up {
            Some(up) => (body_from_camera * up.into_inner(), self.settings.tilt_sigma_rad),
            None => (-body_from_camera.column(1), IMAGE_TILT_SIGMA),
        };
        if self.up.is_some() && up.z <= 0.0 {
            // Upside down: as far from level as can be, whatever the horizontal part says.
            normal.nats += 0.5 / (sigma * sigma);
        }
        // d(exp(-omega) up) = up x omega.
        let by_turn = up.cross_matrix() / sigma;
        for axis in 0..2 {
            let row = by_turn.row(axis);
            normal.add(up[axis] / sigma, &Vector6::new(0.0, 0.0, 0.0, row[0], row[1], row[2]));
        }
        if self.up.is_none() {
            self.add_elevation(pose, &body_from_camera, normal);
        }
    }

    fn add_elevation(&self, pose: &Pose, body_from_camera: &Matrix3<f64>, normal: &mut Normal) {
        let away = body_from_camera * pose.position_m / pose.position_m.norm();
        let by_turn = away.cross_matrix().row(2) / ELEVATION_SIGMA;
        let by_step =
            (Matrix3::identity() - away * away.transpose()).row(2) * body_from_camera / ELEVATION_SIGMA;
        let row = Vector6::new(by_step[0], by_step[1], by_step[2], by_turn[0], by_turn[1], by_turn[2]);
        normal.add(away.z / ELEVATION_SIGMA, &row);
    }
}
