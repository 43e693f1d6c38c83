//! The definitions of messages as ROS writes them, so that a recording tells by itself what it holds.

use std::collections::BTreeSet;

/// Name of a type and its definition. Those of photinus_msgs are the files of its ROS package.
#[rustfmt::skip]
const DEFINITIONS: &[(&str, &str)] = &[
    ("builtin_interfaces/Duration", include_str!("../../definitions/builtin_interfaces/Duration.msg")),
    ("builtin_interfaces/Time", include_str!("../../definitions/builtin_interfaces/Time.msg")),
    ("diagnostic_msgs/DiagnosticArray", include_str!("../../definitions/diagnostic_msgs/DiagnosticArray.msg")),
    ("diagnostic_msgs/DiagnosticStatus", include_str!("../../definitions/diagnostic_msgs/DiagnosticStatus.msg")),
    ("diagnostic_msgs/KeyValue", include_str!("../../definitions/diagnostic_msgs/KeyValue.msg")),
    ("geometry_msgs/Point", include_str!("../../definitions/geometry_msgs/Point.msg")),
    ("geometry_msgs/Pose", include_str!("../../definitions/geometry_msgs/Pose.msg")),
    ("geometry_msgs/PoseStamped", include_str!("../../definitions/geometry_msgs/PoseStamped.msg")),
    ("geometry_msgs/PoseWithCovariance", include_str!("../../definitions/geometry_msgs/PoseWithCovariance.msg")),
    ("geometry_msgs/PoseWithCovarianceStamped", include_str!("../../definitions/geometry_msgs/PoseWithCovarianceStamped.msg")),
    ("geometry_msgs/Quaternion", include_str!("../../definitions/geometry_msgs/Quaternion.msg")),
    ("geometry_msgs/Transform", include_str!("../../definitions/geometry_msgs/Transform.msg")),
    ("geometry_msgs/TransformStamped", include_str!("../../definitions/geometry_msgs/TransformStamped.msg")),
    ("geometry_msgs/Twist", include_str!("../../definitions/geometry_msgs/Twist.msg")),
    ("geometry_msgs/TwistWithCovariance", include_str!("../../definitions/geometry_msgs/TwistWithCovariance.msg")),
    ("geometry_msgs/Vector3", include_str!("../../definitions/geometry_msgs/Vector3.msg")),
    ("nav_msgs/Odometry", include_str!("../../definitions/nav_msgs/Odometry.msg")),
    ("photinus_msgs/Frame", include_str!("../../definitions/photinus_msgs/Frame.msg")),
    ("photinus_msgs/Neighbour", include_str!("../../definitions/photinus_msgs/Neighbour.msg")),
    ("photinus_msgs/NeighbourArray", include_str!("../../definitions/photinus_msgs/NeighbourArray.msg")),
    ("photinus_msgs/PoseMode", include_str!("../../definitions/photinus_msgs/PoseMode.msg")),
    ("sensor_msgs/CameraInfo", include_str!("../../definitions/sensor_msgs/CameraInfo.msg")),
    ("sensor_msgs/CompressedImage", include_str!("../../definitions/sensor_msgs/CompressedImage.msg")),
    ("sensor_msgs/Image", include_str!("../../definitions/sensor_msgs/Image.msg")),
    ("sensor_msgs/Imu", include_str!("../../definitions/sensor_msgs/Imu.msg")),
    ("sensor_msgs/RegionOfInterest", include_str!("../../definitions/sensor_msgs/RegionOfInterest.msg")),
    ("std_msgs/ColorRGBA", include_str!("../../definitions/std_msgs/ColorRGBA.msg")),
    ("std_msgs/Header", include_str!("../../definitions/std_msgs/Header.msg")),
    ("std_msgs/String", include_str!("../../definitions/std_msgs/String.msg")),
    ("tf2_msgs/TFMessage", include_str!("../../definitions/tf2_msgs/TFMessage.msg")),
    ("uvdar_core/BearingObservation", include_str!("../../definitions/uvdar_core/BearingObservation.msg")),
    ("uvdar_core/BearingObservationArrayStamped", include_str!("../../definitions/uvdar_core/BearingObservationArrayStamped.msg")),
    ("uvdar_core/ImagePointsWithCovariancesStamped", include_str!("../../definitions/uvdar_core/ImagePointsWithCovariancesStamped.msg")),
    ("uvdar_core/Point2DWithCovariance", include_str!("../../definitions/uvdar_core/Point2DWithCovariance.msg")),
    ("uvdar_core/PoseWithCovarianceArrayStamped", include_str!("../../definitions/uvdar_core/PoseWithCovarianceArrayStamped.msg")),
    ("uvdar_core/PoseWithCovarianceIdentified", include_str!("../../definitions/uvdar_core/PoseWithCovarianceIdentified.msg")),
    ("vision_msgs/BoundingBox3D", include_str!("../../definitions/vision_msgs/BoundingBox3D.msg")),
    ("vision_msgs/Detection3D", include_str!("../../definitions/vision_msgs/Detection3D.msg")),
    ("vision_msgs/Detection3DArray", include_str!("../../definitions/vision_msgs/Detection3DArray.msg")),
    ("vision_msgs/ObjectHypothesis", include_str!("../../definitions/vision_msgs/ObjectHypothesis.msg")),
    ("vision_msgs/ObjectHypothesisWithPose", include_str!("../../definitions/vision_msgs/ObjectHypothesisWithPose.msg")),
    ("visualization_msgs/Marker", include_str!("../../definitions/visualization_msgs/Marker.msg")),
    ("visualization_msgs/MarkerArray", include_str!("../../definitions/visualization_msgs/MarkerArray.msg")),
    ("visualization_msgs/MeshFile", include_str!("../../definitions/visualization_msgs/MeshFile.msg")),
    ("visualization_msgs/UVCoordinate", include_str!("../../definitions/visualization_msgs/UVCoordinate.msg")),
];

