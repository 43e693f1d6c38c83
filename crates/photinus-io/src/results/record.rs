//! The records of the results, field by field as they stand in the file.
//!
//! Fields are added over time, never renamed; a reader ignores those that it does not know. `None` is `null`.

use serde::{Deserialize, Serialize};

use super::SpotRecord;

/// What was found in one frame.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FrameRecord {
    /// Its number; where it is missing, the number of the line, from 0.
    #[serde(default)]
    pub frame: Option<u64>,
    /// The camera's name, where there are several.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub camera: Option<String>,
    /// When it was taken, s.
    #[serde(default)]
    pub time_s: Option<f64>,
    /// From the end of the exposure until the result stood, s, where that was measured.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub latency_s: Option<f64>,
    /// The image file or stream; empty where it is missing.
    #[serde(default)]
    pub source: String,
    /// Whether the frame held more than there was work for: the likeliest was weighed, not all.
    #[serde(default, skip_serializing_if = "core::ops::Not::not")]
    pub incomplete: bool,
    /// Bright regions that may be markers.
    pub spots: Vec<SpotRecord>,
    /// Bright regions that are not markers.
    #[serde(default)]
    pub rejected: Vec<RejectedRecord>,
    /// The neighbours.
    #[serde(default)]
    pub neighbours: Vec<NeighbourRecord>,
    /// The vehicles that are followed, where frames are: also those that are not seen in this one.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub tracks: Vec<TrackRecord>,
}

/// A vehicle that is followed from frame to frame, as it is at the time of the frame: relative to the camera, in axes that do not rotate and are the
/// camera's at that time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TrackRecord {
    /// The same as long as it is followed.
    pub track: u64,
    /// Name of its airframe.
    pub airframe: String,
    /// How likely it exists, 0 to 1.
    pub probability: f64,
    /// Who it surely is, where that was decoded.
    #[serde(default)]
    pub id: Option<u32>,
    /// How likely it is who it most likely is; `None` where nobody blinks.
    #[serde(default)]
    pub id_probability: Option<f64>,
    /// Who it may be, the likeliest first; what is missing to 1 is nobody that is listed.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub ids: Vec<IdRecord>,
    /// Whether none of its LEDs was seen in this frame.
    pub predicted: bool,
    /// Indices of the spots that it was seen by.
    pub spots: Vec<usize>,
    /// Its origin, m.
    pub position_m: [f64; 3],
    /// Covariance of the position, m^2.
    pub position_covariance_m2: [[f64; 3]; 3],
    /// Its origin in the body frame of the vehicle that carries the camera, m, where the mounting is known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub position_body_m: Option<[f64; 3]>,
    /// Covariance of that position, m^2, the mounting's own errors among it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub position_body_covariance_m2: Option<[[f64; 3]; 3]>,
    /// How that changes, m/s.
    pub velocity_m_s: [f64; 3],
    /// Covariance of the velocity, m^2/s^2.
    pub velocity_covariance_m2_s2: [[f64; 3]; 3],
    /// Its attitude, camera_from_body as x, y, z, w.
    pub orientation_xyzw: [f64; 4],
    /// Covariance of the attitude as a small rotation in the body frame, rad^2.
    pub orientation_covariance_rad2: [[f64; 3]; 3],
    /// Covariance of the position (rows) with that rotation (columns), m rad.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub position_orientation_covariance_m_rad: Option<[[f64; 3]; 3]>,
}

/// Who a track may be.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct IdRecord {
    /// The vehicle.
    pub id: u32,
    /// How likely it is that one.
    pub probability: f64,
    /// Whether it would be sure if no other track blinked the same words: two carry one id, or one is followed as two.
    #[serde(default)]
    pub contested: bool,
}

/// Something bright that is not taken for a marker.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RejectedRecord {
    /// Column, px.
    pub u_px: f64,
    /// Row, px.
    pub v_px: f64,
    /// Pixels that it covers.
    pub area_px: u32,
    /// Why: `sun`, `reflection`, `mask`, `outside`, ...
    pub reason: String,
}

