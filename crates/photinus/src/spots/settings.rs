//! What a user may choose about spots: effect, unit and default of each.

/// How a pixel is found to be bright.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Brightness {
    /// At or above a fixed value: the paper's rule, with 200. Fastest, blind to a raised background; centres are by a balanced window,
    /// with a sigma of 0.07 px, for fitting the point spread takes longer than all else.
    Threshold(u8),
    /// At least this many grey levels above the background around it, which is measured in the frame. Where noise or
    /// texture reaches further than that, the frame raises the step by itself. Default, with 20: a marker far below
    /// saturation is found, a bright sky is not.
    Contrast(u8),
}

impl Default for Brightness {
    fn default() -> Self {
        Self::Contrast(20)
    }
}

/// Noise of a pixel: variance = `read_dn`^2 + `shot` x signal + 1/12 for the rounding to whole grey levels.
///
/// The default is that of a small UV fisheye camera, from the scatter of real frames.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Noise {
    /// Noise of a dark pixel, grey levels; the frame's own background raises it where it is noisier. Default 0.45.
    pub read_dn: f64,
    /// Variance that the light adds, grey levels^2 per grey level (one over electrons per level). Default 0.03.
    pub shot: f64,
}

impl Default for Noise {
    fn default() -> Self {
        Self { read_dn: 0.45, shot: 0.03 }
    }
}

/// What a marker may look like; the rest is rejected with a reason.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Shape {
    /// Widest marker, px; a disc of this diameter bounds the area. A neighbour's LEDs at half a metre are 20 px wide,
    /// the sun in a UV camera 40 and more. Default 32.
    pub widest_px: f64,
    /// Longest over shortest axis of a marker; what is longer is a streak of specular light. Default 4.
    pub elongation: f64,
    /// About that share of the brightest spot's light at which a fainter one is as likely a reflection as a marker: fainter ones more likely
    /// are. 0: nothing reflects. Default 0.22: real glossy surfaces gave up to 0.18, real markers in one frame no less than 0.33.
    pub reflection_ratio: f64,
}

impl Default for Shape {
    fn default() -> Self {
        Self { widest_px: 32.0, elongation: 4.0, reflection_ratio: 0.22 }
    }
}

/// All that a user may choose about spots. Begin with [`Settings::default`] and change what you must.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Settings {
    /// What is bright.
    pub brightness: Brightness,
    /// Noise of a pixel, for the sigma of a centre.
    pub noise: Noise,
    /// What a marker may look like.
    pub shape: Shape,
}

/// A setting that has no meaning.
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
        let (level, name) = match self.brightness {
            Brightness::Threshold(level) => (level, "the brightness threshold"),
            Brightness::Contrast(level) => (level, "the contrast"),
        };
        let need =
            |ok: bool, name, value, must| if ok { Ok(()) } else { Err(SettingsError { name, value, must }) };
        need(level >= 1, name, f64::from(level), "1 to 255")?;
        need(
            (0.0..=255.0).contains(&self.noise.read_dn),
            "the read noise",
            self.noise.read_dn,
            "0 to 255 grey levels",
        )?;
        need((0.0..=255.0).contains(&self.noise.shot), "the shot noise", self.noise.shot, "0 to 255")?;
        need(
            (1.0..=1000.0).contains(&self.shape.widest_px),
            "the widest marker",
            self.shape.widest_px,
            "1 to 1000 px",
        )?;
        need(
            (1.0..=1e6).contains(&self.shape.elongation),
            "the elongation",
            self.shape.elongation,
            "1 or more",
        )?;
        need(
            (0.0..=1.0).contains(&self.shape.reflection_ratio),
            "the reflection ratio",
            self.shape.reflection_ratio,
            "0 to 1",
        )
    }
}
