//! vision_msgs, version 4.

use serde::{Deserialize, Serialize};

use super::{Header, Pose, PoseWithCovariance, Vector3};

/// vision_msgs/ObjectHypothesis.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "the fields are those of the ROS definition")]
pub struct ObjectHypothesis {
    pub class_id: String,
    pub score: f64,
}

/// vision_msgs/ObjectHypothesisWithPose.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "the fields are those of the ROS definition")]
pub struct ObjectHypothesisWithPose {
    pub hypothesis: ObjectHypothesis,
    pub pose: PoseWithCovariance,
}

/// vision_msgs/BoundingBox3D.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "the fields are those of the ROS definition")]
pub struct BoundingBox3D {
    pub center: Pose,
    pub size: Vector3,
}

/// vision_msgs/Detection3D.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "the fields are those of the ROS definition")]
pub struct Detection3D {
    pub header: Header,
    pub results: Vec<ObjectHypothesisWithPose>,
    pub bbox: BoundingBox3D,
    pub id: String,
}

/// vision_msgs/Detection3DArray.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "the fields are those of the ROS definition")]
pub struct Detection3DArray {
    pub header: Header,
    pub detections: Vec<Detection3D>,
}
