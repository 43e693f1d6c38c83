//! geometry_msgs that tell where something is at a time.

use serde::{Deserialize, Serialize};

use super::{Header, Pose, PoseWithCovariance};

/// geometry_msgs/PoseStamped.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "the fields are those of the ROS definition")]
pub struct PoseStamped {
    pub header: Header,
    pub pose: Pose,
}

/// geometry_msgs/PoseWithCovarianceStamped.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "the fields are those of the ROS definition")]
pub struct PoseWithCovarianceStamped {
    pub header: Header,
    pub pose: PoseWithCovariance,
}
