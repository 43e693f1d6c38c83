//! How a camera turned from frame to frame, how fast it moves, and where down is: from what a dataset or a recording says of it, or from what arrives while it
//! flies.

use std::borrow::Cow;
use std::f64::consts::SQRT_2;

use nalgebra::{Rotation3, Unit, UnitQuaternion, Vector3};
use photinus::tracking::{self, Moving, Turned};
use photinus_io::Result;
use photinus_io::calibration::MountingFile;
use photinus_io::dataset::{Dataset, ImuRow};

use crate::motion::{Motion, Velocity};

/// What an odometry's attitude is off by from frame to frame, rad per axis.
const ODOMETRY_SIGMA_RAD: f64 = 3e-3;
/// What an odometry says at times this far apart, s, says nothing of what is between.
const LONGEST_GAP_S: f64 = 0.25;
/// Attitudes this far apart, s, tell a rate where no gyro does.
const RATE_FROM_S: f64 = 0.02;

/// What tells how a camera moves.
#[derive(Debug)]
pub enum Course {
    /// What was recorded of it.
    Told(Told),
    /// What arrives while frames do, of the body that the camera sits on.
    Live {
        /// What the vehicle says of its motion.
        motion: Motion,
        /// How and where the camera sits on it.
        mounting: MountingFile,
    },
}

/// How a camera moved, each in the order of time, s; empty where nothing says it.
#[derive(Clone, Debug, Default)]
pub struct Told {
    /// Rates of turn in its own axes, rad/s. They go before attitudes.
    pub rates: Vec<(f64, Vector3<f64>)>,
    /// Attitudes world_from_camera.
    pub attitudes: Vec<(f64, UnitQuaternion<f64>)>,
    /// Velocities of the body's origin over the ground, in the camera's axes.
    pub velocities: Vec<(f64, Velocity)>,
    /// From that origin to the camera, in the camera's axes, m.
    pub lever_m: Vector3<f64>,
    /// Whether the attitudes say where down is: their world has z up.
    pub has_down: bool,
}

impl Default for Course {
    /// Nothing is known.
    fn default() -> Self {
        Self::Told(Told::default())
    }
}

impl Course {
    /// What a dataset says of a camera that is mounted so: its gyro and its odometry. A dataset without mountings has its gyro in the camera's frame; its
    /// odometry is that of the vehicle, and says nothing of a camera whose mounting is not known.
    ///
    /// # Errors
    /// As [`Dataset::imu`] and [`Dataset::odometry`].
    pub fn of(dataset: &Dataset, is_rig: bool, mounting: Option<&MountingFile>) -> Result<Self> {
        let (imu, odometry) = (dataset.imu()?, dataset.odometry()?);
        let mut told = Told::default();
        let camera_from_body = mounting.map(|mounting| mounting.body_from_camera.inverse());
        let camera_from_gyro = if is_rig { camera_from_body } else { Some(UnitQuaternion::identity()) };
        if let Some(camera_from_gyro) = camera_from_gyro {
            let rate = |row: ImuRow| (row.time_s, camera_from_gyro * row.turn_rad_s);
            told.rates.extend(imu.into_iter().flatten().map(rate));
        }
        told.lever_m = mounting.map_or_else(Vector3::zeros, lever_m);
        if let Some(camera_from_body) = camera_from_body {
            for row in odometry.into_iter().flatten() {
                let attitude = row.pose.rotation * camera_from_body.inverse();
                told.attitudes.push((row.time_s, attitude));
                let velocity = Velocity::new(row.velocity_m_s, row.velocity_sigma_m_s);
                told.velocities.push((row.time_s, velocity.turned(&attitude.inverse())));
            }
        }
        Ok(Self::Told(told))
    }

    /// The same of the middle of the vehicle, in the camera's axes.
    pub(crate) fn of_middle(self) -> Self {
        match self {
            Self::Told(told) => Self::Told(Told { lever_m: Vector3::zeros(), ..told }),
            Self::Live { motion, mounting } => {
                Self::Live { motion, mounting: MountingFile { position_m: None, ..mounting } }
            }
        }
    }