/// A neighbour. Vectors are in the camera frame (x right, y down, z forward).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct NeighbourRecord {
    /// The track that it belongs to, where frames are followed.
    #[serde(default)]
    pub track: Option<u64>,
    /// Who it is, where that was decoded.
    #[serde(default)]
    pub id: Option<u32>,
    /// How likely its track is who it most likely is; `None` where nobody blinks.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub id_probability: Option<f64>,
    /// The velocity of its track, m/s.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub velocity_m_s: Option<[f64; 3]>,
    /// Covariance of that, m^2/s^2.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub velocity_covariance_m2_s2: Option<[[f64; 3]; 3]>,
    /// Name of its airframe.
    pub airframe: String,
    /// How likely it is of that airframe rather than of another that is looked for; `None` where one kind is.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub airframe_probability: Option<f64>,
    /// Indices of its spots in the frame's list.
    pub spots: Vec<usize>,
    /// Unit vector towards it.
    pub bearing: [f64; 3],
    /// How far it is.
    pub distance_m: Distance,
    /// Its origin, m, where the distance has an estimate.
    #[serde(default)]
    pub position_m: Option<[f64; 3]>,
    /// Covariance of the position, m^2.
    #[serde(default)]
    pub position_covariance_m2: Option<[[f64; 3]; 3]>,
    /// Its origin in the body frame of the vehicle that carries the camera, m, where the mounting is known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub position_body_m: Option<[f64; 3]>,
    /// Covariance of that position, m^2, the mounting's own errors among it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub position_body_covariance_m2: Option<[[f64; 3]; 3]>,
    /// Its mean attitude, camera_from_body as x, y, z, w: one of those that the airframe's symmetry makes equal.
    #[serde(default)]
    pub orientation_xyzw: Option<[f64; 4]>,
    /// Covariance of the attitude as a small rotation in the body frame, the third axis yaw, rad^2.
    #[serde(default)]
    pub orientation_covariance_rad2: Option<[[f64; 3]; 3]>,
    /// Covariance of the position (rows) with that rotation (columns), m rad.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub position_orientation_covariance_m_rad: Option<[[f64; 3]; 3]>,
    /// How likely it is there at all, 0 to 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub probability: Option<f64>,
    /// How well its best pose fits.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub misfit: Option<Misfit>,
    /// The likeliest other explanation of its spots.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub runner_up: Option<RunnerUp>,
    /// Every pose that the spots allow, the likeliest first.
    #[serde(default)]
    pub modes: Vec<Mode>,
}

/// How well a pose fits.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Misfit {
    /// Sum of the squared residuals, each over its variance.
    pub chi2: f64,
    /// How many residuals are left when the pose is fitted.
    pub dof: u32,
    /// How often a right answer fits no better, 0 to 1.
    pub p: f64,
}

/// What spots may be otherwise.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct RunnerUp {
    /// How likely it is, 0 to 1.
    pub probability: f64,
    /// How far the neighbour is that they are then, m; `None` for clutter.
    pub distance_m: Option<f64>,
}

/// From the camera's centre to a neighbour's origin, m.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Distance {
    /// The likeliest; `None` where only bounds are known.
    pub estimate: Option<f64>,
    /// Its standard deviation.
    pub sigma: Option<f64>,
    /// It is never less, under the stated assumptions.
    pub min: f64,
    /// It is never more; `None` where nothing bounds it.
    pub max: Option<f64>,
    /// The paper's l_A: two markers side by side.
    pub perpendicular: Option<f64>,
    /// The paper's l_B: two markers one behind the other.
    pub inline: Option<f64>,
}

/// A pose that the spots allow.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Mode {
    /// Its share of the probability, 0 to 1.
    pub weight: f64,
    /// Origin in the camera frame, m.
    pub position_m: [f64; 3],
    /// Covariance of the position, m^2.
    pub position_covariance_m2: [[f64; 3]; 3],
    /// Attitude, camera_from_body as x, y, z, w.
    #[serde(default)]
    pub orientation_xyzw: Option<[f64; 4]>,
    /// Covariance of the attitude as a small rotation in the body frame, rad^2.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub orientation_covariance_rad2: Option<[[f64; 3]; 3]>,
    /// Covariance of the position (rows) with that rotation (columns), m rad.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub position_orientation_covariance_m_rad: Option<[[f64; 3]; 3]>,
}
