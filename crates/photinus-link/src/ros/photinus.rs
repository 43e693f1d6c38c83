//! photinus_msgs: the package `ros/photinus_msgs` says what each field means.

use serde::{Deserialize, Serialize};

use super::{Header, Matrix3, PoseWithCovariance, Vector3};

/// photinus_msgs/PoseMode.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "the fields are those of the ROS definition")]
pub struct PoseMode {
    pub weight: f64,
    pub pose: PoseWithCovariance,
}

/// photinus_msgs/Neighbour.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "the fields are those of the ROS definition")]
pub struct Neighbour {
    pub id: String,
    pub id_probability: f64,
    pub track: u64,
    pub airframe: String,
    pub probability: f64,
    pub predicted: bool,
    pub bearing: Vector3,
    pub bearing_covariance: Matrix3,
    pub distance: f64,
    pub distance_sigma: f64,
    pub distance_min: f64,
    pub distance_max: f64,
    pub pose: PoseWithCovariance,
    pub velocity: Vector3,
    pub velocity_covariance: Matrix3,
    pub misfit_chi2: f64,
    pub misfit_dof: u32,
    pub misfit_p: f64,
    pub modes: Vec<PoseMode>,
}

/// photinus_msgs/NeighbourArray.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "the fields are those of the ROS definition")]
pub struct NeighbourArray {
    pub header: Header,
    pub camera: String,
    pub frame: u64,
    pub latency: f64,
    pub incomplete: bool,
    pub neighbours: Vec<Neighbour>,
}

/// photinus_msgs/Frame.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "the fields are those of the ROS definition")]
pub struct Frame {
    pub header: Header,
    pub camera: String,
    pub frame: u64,
    pub time: f64,
    pub exposure: f64,
    pub source: String,
    pub gravity: Vec<f64>,
    pub turned: Vec<f64>,
    pub moving: Vec<f64>,
    pub order: Vec<u64>,
    pub turned_since_any: Vec<f64>,
}
