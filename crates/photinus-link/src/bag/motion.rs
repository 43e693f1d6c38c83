//! sensor_msgs/Imu and nav_msgs/Odometry as ROS 1 writes them.

use super::serial::Fields;
use crate::ros::{Imu, Matrix3, Matrix6, Odometry, Pose, PoseWithCovariance, Twist, TwistWithCovariance};

/// sensor_msgs/Imu; `None` of other bytes.
pub(crate) fn imu(bytes: &[u8]) -> Option<Imu> {
    let mut fields = Fields(bytes);
    let fields = &mut fields;
    Some(Imu {
        header: fields.header()?,
        orientation: numbers::<4>(fields)?.into(),
        orientation_covariance: matrix3(fields)?,
        angular_velocity: numbers::<3>(fields)?.into(),
        angular_velocity_covariance: matrix3(fields)?,
        linear_acceleration: numbers::<3>(fields)?.into(),
        linear_acceleration_covariance: matrix3(fields)?,
    })
}

/// nav_msgs/Odometry; `None` of other bytes.
pub(crate) fn odometry(bytes: &[u8]) -> Option<Odometry> {
    let mut fields = Fields(bytes);
    let fields = &mut fields;
    let (header, child_frame_id) = (fields.header()?, fields.text()?.to_owned());
    let pose = Pose { position: numbers::<3>(fields)?.into(), orientation: numbers::<4>(fields)?.into() };
    let pose = PoseWithCovariance { pose, covariance: matrix6(fields)? };
    let twist = Twist { linear: numbers::<3>(fields)?.into(), angular: numbers::<3>(fields)?.into() };
    let twist = TwistWithCovariance { twist, covariance: matrix6(fields)? };
    Some(Odometry { header, child_frame_id, pose, twist })
}

fn numbers<const N: usize>(fields: &mut Fields<'_>) -> Option<[f64; N]> {
    let mut numbers = [0.0; N];
    for number in &mut numbers {
        *number = fields.f64()?;
    }
    Some(numbers)
}

fn matrix3(fields: &mut Fields<'_>) -> Option<Matrix3> {
    let rows = [numbers(fields)?, numbers(fields)?, numbers(fields)?];
    Some(rows)
}

fn matrix6(fields: &mut Fields<'_>) -> Option<Matrix6> {
    let mut rows = Matrix6::default();
    for number in rows.iter_mut().flatten() {
        *number = fields.f64()?;
    }
    Some(rows)
}
