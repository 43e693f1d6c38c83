//! Odometry: motion added up, so that its errors add up, too.

use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use photinus_io::dataset::OdometryRow;

use super::normals;
use crate::draw::Use;
use crate::motion::Motion;

/// Odometry, visual-inertial say: tilt is observed, place and heading drift.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Odometry {
    /// Measurements per second.
    pub rate_hz: f64,
    /// How far its place wanders off in a second along each axis, sigma, m; it grows with the square root of time.
    pub place_walk_m: f64,
    /// How far its heading wanders off in a second, sigma, rad; likewise.
    pub heading_walk_rad: f64,
    /// Noise of its tilt about the body's x and y axes, sigma, rad.
    pub tilt_noise_rad: f64,
    /// Noise of its velocity along each axis, sigma, m/s.
    pub velocity_noise_m_s: f64,
}

const WALK: u64 = 0;
const HEADING: u64 = 1;
const TILT: u64 = 2;
const VELOCITY: u64 = 3;

impl Odometry {
    /// Half the time over which velocity is measured, s.
    const STEP_S: f64 = 1e-3;

    /// What it tells of a motion from time 0 to `until_s`. Its frame has z up, its origin where the body is at time 0 and its x
    /// axis where the body's nose points then.
    pub fn measure(&self, motion: &Motion, until_s: f64, seed: u64) -> impl Iterator<Item = OdometryRow> {
        let (odometry, motion, step_s) = (*self, motion.clone(), 1.0 / self.rate_hz);
        let start = motion.pose(0.0);
        let nose = start * Vector3::x();
        let mut heading_rad = -libm::atan2(nose.y, nose.x);
        let (mut place_m, mut before_m) = (Vector3::zeros(), start.translation.vector);
        (0..=(until_s * self.rate_hz).floor() as u64).map(move |number| {
            let time_s = number as f64 / odometry.rate_hz;
            let truth = motion.pose(time_s);
            let odometry_from_world = about_z(heading_rad);
            place_m += odometry_from_world * (truth.translation.vector - before_m);
            before_m = truth.translation.vector;
            let [ahead_m, behind_m] =
                [Self::STEP_S, -Self::STEP_S].map(|step_s| motion.pose(time_s + step_s).translation.vector);
            let velocity_m_s = odometry_from_world * (ahead_m - behind_m) / (2.0 * Self::STEP_S);
            let mut tilt = normals(seed, Use::Odometry, TILT, number) * odometry.tilt_noise_rad;
            tilt.z = 0.0;
            let row = OdometryRow {
                time_s,
                pose: Isometry3::from_parts(
                    Translation3::from(place_m),
                    odometry_from_world * truth.rotation * UnitQuaternion::from_scaled_axis(tilt),
                ),
                velocity_m_s: velocity_m_s
                    + normals(seed, Use::Odometry, VELOCITY, number) * odometry.velocity_noise_m_s,
                velocity_sigma_m_s: None,
            };
            let grown = step_s.sqrt();
            place_m += normals(seed, Use::Odometry, WALK, number) * (odometry.place_walk_m * grown);
            heading_rad +=
                normals(seed, Use::Odometry, HEADING, number).x * odometry.heading_walk_rad * grown;
            row
        })
    }
}

fn about_z(angle_rad: f64) -> UnitQuaternion<f64> {
    UnitQuaternion::from_scaled_axis(Vector3::z() * angle_rad)
}
