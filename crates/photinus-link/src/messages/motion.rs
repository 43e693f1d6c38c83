//! sensor_msgs/Imu and nav_msgs/Odometry -> attitudes and rates of the body, where they say such.

use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use photinus_run::motion::Velocity;

use crate::ros::{self, Imu, Odometry};

/// How a body is turned, and turns, at a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turning {
    /// The stamp, s.
    pub time_s: f64,
    /// The attitude world_from_body, world with z up.
    pub attitude: Option<UnitQuaternion<f64>>,
    /// Rate against the world in the body frame, rad/s.
    pub rate_rad_s: Option<Vector3<f64>>,
    /// Velocity over the ground in the body frame.
    pub velocity: Option<Velocity>,
}

/// What an IMU says. By the definition of the message, a covariance whose first number is -1 means that there is no such value. Its frame is
/// taken for the body's (REP 145 calls such an IMU aligned).
#[must_use]
pub fn of_imu(imu: &Imu) -> Turning {
    Turning {
        time_s: imu.header.stamp.seconds(),
        attitude: attitude(&imu.orientation).filter(|_| imu.orientation_covariance[0][0] >= 0.0),
        rate_rad_s: vector(&imu.angular_velocity).filter(|_| imu.angular_velocity_covariance[0][0] >= 0.0),
        velocity: None,
    }
}

/// What an odometry says: its pose stands in a frame whose z is up, its twist in that of the body (REP 103, 105).
#[must_use]
pub fn of_odometry(odometry: &Odometry) -> Turning {
    let variances = Vector3::from_fn(|axis, _| odometry.twist.covariance[axis][axis]);
    Turning {
        time_s: odometry.header.stamp.seconds(),
        attitude: attitude(&odometry.pose.pose.orientation),
        rate_rad_s: vector(&odometry.twist.twist.angular),
        velocity: vector(&odometry.twist.twist.linear)
            .map(|velocity_m_s| Velocity::with_variances(velocity_m_s, variances)),
    }
}

/// Four numbers that are a turn; `None` for zeros and other numbers that are none.
pub(super) fn attitude(told: &ros::Quaternion) -> Option<UnitQuaternion<f64>> {
    let turn = Quaternion::new(told.w, told.x, told.y, told.z);
    // false for NaN, too
    ((turn.norm() - 1.0).abs() < 0.01).then(|| UnitQuaternion::from_quaternion(turn))
}

fn vector(told: &ros::Vector3) -> Option<Vector3<f64>> {
    let vector = Vector3::new(told.x, told.y, told.z);
    vector.iter().all(|part| part.is_finite()).then_some(vector)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn imu(orientation: [f64; 4], orientation_00: f64, rate_00: f64) -> Turning {
        let mut imu = Imu {
            orientation: orientation.into(),
            angular_velocity: [1.0, 2.0, 3.0].into(),
            ..Imu::default()
        };
        imu.header.stamp = ros::Time { sec: 7, nanosec: 500_000_000 };
        imu.orientation_covariance[0][0] = orientation_00;
        imu.angular_velocity_covariance[0][0] = rate_00;
        of_imu(&imu)
    }

    #[test]
    fn an_imu_says_what_it_has_and_nothing_else() {
        let half = std::f64::consts::FRAC_1_SQRT_2;
        let told = imu([0.0, 0.0, half, half], 0.0, 0.0);
        assert!((told.time_s - 7.5).abs() < 1e-12);
        let ahead = told.attitude.unwrap() * Vector3::x();
        assert!((ahead - Vector3::y()).norm() < 1e-12, "a quarter turn to the left");
        assert_eq!(told.rate_rad_s, Some(Vector3::new(1.0, 2.0, 3.0)));
        assert_eq!(imu([0.0, 0.0, half, half], -1.0, 0.0).attitude, None);
        assert_eq!(imu([0.0, 0.0, half, half], 0.0, -1.0).rate_rad_s, None);
        for none in [[0.0; 4], [f64::NAN; 4], [0.0, 0.0, 0.0, 3.0]] {
            assert_eq!(imu(none, 0.0, 0.0).attitude, None, "{none:?}");
        }
    }

    #[test]
    fn an_odometry_says_both() {
        let mut odometry = Odometry::default();
        odometry.twist.twist.angular = [0.0, 0.0, 0.5].into();
        let told = of_odometry(&odometry);
        assert_eq!(
            (told.attitude, told.rate_rad_s),
            (Some(UnitQuaternion::identity()), Some(Vector3::new(0.0, 0.0, 0.5)))
        );
        odometry.twist.twist.angular.x = f64::NAN;
        assert_eq!(of_odometry(&odometry).rate_rad_s, None);
    }
}
