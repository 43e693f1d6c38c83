//! vision_msgs/Detection3DArray: what any ROS program that knows of detections can use.

use photinus_io::results::{FrameRecord, Mode, NeighbourRecord};

use super::covariance::pose_covariance;
use super::name;
use crate::ros::{
    BoundingBox3D, Detection3D, Detection3DArray, Header, ObjectHypothesis, ObjectHypothesisWithPose, Point,
    Pose, PoseWithCovariance, Quaternion,
};

/// `class_id` of who is not known.
const UNKNOWN: &str = "unknown";

pub(super) fn of(record: &FrameRecord, header: &Header) -> Detection3DArray {
    let detection = |neighbour: &NeighbourRecord| Detection3D {
        header: header.clone(),
        results: neighbour.modes.iter().map(|mode| hypothesis(mode, neighbour)).collect(),
        bbox: bounding_box(neighbour),
        id: name(neighbour.id, neighbour.track),
    };
    let detections = record.neighbours.iter().map(detection).collect();
    Detection3DArray { header: header.clone(), detections }
}

/// Its score is the probability that the neighbour is there and is posed so.
fn hypothesis(mode: &Mode, neighbour: &NeighbourRecord) -> ObjectHypothesisWithPose {
    let class_id = neighbour.id.map_or_else(|| UNKNOWN.to_owned(), |id| id.to_string());
    let score = neighbour.probability.unwrap_or(1.0) * mode.weight;
    ObjectHypothesisWithPose { hypothesis: ObjectHypothesis { class_id, score }, pose: of_mode(mode) }
}

/// The pose of a mode.
pub(super) fn of_mode(mode: &Mode) -> PoseWithCovariance {
    let attitude = mode.orientation_xyzw.zip(mode.orientation_covariance_rad2.as_ref());
    PoseWithCovariance {
        pose: Pose {
            position: mode.position_m.into(),
            orientation: mode.orientation_xyzw.map_or_else(Quaternion::default, Quaternion::from),
        },
        covariance: pose_covariance(
            &mode.position_covariance_m2,
            attitude,
            mode.position_orientation_covariance_m_rad.as_ref(),
        ),
    }
}

/// The mean pose without a size: an airframe's is not in the results. Where only bounds are known, the middle between them; where it has
/// no upper one, the lower.
fn bounding_box(neighbour: &NeighbourRecord) -> BoundingBox3D {
    let distance = &neighbour.distance_m;
    let middle_m = distance.max.map_or(distance.min, |max| 0.5 * (distance.min + max));
    let position: Point =
        neighbour.position_m.unwrap_or(neighbour.bearing.map(|axis| axis * middle_m)).into();
    let orientation = neighbour.orientation_xyzw.map_or_else(Quaternion::default, Quaternion::from);
    BoundingBox3D { center: Pose { position, orientation }, ..BoundingBox3D::default() }
}
