//! What the user may believe of neighbours before a frame tells.

use photinus::locator::Kind;
use photinus::pose::Settings;
use photinus_io::airframe::AirframeFile;

use crate::number;

/// Priors of a neighbour's pose.
#[derive(Debug, clap::Args)]
pub(crate) struct PoseArgs {
    /// Standard deviation of a neighbour's tilt against the vertical, per axis, where gravity is known; it includes the error of
    /// gravity. It is what is believed before frames tell more
    #[arg(long, value_name = "DEG", default_value_t = 5.0, value_parser = tilt_sigma)]
    tilt_sigma: f64,
    /// Standard deviation of an LED's place about that in the airframe's file, per axis, in metres
    /// [default: that in the file, else 0.003]
    #[arg(long, value_name = "METRES", value_parser = marker_sigma)]
    marker_sigma: Option<f64>,
    /// Standard deviation of an LED's power about that in the airframe's file, as a share
    /// [default: that in the file, else 0.2]
    #[arg(long, value_name = "SHARE", value_parser = power_spread)]
    power_spread: Option<f64>,
    /// Standard deviation of the size of the whole airframe, or of the focal length, about that in the file, as a share: no picture tells
    /// it, and all distances are off by as much
    #[arg(long, value_name = "SHARE", default_value_t = 0.01, value_parser = scale_sigma)]
    scale_sigma: f64,
    /// Probability that a marker that faces the camera gives no spot, because it is dead or hidden, before the frames tell it
    #[arg(long, alias = "missed", value_name = "SHARE", default_value_t = 0.02, value_parser = miss_rate)]
    miss_rate: f64,
    /// Do not use the brightness of spots for poses: for LEDs whose power or lobes are not known
    #[arg(long)]
    no_brightness: bool,
}

impl PoseArgs {
    /// The settings of the estimator for an airframe that is known so well.
    pub(crate) fn settings(&self) -> Settings {
        let mut settings = Settings::default();
        settings.tilt_sigma_rad = self.tilt_sigma.to_radians();
        settings.marker_sigma_m = self.marker_sigma.unwrap_or(settings.marker_sigma_m);
        settings.unit_sigma = self.power_spread.unwrap_or(settings.unit_sigma);
        settings.scale_sigma = self.scale_sigma;
        settings.missed = self.miss_rate;
        settings.use_brightness = !self.no_brightness;
        settings
    }

    /// What is believed of a kind of vehicle: by the options, or else by its file.
    pub(crate) fn kind(&self, AirframeFile { airframe, tolerances, .. }: AirframeFile) -> Kind {
        let all = self.settings();
        Kind {
            airframe,
            marker_sigma_m: self.marker_sigma.or(tolerances.position_sigma_m).unwrap_or(all.marker_sigma_m),
            unit_sigma: self.power_spread.or(tolerances.power_sigma).unwrap_or(all.unit_sigma),
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
