//! What the user may believe of neighbours before a frame tells.

use photinus::pose::Settings;

/// Priors of a neighbour's pose.
#[derive(Debug, clap::Args)]
pub(crate) struct PoseArgs {
    /// How far a neighbour tilts against the vertical as a rule: standard deviation per axis, where gravity is known. The
    /// error of the known gravity is part of it
    #[arg(long, value_name = "DEG", default_value_t = 5.0, value_parser = tilt_sigma)]
    tilt_sigma: f64,
    /// How far the LEDs are from where the airframe's file says: standard deviation per axis, in metres
    #[arg(long, value_name = "METRES", default_value_t = 0.001, value_parser = marker_sigma)]
    marker_sigma: f64,
    /// Leave the brightness of spots out of the pose: for LEDs whose power or lobes are not known
    #[arg(long)]
    no_brightness: bool,
}

impl PoseArgs {
    /// The settings of the estimator.
    pub(crate) fn settings(&self) -> Settings {
        Settings {
            tilt_sigma_rad: self.tilt_sigma.to_radians(),
            marker_sigma_m: self.marker_sigma,
            use_brightness: !self.no_brightness,
            ..Settings::default()
        }
    }
}

fn tilt_sigma(text: &str) -> Result<f64, String> {
    let degrees: Option<f64> = text.parse().ok().filter(|degrees| (0.01..=180.0).contains(degrees));
    degrees.ok_or_else(|| "give degrees, 0.01 to 180".to_owned())
}

fn marker_sigma(text: &str) -> Result<f64, String> {
    let metres: Option<f64> = text.parse().ok().filter(|metres| (0.0..=1.0).contains(metres));
    metres.ok_or_else(|| "give metres, 0 to 1".to_owned())
}
