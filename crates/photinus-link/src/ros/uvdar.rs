//! uvdar_core, the messages of UVDAR's own stack on ROS 2.

use serde::{Deserialize, Serialize};

use super::{Header, Matrix3, Matrix6, Point, Pose, Time, Vector3};

/// uvdar_core/Point2DWithCovariance.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "the fields are those of the ROS definition")]
pub struct Point2DWithCovariance {
    pub x: f64,
    pub y: f64,
    pub covariance_00: f64,
    pub covariance_01: f64,
    pub covariance_10: f64,
    pub covariance_11: f64,
}

/// uvdar_core/ImagePointsWithCovariancesStamped.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "the fields are those of the ROS definition")]
pub struct ImagePointsWithCovariancesStamped {
    pub stamp: Time,
    pub image_height: u32,
    pub image_width: u32,
    pub points: Vec<Point2DWithCovariance>,
}

/// uvdar_core/PoseWithCovarianceIdentified.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "the fields are those of the ROS definition")]
pub struct PoseWithCovarianceIdentified {
    pub id: i32,
    pub pose: Pose,
    pub covariance: Matrix6,
}

/// uvdar_core/PoseWithCovarianceArrayStamped.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "the fields are those of the ROS definition")]
pub struct PoseWithCovarianceArrayStamped {
    pub header: Header,
    pub poses: Vec<PoseWithCovarianceIdentified>,
}

/// uvdar_core/BearingObservation.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "the fields are those of the ROS definition")]
pub struct BearingObservation {
    pub id: i32,
    pub track_id: u32,
    pub bearing: Vector3,
    pub origin: Point,
    pub covariance: Matrix3,
    pub predicted: bool,
}

/// uvdar_core/BearingObservationArrayStamped.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "the fields are those of the ROS definition")]
pub struct BearingObservationArrayStamped {
    pub header: Header,
    pub observations: Vec<BearingObservation>,
}
