//! What a pose costs, and how the cost changes: the negative logarithm of the density of the spots and the attitude under one assignment of
//! spots to markers, with the normal equations of its Gauss-Newton step. Densities are per steradian for a direction and per unit of its logarithm
//! for light, all factors kept: costs of groups of different spots compare with each other, and with clutter.
//!
//! Terms, each with unit variance when the pose is true:
//!
//! ```text
//! bearing   map (x / |x| - direction), x = R p + t                        two per spot, Huber beyond 3.5 sigma
//! light     ln f - ln I(camera in body) + 2 ln |x| - c                    one per spot, c (the LED's power) solved for, with its prior
//! tilt      x and y of "up" in the body frame over the tilt's sigma       two, where gravity is known
//! elevation z of the direction to the camera in the body frame, weak      one, where it is not; and "up" is the image's, weak
//! size      (ln distance - mean) / sigma                                  one, where nothing else tells distance
//! ```

use core::f64::consts::TAU;

use nalgebra::{Matrix3, Vector3, Vector6};

use super::known::LogDistance;
use super::light::Light;
use super::merging::{LightCentre, Shining};
use super::observation::{Observation, Whitened};
use super::problem::{Normal, Pose, Problem};
#[cfg(not(feature = "std"))]
use crate::float::Float as _;

/// Logarithm of 2 pi.
const LOG_TAU: f64 = 1.837_877_066_409_345_5;
/// Beyond this many sigma the pull of a bearing no longer grows.
const HUBER: f64 = 3.5;
/// Without gravity: how far a camera is above or below a neighbour's own horizon, the sine's sigma.
const ELEVATION_SIGMA: f64 = 0.6;
/// Without gravity: how far a neighbour is from upright in the image, the sine's sigma. It keeps what nothing tells from
/// being anything.
const IMAGE_TILT_SIGMA: f64 = 1.0;
/// Logarithm of the mean over all directions of what [`ELEVATION_SIGMA`] leaves of them: sqrt(pi / 2) sigma erf(1 / (sqrt(2) sigma)).
const LOG_ELEVATION_SHARE: f64 = -0.384;

/// How far "up", in the body frame, is from the body's z along its x and y, in these sigmas, with the derivatives by a step.
fn tilted(up: &Vector3<f64>, sigma: f64) -> [(f64, Vector6<f64>); 2] {
    // d(exp(-omega) up) = up x omega.
    let by_turn = up.cross_matrix() / sigma;
    [0, 1].map(|axis| {
        let row = by_turn.row(axis);
        (up[axis] / sigma, Vector6::new(0.0, 0.0, 0.0, row[0], row[1], row[2]))
    })
}

