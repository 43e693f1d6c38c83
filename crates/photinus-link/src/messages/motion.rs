//! sensor_msgs/Imu, nav_msgs/Odometry and tf -> attitudes and rates of the body, where they say such.

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use crate::ros::{self, Imu, Odometry, TFMessage};

/// How a body is turned, and turns, at a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turning {
    /// The stamp, s.
    pub time_s: f64,
    /// The attitude world_from_body, world with z up.
    pub attitude: Option<UnitQuaternion<f64>>,
    /// Rate against the world in the body frame, rad/s.
    pub rate_rad_s: Option<Vector3<f64>>,
}

/// What an IMU says. By the definition of the message, a covariance whose first number is -1 means that there is no such value. Its frame is
/// taken for the body's (REP 145 calls such an IMU aligned).
#[must_use]
pub fn of_imu(imu: &Imu) -> Turning {
    Turning {
        time_s: imu.header.stamp.seconds(),
        attitude: attitude(&imu.orientation).filter(|_| imu.orientation_covariance[0][0] >= 0.0),
        rate_rad_s: rate(&imu.angular_velocity).filter(|_| imu.angular_velocity_covariance[0][0] >= 0.0),
    }
}

/// What an odometry says: its pose stands in a frame whose z is up, its twist in that of the body (REP 103, 105).
#[must_use]
pub fn of_odometry(odometry: &Odometry) -> Turning {
    Turning {
        time_s: odometry.header.stamp.seconds(),
        attitude: attitude(&odometry.pose.pose.orientation),
        rate_rad_s: rate(&odometry.twist.twist.angular),
    }
}

/// What tf says of `body`, whose parent is `world`, a frame with z up: the last such transform of the message.
#[must_use]
pub fn of_transforms(told: &TFMessage, world: &str, body: &str) -> Option<Turning> {
    let is = |frame: &str, wanted: &str| frame.trim_start_matches('/') == wanted.trim_start_matches('/');
    let mut transforms = told.transforms.iter().rev();
    let found = transforms.find(|told| is(&told.header.frame_id, world) && is(&told.child_frame_id, body))?;
    Some(Turning {
        time_s: found.header.stamp.seconds(),
        attitude: attitude(&found.transform.rotation),
        rate_rad_s: None,
    })
}

/// Four numbers that are a turn; `None` for zeros and other numbers that are none.
fn attitude(told: &ros::Quaternion) -> Option<UnitQuaternion<f64>> {
    let turn = Quaternion::new(told.w, told.x, told.y, told.z);
    // false for NaN, too
    ((turn.norm() - 1.0).abs() < 0.01).then(|| UnitQuaternion::from_quaternion(turn))
}

fn rate(told: &ros::Vector3) -> Option<Vector3<f64>> {
    let rate = Vector3::new(told.x, told.y, told.z);
    rate.iter().all(|part| part.is_finite()).then_some(rate)
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

    #[test]
    fn tf_says_how_the_body_is_turned_against_its_own_parent_only() {
        let quarter = std::f64::consts::FRAC_1_SQRT_2;
        let transform = |parent: &str, child: &str, sec, rotation: [f64; 4]| {
            let mut told = ros::TransformStamped::default();
            told.header.frame_id = parent.to_owned();
            told.header.stamp = ros::Time { sec, nanosec: 0 };
            told.child_frame_id = child.to_owned();
            told.transform.rotation = rotation.into();
            told
        };
        let roll = [quarter, 0.0, 0.0, quarter];
        let told = TFMessage {
            transforms: vec![
                transform("odom", "base_link", 3, [0.0, 0.0, 0.0, 1.0]),
                transform("/odom", "base_link", 4, roll),
                transform("map", "base_link", 5, [0.0, 0.0, 0.0, 1.0]),
                transform("odom", "camera", 6, [0.0, 0.0, 0.0, 1.0]),
            ],
        };
        let said = of_transforms(&told, "odom", "base_link").unwrap();
        assert!((said.time_s - 4.0).abs() < 1e-12 && said.rate_rad_s.is_none());
        assert!((said.attitude.unwrap() * Vector3::y() - Vector3::z()).norm() < 1e-12);
        assert_eq!(of_transforms(&told, "odom", "imu"), None);
        let zeros = TFMessage { transforms: vec![transform("odom", "base_link", 1, [0.0; 4])] };
        assert_eq!(of_transforms(&zeros, "odom", "base_link").unwrap().attitude, None);
    }
}
