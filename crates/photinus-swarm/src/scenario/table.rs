//! The scenario file as it stands.

use std::path::PathBuf;

use serde::Deserialize;

use crate::mind::guard::SafetyTable;
use crate::mind::table::MindTable;
use crate::perception::Grade;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ScenarioTable {
    pub(super) name: String,
    #[serde(default)]
    pub(super) about: String,
    #[serde(default)]
    pub(super) seed: u64,
    pub(super) duration_s: f64,
    pub(super) rate_hz: f64,
    #[serde(default = "usual_exposure")]
    pub(super) exposure_us: f64,
    #[serde(default)]
    pub(super) preset: PresetName,
    pub(super) perception: Grade,
    #[serde(default = "usual_range")]
    pub(super) range_m: f64,
    pub(super) daylight: Option<DaylightTable>,
    #[serde(default)]
    pub(super) wind: WindTable,
    #[serde(default)]
    pub(super) instruments: InstrumentsTable,
    pub(super) codes: Option<CodesTable>,
    #[serde(default)]
    pub(super) kind: Vec<KindTable>,
    #[serde(default)]
    pub(super) group: Vec<GroupTable>,
    #[serde(default)]
    pub(super) obstacle: Vec<ObstacleTable>,
    #[serde(default)]
    pub(super) event: Vec<EventTable>,
    #[serde(default)]
    pub(super) formation_m: Vec<[f64; 3]>,
}

fn usual_exposure() -> f64 {
    1000.0
}

fn usual_range() -> f64 {
    30.0
}

#[derive(Clone, Copy, Default, Deserialize)]
pub(super) enum PresetName {
    #[default]
    #[serde(rename = "bluefox-dsl215-bp365")]
    Bluefox,
    #[serde(rename = "small-fisheye-960x600")]
    SmallFisheye,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct DaylightTable {
    pub(super) sky: SkyName,
    pub(super) sun_azimuth_deg: f64,
    pub(super) sun_elevation_deg: f64,
}

#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum SkyName {
    Clear,
    Overcast,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(super) struct WindTable {
    pub(super) mean_m_s: [f64; 3],
    pub(super) gust_m_s: f64,
    pub(super) gust_s: f64,
    pub(super) common: f64,
}

impl Default for WindTable {
    fn default() -> Self {
        Self { mean_m_s: [0.0; 3], gust_m_s: 0.0, gust_s: 2.0, common: 0.5 }
    }
}

#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct InstrumentsTable {
    pub(super) tilt_bias_deg: Option<f64>,
    pub(super) tilt_noise_deg: Option<f64>,
    pub(super) heading_bias_deg: Option<f64>,
    pub(super) gyro_bias_rad_s: Option<f64>,
    pub(super) gyro_noise_rad_s: Option<f64>,
    pub(super) velocity_bias_m_s: Option<f64>,
    pub(super) velocity_noise_m_s: Option<f64>,
    pub(super) height_noise_m: Option<f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct CodesTable {
    pub(super) file: PathBuf,
    pub(super) rate_hz: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct KindTable {
    pub(super) name: String,
    pub(super) airframe: PathBuf,
    pub(super) expects: Option<PathBuf>,
    #[serde(default)]
    pub(super) camera: Vec<CameraTable>,
    #[serde(default)]
    pub(super) body: BodyTable,
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
}

#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct BodyTable {
    pub(super) mass_kg: Option<f64>,
    pub(super) thrust_n: Option<f64>,
    pub(super) tilt_deg: Option<f64>,
    pub(super) turn_deg_s: Option<f64>,
    pub(super) speed_m_s: Option<f64>,
    pub(super) drag_n_s_m: Option<f64>,
    pub(super) drag_n_s2_m2: Option<f64>,
    pub(super) radius_m: Option<f64>,
    pub(super) hub_radius_m: Option<f64>,
    pub(super) hub_half_height_m: Option<f64>,
    pub(super) thrust_lag_s: Option<f64>,
    pub(super) turn_lag_s: Option<f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct GroupTable {
    pub(super) kind: String,
    pub(super) count: usize,
    pub(super) place: PlaceTable,
    #[serde(default)]
    pub(super) jitter_m: f64,
    pub(super) controller: MindTable,
    pub(super) height_m: Option<f64>,
    pub(super) safety: Option<SafetyTable>,
}

#[derive(Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub(super) enum PlaceTable {
    At {
        positions_m: Vec<[f64; 3]>,
        #[serde(default)]
        headings_deg: Vec<f64>,
    },
    Ring {
        centre_m: [f64; 3],
        radius_m: f64,
        facing: FacingName,
    },
    Grid {
        centre_m: [f64; 3],
        spacing_m: f64,
        #[serde(default)]
        heading_deg: f64,
    },
    Random {
        centre_m: [f64; 3],
        half_m: [f64; 3],
        apart_m: f64,
        heading_deg: Option<f64>,
    },
}

#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum FacingName {
    Inwards,
    Outwards,
    Along,
}

#[derive(Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub(super) enum ObstacleTable {
    Ball { centre_m: [f64; 3], radius_m: f64 },
    Pillar { foot_m: [f64; 3], height_m: f64, radius_m: f64 },
    Bar { from_m: [f64; 3], to_m: [f64; 3], radius_m: f64 },
    Gate { centre_m: [f64; 3], width_m: f64, height_m: f64, radius_m: f64 },
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct EventTable {
    pub(super) at_s: f64,
    pub(super) exposure_us: Option<f64>,
    pub(super) vehicle: Option<usize>,
    pub(super) led_fails: Option<usize>,
    pub(super) camera_fails: Option<String>,
    pub(super) controller: Option<MindTable>,
}
