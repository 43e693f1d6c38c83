//! What the user may believe of neighbours before a frame tells.

use photinus::pose::Settings;
use photinus_io::airframe::Tolerances;

use crate::number;

/// Priors of a neighbour's pose.
#[derive(Debug, clap::Args)]
pub(crate) struct PoseArgs {
    /// How far a neighbour tilts against the vertical as a rule: standard deviation per axis, where gravity is known. The
    /// error of the known gravity is part of it
    #[arg(long, value_name = "DEG", default_value_t = 5.0, value_parser = tilt_sigma)]
    tilt_sigma: f64,
    /// How far the LEDs are from where the airframe's file says: standard deviation per axis, in metres
    /// [default: what the file says of it, 0.003 where it does not]
    #[arg(long, value_name = "METRES", value_parser = marker_sigma)]
    marker_sigma: Option<f64>,
    /// How much the power of an LED differs from what the airframe's file says: standard deviation, as a share
    /// [default: what the file says of it, 0.2 where it does not]
    #[arg(long, value_name = "SHARE", value_parser = power_spread)]
    power_spread: Option<f64>,
    /// How much larger or smaller the whole airframe is than its file says, or the camera's focal length: standard deviation, as a share. No
    /// picture tells it: all distances are off by as much
    #[arg(long, value_name = "SHARE", default_value_t = 0.01, value_parser = scale_sigma)]
    scale_sigma: f64,
    /// How often a marker that must show does not, dead or hidden
    #[arg(long, alias = "missed", value_name = "SHARE", default_value_t = 0.02, value_parser = miss_rate)]
    miss_rate: f64,
    /// Leave the brightness of spots out of the pose: for LEDs whose power or lobes are not known
    #[arg(long)]
    no_brightness: bool,
}

impl PoseArgs {
    /// The settings of the estimator for an airframe that is known so well.
    pub(crate) fn settings(&self, airframe: &Tolerances) -> Settings {
        let default = Settings::default();
        Settings {
            tilt_sigma_rad: self.tilt_sigma.to_radians(),
            marker_sigma_m: self.marker_sigma.or(airframe.position_sigma_m).unwrap_or(default.marker_sigma_m),
            unit_sigma: self.power_spread.or(airframe.power_sigma).unwrap_or(default.unit_sigma),
            scale_sigma: self.scale_sigma,
            missed: self.miss_rate,
            use_brightness: !self.no_brightness,
            ..default
        }
    }
}

fn tilt_sigma(text: &str) -> Result<f64, String> {
    number::within(text, 0.01..=180.0, "degrees")
}

fn marker_sigma(text: &str) -> Result<f64, String> {
    number::within(text, 0.0..=1.0, "metres")
}

fn power_spread(text: &str) -> Result<f64, String> {
    number::within(text, 0.001..=10.0, "a share")
}

fn scale_sigma(text: &str) -> Result<f64, String> {
    number::within(text, 0.0..=1.0, "a share")
}

fn miss_rate(text: &str) -> Result<f64, String> {
    number::within(text, 1e-9..=0.5, "a share")
}
