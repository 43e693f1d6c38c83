//! What is believed of neighbours before a frame tells.

/// Priors and tolerances of the estimator. Begin with [`Settings::default`] and change what you must.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Settings {
    /// Standard deviation of a neighbour's tilt against the vertical, per axis, with the error of the known gravity, rad.
    /// What is believed before frames tell it ([`crate::pose::Known::tilt_sigma_rad`]). Default 5 deg.
    pub tilt_sigma_rad: f64,
    /// How far markers are from where the airframe's file says, m, per axis. Default 3 mm, a hand-built airframe measured with a ruler.
    pub marker_sigma_m: f64,
    /// Share by which the whole airframe is larger or smaller than its file says, or the camera's focal length: its sigma. No picture tells it: all
    /// distances are off by it. Default 0.01, which covers 2 % either way.
    pub scale_sigma: f64,
    /// Spread of power between LEDs of one kind: sigma of its natural logarithm. Default 0.2: LEDs of one bin, drivers, dirt.
    pub unit_sigma: f64,
    /// How far an LED's intensity is from what its lobe says, 1 being one LED straight ahead: markers fainter than this
    /// decide nothing. Default 0.02: an LED mounted a degree askew.
    pub lobe_sigma: f64,
    /// How often a marker that must show does not: dead, occluded, taken for something else. It keeps alive the explanation of
    /// two spots that a marker between them is missing. What is believed before frames tell it ([`crate::pose::Visible::miss_rate`]). Default 0.02.
    pub missed: f64,
    /// Whether brightness counts. Default yes.
    pub use_brightness: bool,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            tilt_sigma_rad: 5.0 * core::f64::consts::PI / 180.0,
            marker_sigma_m: 0.003,
            scale_sigma: 0.01,
            unit_sigma: 0.2,
            lobe_sigma: 0.02,
            missed: 0.02,
            use_brightness: true,
        }
    }
}

/// A prior or tolerance that has no meaning.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{name} is {value}, it must be {must}")]
pub struct SettingsError {
    /// Which setting.
    pub name: &'static str,
    /// What was given.
    pub value: f64,
    /// What it must be.
    pub must: &'static str,
}

impl Settings {
    /// Checks every number.
    ///
    /// # Errors
    /// [`SettingsError`] names the first setting that has no meaning.
    pub fn check(&self) -> Result<(), SettingsError> {
        let need =
            |ok: bool, name, value, must| if ok { Ok(()) } else { Err(SettingsError { name, value, must }) };
        let Self { tilt_sigma_rad, marker_sigma_m, scale_sigma, unit_sigma, lobe_sigma, missed, .. } = *self;
        need(
            (1e-4..=3.2).contains(&tilt_sigma_rad),
            "the tilt's sigma",
            tilt_sigma_rad,
            "0.0001 to 3.2 rad",
        )?;
        need((0.0..=1.0).contains(&marker_sigma_m), "the markers' sigma", marker_sigma_m, "0 to 1 m")?;
        need((0.0..=1.0).contains(&scale_sigma), "the sigma of scale", scale_sigma, "0 to 1")?;
        need((1e-3..=10.0).contains(&unit_sigma), "the spread of power", unit_sigma, "0.001 to 10")?;
        need((0.0..=1.0).contains(&lobe_sigma), "the lobes' sigma", lobe_sigma, "0 to 1")?;
        need((1e-9..=0.5).contains(&missed), "the share of missed markers", missed, "1e-9 to 0.5")
    }
}