    /// How the camera turned between two times.
    pub(crate) fn turned(&self, from_s: f64, to_s: f64) -> Option<Turned> {
        tracking::turned(&self.rates(), from_s, to_s).or_else(|| turned_by(&self.attitudes(), from_s, to_s))
    }

    /// How fast the camera moves at a time. Nobody says how much of a velocity's error the next one shares: none of it is the worst for what it gained.
    pub(crate) fn moving(&self, time_s: f64) -> Option<Moving> {
        let told = at(&self.velocities(), time_s, Velocity::lerp)?;
        let swung = self.swung(time_s)?;
        let variance_m2_s2 = told.sigma_m_s * told.sigma_m_s + swung.sigma_m_s * swung.sigma_m_s;
        let velocity_m_s = told.velocity_m_s + swung.velocity_m_s;
        Some(Moving { velocity_m_s, sigma_m_s: SQRT_2 * variance_m2_s2.sqrt() })
    }

    /// How much faster than the body's origin the camera is because the body turns.
    fn swung(&self, time_s: f64) -> Option<Velocity> {
        let lever_m = match self {
            Self::Told(told) => told.lever_m,
            Self::Live { mounting, .. } => lever_m(mounting),
        };
        if lever_m == Vector3::zeros() {
            return Some(Velocity { velocity_m_s: Vector3::zeros(), sigma_m_s: 0.0 });
        }
        let by_gyro = at(&self.rates(), time_s, |begin, end, share| begin.lerp(end, share));
        let (rate_rad_s, sigma_rad_s) = by_gyro.map(|rate| (rate, 0.0)).or_else(|| {
            let turned = turned_by(&self.attitudes(), time_s - RATE_FROM_S, time_s)?;
            let rate = -turned.now_from_before.scaled_axis() / RATE_FROM_S;
            Some((rate, turned.sigma_rad / RATE_FROM_S))
        })?;
        Some(Velocity { velocity_m_s: rate_rad_s.cross(&lever_m), sigma_m_s: sigma_rad_s * lever_m.norm() })
    }

    /// Down in the camera frame at a time, where attitudes are known against a world with z up.
    pub(crate) fn down(&self, time_s: f64) -> Option<Unit<Vector3<f64>>> {
        let has_down = match self {
            Self::Told(told) => told.has_down,
            Self::Live { .. } => true,
        };
        let world_from_camera = has_down.then(|| attitude_at(&self.attitudes(), time_s)).flatten()?;
        Some(world_from_camera.inverse() * -Vector3::z_axis())
    }

    fn rates(&self) -> Cow<'_, [(f64, Vector3<f64>)]> {
        match self {
            Self::Told(told) => Cow::Borrowed(&told.rates),
            Self::Live { motion, mounting } => {
                let camera_from_body = mounting.body_from_camera.inverse();
                let rate = |(time_s, of_body)| (time_s, camera_from_body * of_body);
                Cow::Owned(motion.rates().into_iter().map(rate).collect())
            }
        }
    }

    fn velocities(&self) -> Cow<'_, [(f64, Velocity)]> {
        match self {
            Self::Told(told) => Cow::Borrowed(&told.velocities),
            Self::Live { motion, mounting } => {
                let camera_from_body = mounting.body_from_camera.inverse();
                let velocity =
                    |(time_s, velocity): (f64, Velocity)| (time_s, velocity.turned(&camera_from_body));
                Cow::Owned(motion.velocities().into_iter().map(velocity).collect())
            }
        }
    }

    fn attitudes(&self) -> Cow<'_, [(f64, UnitQuaternion<f64>)]> {
        match self {
            Self::Told(told) => Cow::Borrowed(&told.attitudes),
            Self::Live { motion, mounting } => {
                let attitude = |(time_s, attitude)| (time_s, attitude * mounting.body_from_camera);
                Cow::Owned(motion.attitudes().into_iter().map(attitude).collect())
            }
        }
    }
}

