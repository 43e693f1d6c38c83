//! A state -> the same a while later: velocity carries on, yaw turns on, tilts fade, and the camera turned and became faster or slower.
//!
//! Acceleration is white; the yaw rate is an Ornstein-Uhlenbeck process about none, a tilt one about the vertical, whose sigma is
//! the prior of the pose. Where gravity is not known the tilt changes as fast, about the image's up, and is hardly pulled to it.
//! Y. Bar-Shalom, X. R. Li, T. Kirubarajan, "Estimation with Applications to Tracking and Navigation" (2001), 6.2.1.

use nalgebra::{Matrix3, Rotation3, SMatrix, Unit, Vector3};

use super::component::{Component, Covariance, SIZE, YAW, YAW_RATE};
use super::settings::Settings;
#[cfg(not(feature = "std"))]
use crate::float::Float as _;
use crate::pose::Pose;

/// Without gravity: how far a vehicle is from upright in the image, rad.
const IMAGE_TILT_SIGMA_RAD: f64 = 1.0;
/// A yaw is no less sure than this, rad: that of one who knows nothing.
const MOST_YAW_RAD: f64 = 1.8;

/// How the axes turned over an interval, from those of the camera before to those of the one now.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Turn {
    pub(super) now_from_before: Rotation3<f64>,
    /// Standard deviation per axis, rad.
    pub(super) sigma_rad: f64,
    /// From the body's origin, about which they turn, to the camera before and to the one now, each in its own axes, m.
    pub(super) before_m: Vector3<f64>,
    pub(super) now_m: Vector3<f64>,
}

impl Turn {
    /// A camera that stays as it is, mounted so.
    pub(super) fn none(lever_m: Vector3<f64>) -> Self {
        Self { now_from_before: Rotation3::identity(), sigma_rad: 0.0, before_m: lever_m, now_m: lever_m }
    }
}

/// How the velocity of what carries the camera changed over an interval, evenly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Faster {
    /// In the axes afterwards, m/s.
    pub(super) by_m_s: Vector3<f64>,
    /// Standard deviation per axis, m/s.
    pub(super) sigma_m_s: f64,
}

/// What moves a vehicle over an interval.
#[derive(Clone, Copy, Debug)]
pub(super) struct Motion {
    pub(super) interval_s: f64,
    pub(super) turn: Turn,
    /// Where it is known.
    pub(super) faster: Option<Faster>,
    /// Away from the ground, in the camera's axes afterwards.
    pub(super) up: Option<Unit<Vector3<f64>>>,
    pub(super) tilt_sigma_rad: f64,
}

/// What becomes of a yaw and its rate over an interval.
struct Turning {
    /// How much yaw follows from the rate before, s.
    by_rate: f64,
    /// The share of the rate that is left.
    keeps: f64,
    /// What is new: the variances of both, and their covariance.
    yaw_rad2: f64,
    yaw_with_rate: f64,
    rate_rad2_s2: f64,
}

impl Turning {
    fn over(interval_s: f64, settings: &Settings) -> Self {
        let time_s = settings.yaw_rate_time_s;
        let variance = settings.yaw_rate_sigma_rad_s * settings.yaw_rate_sigma_rad_s;
        let gone = -libm::expm1(-interval_s / time_s);
        Self {
            by_rate: time_s * gone,
            keeps: 1.0 - gone,
            // of 2 (x - gone) - gone^2 the first orders cancel
            yaw_rad2: variance
                * time_s
                * time_s
                * (2.0 * (interval_s / time_s - gone) - gone * gone).max(0.0),
            yaw_with_rate: variance * time_s * gone * gone,
            rate_rad2_s2: variance * gone * (2.0 - gone),
        }
    }
}

