//! Messages of ROS 2 as plain structs: their fields, in their order, and nothing more.
//!
//! In: numbers and texts. Out: structs whose serde form, encoded by [`cdr`](crate::cdr), is what every ROS 2 program reads. The definitions
//! are those of ROS 2 Jazzy and vision_msgs 4, and of the package `ros/photinus_msgs` of this repository; [`schema`] tells them.

mod basic;
mod definitions;
mod detection;
mod diagnostic;
mod marker;
mod odometry;
mod photinus;
mod pose;
mod sensor;
mod uvdar;

pub use basic::{
    Header, Matrix3, Matrix6, Point, Pose, PoseWithCovariance, Quaternion, TFMessage, Text, Time, Transform,
    TransformStamped, Vector3,
};
pub use definitions::schema;
pub use detection::{
    BoundingBox3D, Detection3D, Detection3DArray, ObjectHypothesis, ObjectHypothesisWithPose,
};
pub use diagnostic::{DiagnosticArray, DiagnosticStatus, KeyValue, Level};
pub use marker::{ColorRGBA, Marker, MarkerArray, MeshFile, Shape, UVCoordinate};
pub use odometry::{Odometry, Twist, TwistWithCovariance};
pub use photinus::{Frame, Neighbour, NeighbourArray, PoseMode};
pub use pose::{PoseStamped, PoseWithCovarianceStamped};
pub use sensor::{CameraInfo, CompressedImage, Image, Imu, RegionOfInterest};

pub use uvdar::{
    BearingObservation, BearingObservationArrayStamped, ImagePointsWithCovariancesStamped,
    Point2DWithCovariance, PoseWithCovarianceArrayStamped, PoseWithCovarianceIdentified,
};

/// A message that a topic can carry.
pub trait Message: serde::Serialize {
    /// `package/Name`, without the `msg` between them.
    const NAME: &'static str;
}

macro_rules! messages {
    ($($name:literal: $kind:ty),* $(,)?) => {
        $(impl Message for $kind {
            const NAME: &'static str = $name;
        })*
    };
}

messages! {
    "std_msgs/String": Text,
    "tf2_msgs/TFMessage": TFMessage,
    "geometry_msgs/PoseStamped": PoseStamped,
    "geometry_msgs/PoseWithCovarianceStamped": PoseWithCovarianceStamped,
    "geometry_msgs/TransformStamped": TransformStamped,
    "vision_msgs/Detection3DArray": Detection3DArray,
    "visualization_msgs/MarkerArray": MarkerArray,
    "diagnostic_msgs/DiagnosticArray": DiagnosticArray,
    "sensor_msgs/Image": Image<'_>,
    "sensor_msgs/CompressedImage": CompressedImage<'_>,
    "sensor_msgs/CameraInfo": CameraInfo,
    "sensor_msgs/Imu": Imu,
    "nav_msgs/Odometry": Odometry,
    "uvdar_core/ImagePointsWithCovariancesStamped": ImagePointsWithCovariancesStamped,
    "uvdar_core/PoseWithCovarianceArrayStamped": PoseWithCovarianceArrayStamped,
    "uvdar_core/BearingObservationArrayStamped": BearingObservationArrayStamped,
    "photinus_msgs/NeighbourArray": NeighbourArray,
    "photinus_msgs/Frame": Frame,
}
