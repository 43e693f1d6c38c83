//! visualization_msgs: what RViz draws.

use serde::{Deserialize, Serialize};

use super::{CompressedImage, Header, Point, Pose, Time, Vector3};

/// `type` of visualization_msgs/Marker, those that are used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// An ellipsoid.
    Sphere = 2,
    /// A line between every two points.
    LineList = 5,
    /// Letters that look at the viewer.
    Text = 9,
}

/// std_msgs/ColorRGBA.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "the fields are those of the ROS definition")]
pub struct ColorRGBA {
    pub r: f32,
    pub g: f32,
    pub b: f32,
    pub a: f32,
}

/// visualization_msgs/UVCoordinate.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "the fields are those of the ROS definition")]
pub struct UVCoordinate {
    pub u: f32,
    pub v: f32,
}

/// visualization_msgs/MeshFile.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "the fields are those of the ROS definition")]
pub struct MeshFile {
    pub filename: String,
    pub data: Vec<u8>,
}

/// visualization_msgs/Marker.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
#[expect(missing_docs, reason = "the fields are those of the ROS definition")]
pub struct Marker {
    pub header: Header,
    pub ns: String,
    pub id: i32,
    #[serde(rename = "type")]
    pub shape: i32,
    pub action: i32,
    pub pose: Pose,
    pub scale: Vector3,
    pub color: ColorRGBA,
    pub lifetime: Time,
    pub frame_locked: bool,
    pub points: Vec<Point>,
    pub colors: Vec<ColorRGBA>,
    pub texture_resource: String,
    pub texture: CompressedImage<'static>,
    pub uv_coordinates: Vec<UVCoordinate>,
    pub text: String,
    pub mesh_resource: String,
    pub mesh_file: MeshFile,
    pub mesh_use_embedded_materials: bool,
}

impl Marker {
    /// `action`: draw it, or draw it anew.
    pub const ADD: i32 = 0;
    /// `action`: take away everything of this topic.
    pub const DELETE_ALL: i32 = 3;
}

/// visualization_msgs/MarkerArray.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
#[expect(missing_docs, reason = "the fields are those of the ROS definition")]
pub struct MarkerArray {
    pub markers: Vec<Marker>,
}