/// From the body's origin to a camera that is mounted so, in the camera's axes, m: none where nobody measured it.
#[must_use]
pub fn lever_m(mounting: &MountingFile) -> Vector3<f64> {
    mounting.body_from_camera.inverse() * mounting.position_m.unwrap_or_default()
}

/// How a camera with these attitudes turned between two times.
fn turned_by(attitudes: &[(f64, UnitQuaternion<f64>)], from_s: f64, to_s: f64) -> Option<Turned> {
    let [before, now] = [attitude_at(attitudes, from_s)?, attitude_at(attitudes, to_s)?];
    let now_from_before: Rotation3<f64> = (now.inverse() * before).to_rotation_matrix();
    Some(Turned { now_from_before, sigma_rad: ODOMETRY_SIGMA_RAD })
}

/// The attitude at a time, turned evenly between those before and after it.
fn attitude_at(attitudes: &[(f64, UnitQuaternion<f64>)], time_s: f64) -> Option<UnitQuaternion<f64>> {
    at(attitudes, time_s, |begin, end, share| {
        let turn = (begin.inverse() * end).scaled_axis() * share;
        begin * UnitQuaternion::from_scaled_axis(turn)
    })
}

/// What is told at a time, between what is told before and after it.
fn at<T: Copy>(told: &[(f64, T)], time_s: f64, between: impl FnOnce(&T, &T, f64) -> T) -> Option<T> {
    let after = told.partition_point(|own| own.0 < time_s);
    let (end_s, end) = told.get(after)?;
    if *end_s <= time_s {
        return Some(*end);
    }
    let (begin_s, begin) = told.get(after.checked_sub(1)?)?;
    let share = (time_s - begin_s) / (end_s - begin_s);
    (end_s - begin_s <= LONGEST_GAP_S).then(|| between(begin, end, share))
}

#[cfg(test)]
mod tests {
    use nalgebra::Matrix3;

    use super::*;

    #[test]
    fn a_recording_says_where_down_is_and_how_the_camera_turned_by_rates_or_else_by_attitudes() {
        // It turns at 1 rad/s about its x axis, from level (z up) on.
        let at = |time_s: f64| (time_s, UnitQuaternion::from_euler_angles(time_s, 0.0, 0.0));
        let attitudes: Vec<_> = (0..=10).map(|step| at(0.1 * f64::from(step))).collect();
        let of = |rates| {
            let attitudes = attitudes.clone();
            Course::Told(Told { rates, attitudes, has_down: true, ..Told::default() })
        };
        // Between two attitudes it turns evenly.
        let down = of(Vec::new()).down(0.55).unwrap();
        assert!((down.into_inner() - Vector3::new(0.0, -libm::sin(0.55), -libm::cos(0.55))).norm() < 1e-9);
        assert!(of(Vec::new()).down(1.5).is_none() && of(Vec::new()).down(-0.1).is_none());
        let turned = of(Vec::new()).turned(0.2, 0.25).unwrap().now_from_before;
        assert!((turned.scaled_axis() + Vector3::x() * 0.05).norm() < 1e-9, "{turned}");
        let rates: Vec<_> =
            (0..=100).map(|step| (0.01 * f64::from(step), Vector3::new(2.0, 0.0, 0.0))).collect();
        let turned = of(rates).turned(0.2, 0.25).unwrap().now_from_before;
        assert!((turned.scaled_axis() + Vector3::x() * 0.1).norm() < 1e-9, "rates go before: {turned}");
    }

    fn mounted(body_from_camera: UnitQuaternion<f64>, position_m: Option<Vector3<f64>>) -> MountingFile {
        MountingFile {
            body_from_camera,
            rotation_covariance_rad2: Matrix3::zeros(),
            position_m,
            position_covariance_m2: None,
        }
    }

