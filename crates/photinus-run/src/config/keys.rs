//! What the file may hold, table by table: what stands here is read, all else is refused.

use std::net::SocketAddr;
use std::path::PathBuf;

use photinus_io::dataset::AirframeFiles;
use photinus_io::video::RawFormat;
use serde::Deserialize;
use toml::value::Datetime;

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Keys {
    #[serde(default)]
    pub(super) pace: PaceKey,
    #[serde(default)]
    pub(super) camera: Vec<CameraKeys>,
    pub(super) airframe: Option<AirframeKeys>,
    pub(super) vehicles: Option<VehiclesKeys>,
    #[serde(default)]
    pub(super) locate: LocateKeys,
    pub(super) sky: Option<SkyKeys>,
    pub(super) exposure: Option<ExposureKeys>,
    pub(super) json: Option<JsonKeys>,
    pub(super) health: Option<HealthKeys>,
    pub(super) page: Option<PageKeys>,
    pub(super) record: Option<toml::Table>,
    pub(super) ros2: Option<toml::Table>,
    pub(super) mavlink: Option<toml::Table>,
    pub(super) zenoh: Option<toml::Table>,
}

#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum PaceKey {
    #[default]
    Live,
    Fast,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct CameraKeys {
    pub(super) name: String,
    pub(super) source: SourceKeys,
    pub(super) camera: Option<PathBuf>,
    pub(super) mounting: Option<PathBuf>,
    pub(super) mask: Option<PathBuf>,
    pub(super) spot_curve: Option<PathBuf>,
    pub(super) exposure_us: Option<f64>,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SourceKeys {
    pub(super) dataset: Option<PathBuf>,
    /// What a run recorded.
    pub(super) recording: Option<PathBuf>,
    /// What the simulator renders while it runs.
    pub(super) scene: Option<PathBuf>,
    /// Which camera of a dataset, a recording or a scene with several.
    pub(super) camera: Option<String>,
    #[serde(default)]
    pub(super) repeat: bool,
    pub(super) command: Option<Vec<String>>,
    pub(super) stdin: Option<bool>,
    pub(super) tcp: Option<String>,
    pub(super) unix: Option<PathBuf>,
    pub(super) raw: Option<RawKeys>,
    pub(super) times: Option<TimesKey>,
    /// Lines of spots come in place of frames.
    #[serde(default)]
    pub(super) spots: bool,
    /// A topic of ROS 2.
    pub(super) ros2: Option<String>,
    /// A key of Zenoh.
    pub(super) zenoh: Option<String>,
    pub(super) v4l2: Option<PathBuf>,
    /// How a V4L2 camera lays out its pixels.
    pub(super) format: Option<String>,
    pub(super) rate_hz: Option<f64>,
    pub(super) gain: Option<i64>,
}

impl SourceKeys {
    /// Whether messages of others are taken.
    pub(super) fn is_topic(&self) -> bool {
        self.ros2.is_some() || self.zenoh.is_some()
    }
}

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawKeys {
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) rate_hz: Option<f64>,
}

impl From<RawKeys> for RawFormat {
    fn from(keys: RawKeys) -> Self {
        Self { width: keys.width, height: keys.height, rate_hz: keys.rate_hz }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum TimesKey {
    Arrival,
    Stream,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct AirframeKeys {
    pub(super) file: AirframeFiles,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct VehiclesKeys {
    pub(super) file: PathBuf,
    pub(super) codes: Option<PathBuf>,
}

#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct LocateKeys {
    pub(super) contrast: Option<u8>,
    pub(super) threshold: Option<u8>,
    pub(super) reflection_ratio: Option<f64>,
    pub(super) max_tilt_deg: Option<f64>,
    pub(super) min_probability: Option<f64>,
    pub(super) budget: Option<u32>,
    pub(super) tilt_sigma_deg: Option<f64>,
    pub(super) marker_sigma_m: Option<f64>,
    pub(super) power_spread: Option<f64>,
    pub(super) scale_sigma: Option<f64>,
    pub(super) miss_rate: Option<f64>,
    pub(super) brightness: Option<bool>,
    pub(super) time: Option<bool>,
    pub(super) gravity: Option<[f64; 3]>,
}

/// As `[sky]` of dataset.toml, but that times of frames are seconds since 1970 where nothing else is said.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SkyKeys {
    pub(super) latitude_deg: f64,
    pub(super) longitude_deg: f64,
    #[serde(default)]
    pub(super) height_m: f64,
    pub(super) time: Option<Datetime>,
    pub(super) heading_deg: Option<f64>,
    pub(super) heading_sigma_deg: Option<f64>,
}

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ExposureKeys {
    pub(super) reach_m: f64,
    pub(super) shortest_us: f64,
    pub(super) longest_us: f64,
    #[serde(default)]
    pub(super) alternate: bool,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct JsonKeys {
    pub(super) file: Option<PathBuf>,
    #[serde(default)]
    pub(super) stdout: bool,
    pub(super) tcp: Option<SocketAddr>,
    pub(super) unix: Option<PathBuf>,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct HealthKeys {
    pub(super) file: PathBuf,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct PageKeys {
    pub(super) listen: SocketAddr,
    pub(super) token: Option<String>,
}