impl Problem<'_> {
    /// Cost and normal equations at a pose.
    pub(super) fn normal(&self, pose: &Pose) -> Normal {
        let mut normal = self.normal_of_spots(pose);
        self.add_attitude(pose, &mut normal);
        if let Some(LogDistance { mean, sigma }) = self.known.size {
            let distance_m = pose.position_m.norm();
            let direction = pose.position_m / (distance_m * sigma);
            let row = Vector6::new(direction.x, direction.y, direction.z, 0.0, 0.0, 0.0);
            normal.add((libm::log(distance_m) - mean) / sigma, &row);
            normal.nats += 0.5 * libm::log(TAU * sigma * sigma);
        }
        normal.finish();
        normal
    }

    /// What the spots alone say: bearings, light, and clutter for those that are no marker. Only the upper triangle of the information.
    pub(super) fn normal_of_spots(&self, pose: &Pose) -> Normal {
        let mut normal = Normal::zero();
        let is_clutter = |(_, marker): &(&Observation, &Option<u16>)| marker.is_none();
        let clutter = self.observations.iter().zip(self.markers).filter(is_clutter);
        normal.nats = clutter.map(|(seen, _)| -seen.clutter_log_density).sum();
        let camera_in_body_m = pose.camera_in_body_m();
        let mut light = self.settings.use_brightness.then(|| Light::beforehand(self));
        let unseen = self.unseen(&camera_in_body_m);
        for (spot, marker) in self.used() {
            let shining = self.shining_among(&unseen, spot, marker, &camera_in_body_m);
            self.add_bearing(pose, &shining, &mut normal);
            if let Some(light) = &mut light {
                light.see(self, pose, &shining);
            }
        }
        if let Some(light) = light {
            light.add_to(&mut normal);
            normal.log_power = light.log_power();
        }
        normal
    }

    /// Squared misfit of a spot's bearing, in units of its variance.
    pub(super) fn misfit(&self, pose: &Pose, spot: usize, marker: usize) -> f64 {
        let Whitened { direction, map, .. } = &self.whitened[spot];
        let LightCentre { at_m, factor, .. } = self.shining(spot, marker, &pose.camera_in_body_m()).centre;
        let place_m = pose.camera_from_body * at_m + pose.position_m;
        (map * (place_m.normalize() - direction) * factor).norm_squared()
    }

    /// Adds the bearing of a spot.
    fn add_bearing(&self, pose: &Pose, shining: &Shining, normal: &mut Normal) {
        let Shining { spot, camera_m, centre: LightCentre { at_m, by_camera, factor }, .. } = *shining;
        let distance_m = pose.position_m.norm();
        let camera_from_body = pose.camera_from_body.matrix();
        let place_m = camera_from_body * at_m + pose.position_m;
        let range_m = place_m.norm();
        let seen = place_m / range_m;
        let Whitened { direction, map, log_sigmas, .. } = &self.whitened[spot];
        normal.nats += log_sigmas + LOG_TAU;
        if factor < 1.0 {
            // What is unsure of a merged centre is the same in all frames that err alike, and is told once.
            normal.nats -= 2.0 * libm::log(factor) / self.repeats;
        }
        let residual = map * (seen - direction) * factor;
        let by_place = (map - map * seen * seen.transpose()) * (factor / range_m);
        let by_turn = by_place * camera_from_body;
        // The map takes what is behind the camera for what is ahead.
        if seen.dot(direction) < 0.0 {
            normal.nats = f64::INFINITY;
        }
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
            let in_body = by_turn.row(axis).transpose();
            // The camera in the body frame moves by -R' distance delta, and by c x omega.
            let by_merging = by_camera.transpose() * in_body;
            let across = (by_place.row(axis).transpose() - camera_from_body * by_merging) * distance_m;
            // d(R exp(omega) p) = R (omega x p), so that the row by omega is p x (R' row').
            let turn = at_m.cross(&in_body) + by_merging.cross(&camera_m);
            let row = Vector6::new(across.x, across.y, across.z, turn.x, turn.y, turn.z);
            normal.add_weighted(weight, residual[axis], &row);
        }
    }

    /// Standard deviation of a tilt, rad.
    pub(super) fn tilt_sigma_rad(&self) -> f64 {
        self.known.tilt_sigma_rad.unwrap_or(self.settings.tilt_sigma_rad)
    }

    /// Its two residuals at a pose with their derivatives by a step; `None` where gravity is not known.
    pub(super) fn tilted(&self, pose: &Pose) -> Option<[(f64, Vector6<f64>); 2]> {
        let up = pose.camera_from_body.inverse() * self.known.up?.into_inner();
        Some(tilted(&up, self.tilt_sigma_rad()))
    }

    fn add_attitude(&self, pose: &Pose, normal: &mut Normal) {
        let body_from_camera = pose.camera_from_body.matrix().transpose();
        let (up, sigma) = match &self.known.up {
            Some(up) => (body_from_camera * up.into_inner(), self.tilt_sigma_rad()),
            None => (-body_from_camera.column(1), IMAGE_TILT_SIGMA),
        };
        if self.known.up.is_some() && up.z <= 0.0 {
            // Upside down: as far from level as can be, whatever the horizontal part says.
            normal.nats += 0.5 / (sigma * sigma);
        }
        normal.nats += libm::log(TAU * sigma * sigma);
        for (residual, row) in tilted(&up, sigma) {
            normal.add(residual, &row);
        }
        if self.known.up.is_none() {
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
        normal.nats += LOG_ELEVATION_SHARE;
    }
}