    #[test]
    fn a_camera_beside_the_middle_of_its_vehicle_is_swung_when_that_turns() {
        let body_from_camera = UnitQuaternion::from_euler_angles(-1.2, 0.1, 0.4);
        let mounting = mounted(body_from_camera, Some(Vector3::new(0.3, -0.1, 0.05)));
        let position_m = |time_s: f64| Vector3::new(libm::sin(time_s), 0.5 * time_s * time_s, -time_s);
        let attitude =
            |time_s: f64| UnitQuaternion::from_euler_angles(0.2 * libm::sin(3.0 * time_s), 0.3, 2.5 * time_s);
        // The truth is where the camera is, twice.
        let step_s = 1e-5;
        let camera_m = |time_s: f64| position_m(time_s) + attitude(time_s) * mounting.position_m.unwrap();
        let slope = |of: &dyn Fn(f64) -> Vector3<f64>, time_s: f64| {
            (of(time_s + step_s) - of(time_s - step_s)) / (2.0 * step_s)
        };
        for has_gyro in [false, true] {
            let motion = Motion::default();
            for step in 0..400 {
                let time_s = 5e-3 * f64::from(step);
                motion.attitude(time_s, attitude(time_s));
                let velocity_m_s = attitude(time_s).inverse() * slope(&position_m, time_s);
                motion.velocity(time_s, Velocity::new(velocity_m_s, Some(0.02)));
                if has_gyro {
                    let turn = attitude(time_s - step_s).inverse() * attitude(time_s + step_s);
                    motion.rate(time_s, turn.scaled_axis() / (2.0 * step_s));
                }
            }
            let course = Course::Live { motion, mounting };
            for time_s in [0.3071, 0.62, 1.4033] {
                let moving = course.moving(time_s).unwrap();
                let truth_m_s = (attitude(time_s) * body_from_camera).inverse() * slope(&camera_m, time_s);
                let off_m_s = (moving.velocity_m_s - truth_m_s).norm();
                let (most_m_s, least_sigma_m_s) = if has_gyro { (1e-3, 0.0) } else { (0.01, 0.04) };
                assert!(off_m_s < most_m_s, "{has_gyro} {time_s}: {off_m_s}");
                assert!(moving.sigma_m_s > least_sigma_m_s, "{moving:?}");
                // Without the lever it would be off by more than half a metre per second.
                assert!(
                    (truth_m_s
                        - (attitude(time_s) * body_from_camera).inverse() * slope(&position_m, time_s))
                    .norm()
                        > 0.5
                );
            }
        }
    }

    #[test]
    fn velocities_of_a_vehicle_are_told_in_the_axes_of_its_camera() {
        // The camera looks to the left of the body, z ahead of it, and its x axis along the body's.
        let body_from_camera = UnitQuaternion::from_euler_angles(-std::f64::consts::FRAC_PI_2, 0.0, 0.0);
        let mounting = mounted(body_from_camera, None);
        let motion = Motion::default();
        let hear = |time_s: f64, [x, y, z]: [f64; 3], variance: f64| {
            let velocity_m_s = Vector3::new(x, y, z);
            motion.velocity(time_s, Velocity::with_variances(velocity_m_s, Vector3::repeat(variance)));
        };
        hear(1.0, [2.0, 0.0, 0.0], 0.01);
        hear(1.1, [2.0, 1.0, 0.0], 0.09);
        hear(1.05, [9.0, 9.0, 9.0], 0.01);
        for (number, untold) in [0.0, -1.0, f64::NAN, f64::INFINITY].into_iter().enumerate() {
            hear(1.2 + 0.1 * number as f64, [0.0; 3], untold);
        }
        hear(2.0, [f64::NAN; 3], 0.01);
        let course = Course::Live { motion, mounting };
        let moving = course.moving(1.05).unwrap();
        assert!((moving.velocity_m_s - Vector3::new(2.0, 0.0, 0.5)).norm() < 1e-9, "{moving:?}");
        assert!((moving.sigma_m_s - 0.2 * SQRT_2).abs() < 1e-9, "{moving:?}");
        for time_s in [1.2, 1.3, 1.4, 1.5] {
            let untold = course.moving(time_s).unwrap().sigma_m_s;
            assert!((untold - 0.05 * SQRT_2).abs() < 1e-9, "{time_s}: {untold}");
        }
        assert!(course.moving(0.99).is_none() && course.moving(1.51).is_none());
    }
}
