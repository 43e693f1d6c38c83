//! Names of topics, the same in recordings and on the network.

/// vision_msgs/Detection3DArray: the one that every ROS program can use.
pub const DETECTIONS: &str = "/photinus/detections";
/// photinus_msgs/NeighbourArray, as measured.
pub const NEIGHBOURS: &str = "/photinus/neighbours";
/// photinus_msgs/NeighbourArray, as followed.
pub const TRACKS: &str = "/photinus/tracks";
/// visualization_msgs/MarkerArray.
pub const MARKERS: &str = "/photinus/markers";
/// std_msgs/String: the line of results, as `photinus locate` writes it.
pub const RESULTS: &str = "/photinus/results";
/// tf2_msgs/TFMessage.
pub const TRANSFORMS: &str = "/tf";
/// tf2_msgs/TFMessage, what never changes.
pub const STATIC_TRANSFORMS: &str = "/tf_static";
/// diagnostic_msgs/DiagnosticArray.
pub const DIAGNOSTICS: &str = "/diagnostics";

/// std_msgs/String: what a person should know.
pub const NOTICES: &str = "/photinus/notices";

/// Of one camera: `image`, `image/compressed`, `camera_info` and `frame`. Names of ROS have no hyphens.
#[must_use]
pub fn of_camera(camera: &str, what: &str) -> String {
    format!("/photinus/{}/{what}", camera.replace('-', "_"))
}
