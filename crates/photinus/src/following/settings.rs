//! What is believed of markers before anything is seen of them, each with its reason.

/// Priors of following. Begin with [`Settings::default`] and change what you must.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Settings {
    /// Standard deviation of the rate of a marker seen for the first time, each way, rad/s: 2 m/s across the view at 5 m.
    pub rate_rad_s: f64,
    /// Spectral density of a marker's acceleration, each way, rad^2/s^3: 3 m/s^2 at 6 m, kept for 0.3 s.
    pub acceleration_rad2_s3: f64,
    /// Standard deviation of the observer's own rotation about each axis where nothing tells it, rad/s: 60 deg/s.
    pub turn_rad_s: f64,
    /// By how much that changes in a second, as a standard deviation, rad/s^2: a multirotor that is flown briskly.
    pub turn_change_rad_s2: f64,
    /// How many markers come into view in a second; the other sightings that no track explains are clutter.
    pub new_per_s: f64,
    /// Probability that a marker which shines bright enough is not found all the same.
    pub missed: f64,
    /// Two markers so far apart are told apart half of the time, px.
    pub resolution_px: f64,
    /// How often a marker hides behind something, 1/s.
    pub hides_per_s: f64,
    /// How soon it comes back, 1/s.
    pub returns_per_s: f64,
    /// How soon a marker that is hidden, or beyond the border, is gone for good, 1/s.
    pub goes_per_s: f64,
    /// A marker that surely blinks what nobody knows, or nothing, is listened to anew after so long, s; never where it is infinite. While two LEDs came so near that
    /// they were one spot, their tracks heard both, and each remembers a word that nobody has.
    pub listen_anew_s: f64,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            rate_rad_s: 0.4,
            acceleration_rad2_s3: 0.15,
            turn_rad_s: 1.0,
            turn_change_rad_s2: 10.0,
            new_per_s: 2.0,
            missed: 0.01,
            resolution_px: 2.5,
            hides_per_s: 0.2,
            returns_per_s: 1.0,
            goes_per_s: 1.0,
            listen_anew_s: f64::INFINITY,
        }
    }
}

/// Settings that have no meaning.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("`{0}` must be positive and finite, and a probability below 1")]
pub struct SettingsError(pub &'static str);

impl Settings {
    /// Refuses what has no meaning.
    pub(super) fn check(&self) -> Result<(), SettingsError> {
        for (name, number, below) in [
            ("rate_rad_s", self.rate_rad_s, f64::INFINITY),
            ("acceleration_rad2_s3", self.acceleration_rad2_s3, f64::INFINITY),
            ("turn_rad_s", self.turn_rad_s, f64::INFINITY),
            ("turn_change_rad_s2", self.turn_change_rad_s2, f64::INFINITY),
            ("new_per_s", self.new_per_s, f64::INFINITY),
            ("missed", self.missed, 1.0),
            ("resolution_px", self.resolution_px, f64::INFINITY),
            ("hides_per_s", self.hides_per_s, f64::INFINITY),
            ("returns_per_s", self.returns_per_s, f64::INFINITY),
            ("goes_per_s", self.goes_per_s, f64::INFINITY),
        ] {
            if !(number > 0.0 && number < below) {
                return Err(SettingsError(name));
            }
        }
        if self.listen_anew_s.is_nan() || self.listen_anew_s <= 0.0 {
            return Err(SettingsError("listen_anew_s"));
        }
        Ok(())
    }
}
