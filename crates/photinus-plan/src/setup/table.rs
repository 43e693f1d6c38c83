//! The set-up's file as it stands.

use std::path::PathBuf;

use serde::Deserialize;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SetupTable {
    pub(super) exposure_us: f64,
    pub(super) led: LedTable,
    pub(super) filter: FilterTable,
    pub(super) lens: LensTable,
    pub(super) sensor: SensorTable,
    pub(super) camera: Option<PathBuf>,
    pub(super) airframe: AirframeTable,
    #[serde(default)]
    pub(super) sky: SkyTable,
    #[serde(default)]
    pub(super) detector: DetectorTable,
    #[serde(default)]
    pub(super) view: ViewTable,
    #[serde(default)]
    pub(super) wanted: WantedTable,
    pub(super) battery: Option<BatteryTable>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct LedTable {
    pub(super) wavelength_nm: f64,
    pub(super) radiant_power_mw: f64,
    pub(super) rated_current_ma: f64,
    pub(super) current_ma: Option<f64>,
    pub(super) forward_v: f64,
    pub(super) lobe_power: f64,
    pub(super) face_mm: f64,
    pub(super) unit_spread: f64,
    #[serde(default = "plain_driver")]
    pub(super) driver_efficiency: f64,
}

fn plain_driver() -> f64 {
    0.85
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct FilterTable {
    pub(super) transmission: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct LensTable {
    pub(super) focal_mm: f64,
    pub(super) f_number: f64,
    pub(super) transmission: f64,
    pub(super) core_um: f64,
    pub(super) halo_um: f64,
    pub(super) halo_share: f64,
    pub(super) side_illumination: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SensorTable {
    pub(super) width_px: usize,
    pub(super) height_px: usize,
    pub(super) pixel_um: f64,
    pub(super) quantum_efficiency: f64,
    pub(super) electrons_per_dn: f64,
    pub(super) read_noise_e: f64,
    pub(super) dark_current_e_per_s: f64,
    pub(super) full_reads_dn: f64,
    pub(super) spill: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct AirframeTable {
    pub(super) ring: Option<RingTable>,
    pub(super) file: Option<PathBuf>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RingTable {
    pub(super) arms: usize,
    pub(super) radius_m: f64,
    pub(super) leds_per_arm: usize,
    pub(super) splay_deg: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(super) struct SkyTable {
    pub(super) kind: SkyName,
    pub(super) sun_deg: f64,
}

impl Default for SkyTable {
    fn default() -> Self {
        Self { kind: SkyName::Night, sun_deg: 45.0 }
    }
}

#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum SkyName {
    Night,
    Overcast,
    Clear,
}

#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(super) struct DetectorTable {
    pub(super) contrast: Option<u8>,
    pub(super) threshold: Option<u8>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(super) struct ViewTable {
    pub(super) azimuth_deg: f64,
    pub(super) elevation_deg: f64,
}

impl Default for ViewTable {
    fn default() -> Self {
        Self { azimuth_deg: 35.0, elevation_deg: 6.0 }
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct WantedTable {
    pub(super) range_m: f64,
}

impl Default for WantedTable {
    fn default() -> Self {
        Self { range_m: 10.0 }
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct BatteryTable {
    pub(super) capacity_wh: f64,
    pub(super) hover_w: f64,
}