/// Between the definitions of one schema, as rosbag2 writes it.
const RULE: &str = "================================================================================";

/// The definition of a type (`package/Name`) followed by those of all types in it: a schema of encoding `ros2msg`. `None` for an
/// unknown type.
#[must_use]
pub fn schema(name: &str) -> Option<String> {
    let mut text = definition(name)?.to_owned();
    let mut waiting = parts(name);
    let mut done = BTreeSet::from([name.to_owned()]);
    while !waiting.is_empty() {
        let part = waiting.remove(0);
        if done.insert(part.clone()) {
            text.push_str(&format!("{RULE}\nMSG: {part}\n{}", definition(&part)?));
            waiting.extend(parts(&part));
        }
    }
    Some(text)
}

fn definition(name: &str) -> Option<&'static str> {
    DEFINITIONS.iter().find(|known| known.0 == name).map(|known| known.1)
}

/// The types of the fields of a type, in their order, those that are no numbers and strings.
fn parts(name: &str) -> Vec<String> {
    let package = name.split('/').next().unwrap_or_default();
    let of_line = |line: &str| {
        let kind = line.split('#').next()?.split_whitespace().next()?.split('[').next()?;
        if kind.contains('/') {
            return Some(kind.to_owned());
        }
        kind.starts_with(char::is_uppercase).then(|| format!("{package}/{kind}"))
    };
    definition(name).unwrap_or_default().lines().filter_map(of_line).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_schema_holds_every_type_in_it_once() {
        for (name, _) in DEFINITIONS {
            let schema = schema(name).unwrap_or_else(|| panic!("{name} names a type that nobody defines"));
            let told: Vec<&str> = schema.lines().filter_map(|line| line.strip_prefix("MSG: ")).collect();
            let once: BTreeSet<&str> = told.iter().copied().collect();
            assert_eq!(once.len(), told.len(), "{name}");
            assert!(!once.contains(name));
        }
        let neighbours = schema("photinus_msgs/NeighbourArray").unwrap();
        for part in ["photinus_msgs/Neighbour", "photinus_msgs/PoseMode", "geometry_msgs/Quaternion"] {
            assert!(neighbours.contains(&format!("MSG: {part}\n")), "{part}");
        }
        assert_eq!(schema("std_msgs/Nothing"), None);
    }
}
