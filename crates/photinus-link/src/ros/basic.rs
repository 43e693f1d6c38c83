//! builtin_interfaces, std_msgs, geometry_msgs and tf2_msgs.

use nalgebra::{Quaternion as Q, UnitQuaternion, Vector3 as V};
use serde::{Deserialize, Serialize};

/// Nine numbers, row by row.
pub type Matrix3 = [[f64; 3]; 3];
/// Thirty-six numbers, row by row.
pub type Matrix6 = [[f64; 6]; 6];

/// builtin_interfaces/Time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[expect(missing_docs, reason = "the fields are those of the ROS definition")]
pub struct Time {
    pub sec: i32,
    pub nanosec: u32,
}

impl Time {
    /// The nearest time to this many seconds; those that no such time holds become the first or last one, NaN becomes 0.
    #[must_use]
    pub fn from_seconds(seconds: f64) -> Self {
        // Past 2^53 whole nanoseconds a product would round: seconds and their rest are taken apart first.
        let whole = seconds.floor();
        let nanosec = ((seconds - whole) * 1e9).round();
        let carry = nanosec >= 1e9;
        let sec = whole + if carry { 1.0 } else { 0.0 };
        if sec > f64::from(i32::MAX) {
            return Self { sec: i32::MAX, nanosec: 999_999_999 };
        }
        if sec < f64::from(i32::MIN) {
            return Self { sec: i32::MIN, nanosec: 0 };
        }
        Self { sec: sec as i32, nanosec: if carry { 0 } else { nanosec as u32 } }
    }

    /// Seconds; a sum of parts that no clock gives (`nanosec` of a second and more) is taken as it stands.
    #[must_use]
    pub fn seconds(self) -> f64 {
        f64::from(self.sec) + f64::from(self.nanosec) * 1e-9
    }

    /// This many nanoseconds since the clock's beginning.
    #[must_use]
    pub fn from_nanoseconds(nanoseconds: u64) -> Self {
        let sec = i32::try_from(nanoseconds / 1_000_000_000).unwrap_or(i32::MAX);
        Self { sec, nanosec: (nanoseconds % 1_000_000_000) as u32 }
    }

    /// Nanoseconds since the clock's beginning; 0 before it.
    #[must_use]
    pub fn nanoseconds(self) -> u64 {
        u64::try_from(i64::from(self.sec) * 1_000_000_000 + i64::from(self.nanosec)).unwrap_or(0)
    }
}

/// std_msgs/Header.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "the fields are those of the ROS definition")]
pub struct Header {
    pub stamp: Time,
    pub frame_id: String,
}

/// std_msgs/String.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "the fields are those of the ROS definition")]
pub struct Text {
    pub data: String,
}

/// geometry_msgs/Point.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "the fields are those of the ROS definition")]
pub struct Point {
    pub x: f64,
    pub y: f64,
    pub z: f64,
}

/// geometry_msgs/Vector3.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "the fields are those of the ROS definition")]
pub struct Vector3 {
    pub x: f64,
    pub y: f64,
    pub z: f64,
}

/// geometry_msgs/Quaternion.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "the fields are those of the ROS definition")]
pub struct Quaternion {
    pub x: f64,
    pub y: f64,
    pub z: f64,
    pub w: f64,
}

/// geometry_msgs/Pose.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "the fields are those of the ROS definition")]
pub struct Pose {
    pub position: Point,
    pub orientation: Quaternion,
}

/// geometry_msgs/PoseWithCovariance: about fixed axes of the header's frame, x, y, z, then the turns about them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "the fields are those of the ROS definition")]
pub struct PoseWithCovariance {
    pub pose: Pose,
    pub covariance: Matrix6,
}

/// geometry_msgs/Transform.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "the fields are those of the ROS definition")]
pub struct Transform {
    pub translation: Vector3,
    pub rotation: Quaternion,
}

/// geometry_msgs/TransformStamped.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "the fields are those of the ROS definition")]
pub struct TransformStamped {
    pub header: Header,
    pub child_frame_id: String,
    pub transform: Transform,
}

/// tf2_msgs/TFMessage.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "the fields are those of the ROS definition")]
pub struct TFMessage {
    pub transforms: Vec<TransformStamped>,
}

impl Default for Quaternion {
    fn default() -> Self {
        Self { x: 0.0, y: 0.0, z: 0.0, w: 1.0 }
    }
}

impl From<[f64; 3]> for Point {
    fn from([x, y, z]: [f64; 3]) -> Self {
        Self { x, y, z }
    }
}

impl From<[f64; 3]> for Vector3 {
    fn from([x, y, z]: [f64; 3]) -> Self {
        Self { x, y, z }
    }
}

impl From<V<f64>> for Vector3 {
    fn from(vector: V<f64>) -> Self {
        <[f64; 3]>::from(vector).into()
    }
}

/// From x, y, z, w.
impl From<[f64; 4]> for Quaternion {
    fn from([x, y, z, w]: [f64; 4]) -> Self {
        Self { x, y, z, w }
    }
}

impl From<UnitQuaternion<f64>> for Quaternion {
    fn from(turn: UnitQuaternion<f64>) -> Self {
        let Q { coords } = turn.into_inner();
        <[f64; 4]>::from(coords).into()
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn a_time_is_within_half_a_nanosecond(seconds in -2e9..2e9_f64) {
            let time = Time::from_seconds(seconds);
            prop_assert!(time.nanosec < 1_000_000_000);
            // The rest is what a double of this size can hold.
            prop_assert!((time.seconds() - seconds).abs() <= 0.51e-9 + seconds.abs() * f64::EPSILON);
        }

        #[test]
        fn a_time_of_a_clock_of_the_epoch_comes_back_bit_for_bit(seconds in 1e8..2.1e9_f64) {
            prop_assert_eq!(Time::from_seconds(seconds).seconds().to_bits(), seconds.to_bits());
        }
    }

    #[test]
    fn seconds_that_no_time_holds_become_the_nearest_one() {
        assert_eq!(Time::from_seconds(f64::NAN), Time::default());
        assert_eq!(Time::from_seconds(f64::INFINITY).sec, i32::MAX);
        assert_eq!(Time::from_seconds(-1e300).sec, i32::MIN);
        assert_eq!(Time::from_seconds(1.999_999_999_9), Time { sec: 2, nanosec: 0 });
        assert_eq!(Time::from_seconds(-0.25), Time { sec: -1, nanosec: 750_000_000 });
        assert_eq!(Time { sec: -1, nanosec: 5 }.nanoseconds(), 0);
    }
}