impl Motion {
    /// Where a vehicle is afterwards.
    pub(super) fn predict(&self, before: &Component, settings: &Settings) -> Component {
        let interval_s = self.interval_s;
        let turn = &self.turn.now_from_before;
        let faster = self.faster.unwrap_or(Faster { by_m_s: Vector3::zeros(), sigma_m_s: 0.0 });
        let from_origin_m = before.pose.position_m + self.turn.before_m;
        let carried_m = turn * (from_origin_m + before.velocity_m_s * interval_s);
        let from_origin_m = carried_m - faster.by_m_s * (0.5 * interval_s);
        let position_m = from_origin_m - self.turn.now_m;
        let velocity_m_s = turn * before.velocity_m_s - faster.by_m_s;
        let turning = Turning::over(interval_s, settings);
        let turned = Rotation3::from_axis_angle(&Vector3::z_axis(), turning.by_rate * before.yaw_rate_rad_s);
        let camera_from_body = turn * before.pose.camera_from_body * turned;
        let (keeps, tilt_rad2) = self.tilt(settings);
        let upright = self.upright(&camera_from_body);
        let mut transition = Covariance::identity();
        let matrix = turn.matrix();
        transition.fixed_view_mut::<3, 3>(0, 0).copy_from(matrix);
        transition.fixed_view_mut::<3, 3>(0, 3).copy_from(&(matrix * interval_s));
        transition.fixed_view_mut::<3, 3>(3, 3).copy_from(matrix);
        // Errors of the attitude are along the axes of the body, which turn.
        transition.fixed_view_mut::<3, 3>(6, 6).copy_from(turned.inverse().matrix());
        transition.fixed_view_mut::<2, 3>(6, 6).scale_mut(keeps);
        transition[(YAW, YAW_RATE)] = turning.by_rate;
        transition[(YAW_RATE, YAW_RATE)] = turning.keeps;
        let mut covariance = transition * before.covariance * transition.transpose();
        let density = settings.acceleration * settings.acceleration;
        let speed_m2_s2 = faster.sigma_m_s * faster.sigma_m_s;
        let of_both = density * interval_s * interval_s / 2.0 + speed_m2_s2 * interval_s / 2.0;
        for axis in 0..3 {
            covariance[(axis, axis)] +=
                (density * interval_s / 3.0 + speed_m2_s2 / 4.0) * interval_s * interval_s;
            covariance[(axis, axis + 3)] += of_both;
            covariance[(axis + 3, axis)] += of_both;
            covariance[(axis + 3, axis + 3)] += density * interval_s + speed_m2_s2;
        }
        covariance[(6, 6)] += tilt_rad2;
        covariance[(7, 7)] += tilt_rad2;
        covariance[(YAW, YAW)] += turning.yaw_rad2;
        covariance[(YAW, YAW_RATE)] += turning.yaw_with_rate;
        covariance[(YAW_RATE, YAW)] += turning.yaw_with_rate;
        covariance[(YAW_RATE, YAW_RATE)] += turning.rate_rad2_s2;
        let too_wide = covariance[(YAW, YAW)].sqrt() / MOST_YAW_RAD;
        if too_wide > 1.0 {
            covariance.row_mut(YAW).unscale_mut(too_wide);
            covariance.column_mut(YAW).unscale_mut(too_wide);
        }
        let by_turn = by_turn(&from_origin_m, &velocity_m_s, &camera_from_body);
        covariance += by_turn * by_turn.transpose() * (self.turn.sigma_rad * self.turn.sigma_rad);
        let pose =
            Pose { position_m, camera_from_body: camera_from_body * Rotation3::new(upright * (1.0 - keeps)) };
        let yaw_rate_rad_s = turning.keeps * before.yaw_rate_rad_s;
        Component {
            weight: before.weight,
            pose,
            velocity_m_s,
            yaw_rate_rad_s,
            covariance,
            silent: before.silent.after(interval_s, settings.correlation_s),
            power: before.power,
        }
    }

    /// Makes a vehicle that another camera showed less sure, by how far this one may see it elsewhere: about each axis, rad^2, and along each, m^2.
    pub(super) fn loosen(component: &mut Component, rotation_rad2: f64, position_m2: f64) {
        let Component { pose, velocity_m_s, .. } = component;
        let by_turn = by_turn(&pose.position_m, velocity_m_s, &pose.camera_from_body);
        component.covariance += by_turn * by_turn.transpose() * rotation_rad2;
        for axis in 0..3 {
            component.covariance[(axis, axis)] += position_m2;
        }
    }

    /// The share of a tilt that is left, and the variance that is new.
    fn tilt(&self, settings: &Settings) -> (f64, f64) {
        let (sigma_rad, time_s) = match self.up {
            Some(_) => (self.tilt_sigma_rad, settings.tilt_time_s),
            None => {
                let wider = IMAGE_TILT_SIGMA_RAD / self.tilt_sigma_rad;
                (IMAGE_TILT_SIGMA_RAD, settings.tilt_time_s * wider * wider)
            }
        };
        let keeps = libm::exp(-self.interval_s / time_s);
        (keeps, sigma_rad * sigma_rad * -libm::expm1(-2.0 * self.interval_s / time_s))
    }

    /// The rotation in the body frame that brings it upright.
    fn upright(&self, camera_from_body: &Rotation3<f64>) -> Vector3<f64> {
        let up = camera_from_body.inverse() * self.up.map_or(-Vector3::y(), Unit::into_inner);
        let across = libm::hypot(up.x, up.y);
        if across < 1e-12 {
            return Vector3::zeros();
        }
        Vector3::new(-up.y, up.x, 0.0) * (libm::atan2(across, up.z) / across)
    }
}

/// How the state changes with a small rotation of the camera's axes about what the position is told from.
fn by_turn(
    position_m: &Vector3<f64>,
    velocity_m_s: &Vector3<f64>,
    camera_from_body: &Rotation3<f64>,
) -> SMatrix<f64, SIZE, 3> {
    let mut by_turn = SMatrix::<f64, SIZE, 3>::zeros();
    by_turn.fixed_view_mut::<3, 3>(0, 0).copy_from(&-position_m.cross_matrix());
    by_turn.fixed_view_mut::<3, 3>(3, 0).copy_from(&-velocity_m_s.cross_matrix());
    let back: Matrix3<f64> = camera_from_body.matrix().transpose();
    by_turn.fixed_view_mut::<3, 3>(6, 0).copy_from(&back);
    by_turn
}
