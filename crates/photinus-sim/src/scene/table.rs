//! The scene file as it stands.

use std::path::PathBuf;

use photinus_io::sky::SkyInfo;
use serde::Deserialize;
use toml::value::Datetime;

use super::camera_table::{OpticsTable, SensorTable};
use super::light_table::{LampTable, LedsTable, LobeTable, MirrorTable, OwnTable};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SceneTable {
    pub(super) name: String,
    #[serde(default)]
    pub(super) seed: u64,
    pub(super) preset: PresetName,
    #[serde(default)]
    pub(super) optics: OpticsTable,
    #[serde(default)]
    pub(super) sensor: SensorTable,
    pub(super) rate_hz: f64,
    pub(super) duration_s: f64,
    pub(super) exposure_us: f64,
    pub(super) daylight: Option<DaylightTable>,
    pub(super) water: Option<WaterTable>,
    #[serde(default)]
    pub(super) lamp: Vec<LampTable>,
    #[serde(default)]
    pub(super) own_airframe: OwnTable,
    pub(super) observer: MoverTable,
    pub(super) camera: Vec<CameraTable>,
    pub(super) target: Vec<TargetTable>,
    pub(super) gyro: Option<GyroTable>,
    pub(super) gravity: Option<GravityTable>,
    pub(super) odometry: Option<OdometryTable>,
    pub(super) recording: Option<RecordingTable>,
}

#[derive(Clone, Copy, Deserialize)]
pub(super) enum PresetName {
    #[serde(rename = "bluefox-dsl215-bp365")]
    Bluefox,
    #[serde(rename = "small-fisheye-960x600")]
    SmallFisheye,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct DaylightTable {
    pub(super) sky: SkyName,
    pub(super) latitude_deg: f64,
    pub(super) longitude_deg: f64,
    #[serde(default)]
    pub(super) height_m: f64,
    pub(super) time: Datetime,
}

impl DaylightTable {
    /// The same as a dataset says it.
    pub(super) fn sky(&self) -> SkyInfo {
        SkyInfo {
            latitude_deg: self.latitude_deg,
            longitude_deg: self.longitude_deg,
            height_m: self.height_m,
            time: self.time,
            heading_deg: None,
            heading_sigma_deg: None,
        }
    }
}

#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum SkyName {
    Clear,
    Overcast,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct WaterTable {
    pub(super) level_m: f64,
    pub(super) wind_m_s: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct MoverTable {
    pub(super) motion: MotionTable,
    #[serde(default)]
    pub(super) wind_m_s: f64,
    #[serde(default)]
    pub(super) heading_deg: f64,
    #[serde(default)]
    pub(super) spin: Vec<SpinTable>,
}

#[derive(Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub(super) enum MotionTable {
    Hover {
        position_m: [f64; 3],
    },
    Line {
        from_m: [f64; 3],
        to_m: [f64; 3],
        duration_s: f64,
    },
    Circle {
        centre_m: [f64; 3],
        radius_m: f64,
        speed_m_s: f64,
        #[serde(default)]
        phase_deg: f64,
    },
    FigureEight {
        centre_m: [f64; 3],
        half_size_m: [f64; 2],
        period_s: f64,
    },
    Recorded {
        file: PathBuf,
    },
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SpinTable {
    pub(super) start_s: f64,
    pub(super) duration_s: f64,
    pub(super) turns: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct CameraTable {
    pub(super) name: String,
    pub(super) file: PathBuf,
    #[serde(default)]
    pub(super) position_m: [f64; 3],
    #[serde(default)]
    pub(super) yaw_deg: f64,
    #[serde(default)]
    pub(super) pitch_deg: f64,
    #[serde(default)]
    pub(super) roll_deg: f64,
    #[serde(default)]
    pub(super) clock: ClockTable,
    pub(super) exposure_us: Option<f64>,
}

#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(super) struct ClockTable {
    pub(super) offset_s: f64,
    pub(super) ppm: f64,
    pub(super) phase_s: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct GyroTable {
    pub(super) rate_hz: f64,
    #[serde(default)]
    pub(super) noise_rad_s: f64,
    #[serde(default)]
    pub(super) bias_rad_s: f64,
    #[serde(default)]
    pub(super) bias_walk_rad_s: f64,
}

#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(super) struct GravityTable {
    pub(super) noise_deg: f64,
    pub(super) bias_deg: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct OdometryTable {
    pub(super) rate_hz: f64,
    #[serde(default)]
    pub(super) place_walk_m: f64,
    #[serde(default)]
    pub(super) heading_walk_deg: f64,
    #[serde(default)]
    pub(super) tilt_noise_deg: f64,
    #[serde(default)]
    pub(super) velocity_noise_m_s: f64,
}

#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(super) struct RecordingTable {
    pub(super) lost: f64,
    pub(super) late: f64,
    pub(super) late_by_s: f64,
    pub(super) swapped: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct TargetTable {
    pub(super) id: u32,
    pub(super) airframe: PathBuf,
    pub(super) motion: MotionTable,
    #[serde(default)]
    pub(super) wind_m_s: f64,
    #[serde(default)]
    pub(super) heading_deg: f64,
    #[serde(default)]
    pub(super) spin: Vec<SpinTable>,
    #[serde(default)]
    pub(super) solid: Vec<SolidTable>,
    pub(super) lobe: Option<LobeTable>,
    #[serde(default)]
    pub(super) leds: LedsTable,
    #[serde(default)]
    pub(super) mirror: Vec<MirrorTable>,
    pub(super) blink: Option<BlinkTable>,
}

#[derive(Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub(super) enum SolidTable {
    Sphere { centre_m: [f64; 3], radius_m: f64 },
    Cylinder { centre_m: [f64; 3], radius_m: f64, half_height_m: f64 },
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct BlinkTable {
    pub(super) codes: PathBuf,
    pub(super) words: Option<Vec<usize>>,
    pub(super) first_word: Option<usize>,
    pub(super) rate_hz: f64,
    #[serde(default)]
    pub(super) shift_s: f64,
    #[serde(default)]
    pub(super) ppm: f64,
    #[serde(default)]
    pub(super) jitter_s: f64,
}
