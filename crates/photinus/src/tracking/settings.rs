//! How vehicles move, hide and appear: what is believed of them between frames.

use crate::pose::SettingsError;

/// Priors of a tracker. docs/tracking.md has the reason of each. Begin with [`Settings::default`] and change what you must.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Settings {
    /// White acceleration of a vehicle relative to the camera, root of its spectral density, m/s^2 per sqrt(Hz). Default 3: rms 3 m/s^2 (1 g is three
    /// sigma) that lasts half a second, sqrt(2 * 0.5 s) * 3 m/s^2.
    pub acceleration: f64,
    /// Velocity of a vehicle that is seen for the first time, standard deviation per axis, m/s. Default 5.
    pub velocity_sigma_m_s: f64,
    /// Time after which a tilt is another one, s. Its sigma is that of the pose's settings. Default 0.5.
    pub tilt_time_s: f64,
    /// How fast a vehicle turns about the vertical, standard deviation, rad/s. Default 0.6: brisk turns of 1.5 rad/s, and long times of none.
    pub yaw_rate_sigma_rad_s: f64,
    /// After so long it turns otherwise, s. Default 1.
    pub yaw_rate_time_s: f64,
    /// How fast the camera turns where nobody tells, standard deviation per axis, rad/s. Default 0.35.
    pub turn_sigma_rad_s: f64,
    /// Errors of markers, lobes and LED powers last for so long, s, until another side shows: frames in between tell the same error again. Default 0.5.
    pub correlation_s: f64,
    /// How often a vehicle in view gets hidden, 1/s. Default 0.05.
    pub hiding_per_s: f64,
    /// How long it then is hidden on average, s. Default 2.
    pub hidden_s: f64,
    /// A vehicle that was not seen for longer is given up, s. Default 3.
    pub coast_s: f64,
    /// Tracks less likely to exist than this are not told, 0 to 1. Default 0.5.
    pub min_existence: f64,
    /// How spots are given to vehicles.
    pub association: Association,
    /// Which of the kinds that the locator looks for is followed: the others' spots are clutter to it. Default 0, the first.
    pub kind: usize,
}

/// How spots are given to vehicles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Association {
    /// All ways that share no spot, each with its probability.
    Joint,
    /// The likeliest way of the likeliest vehicle, then that of the next: what most trackers do, to compare with.
    Nearest,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            acceleration: 3.0,
            velocity_sigma_m_s: 5.0,
            tilt_time_s: 0.5,
            yaw_rate_sigma_rad_s: 0.6,
            yaw_rate_time_s: 1.0,
            turn_sigma_rad_s: 0.35,
            correlation_s: 0.5,
            hiding_per_s: 0.05,
            hidden_s: 2.0,
            coast_s: 3.0,
            min_existence: 0.5,
            association: Association::Joint,
            kind: 0,
        }
    }
}

impl Settings {
    /// Checks every number.
    ///
    /// # Errors
    /// [`SettingsError`] names the first setting that has no meaning.
    pub fn check(&self) -> Result<(), SettingsError> {
        let positive = [
            ("the acceleration", self.acceleration),
            ("the first velocity's sigma", self.velocity_sigma_m_s),
            ("the time of a tilt", self.tilt_time_s),
            ("the yaw rate's sigma", self.yaw_rate_sigma_rad_s),
            ("the time of a yaw rate", self.yaw_rate_time_s),
            ("the camera's turn rate", self.turn_sigma_rad_s),
            ("the time over which errors last", self.correlation_s),
            ("how often vehicles get hidden", self.hiding_per_s),
            ("how long vehicles are hidden", self.hidden_s),
            ("how long tracks coast", self.coast_s),
        ];
        for (name, value) in positive {
            if !(1e-3..=1e3).contains(&value) {
                return Err(SettingsError { name, value, must: "0.001 to 1000" });
            }
        }
        if !(0.0..=1.0).contains(&self.min_existence) {
            let (name, value) = ("the least existence", self.min_existence);
            return Err(SettingsError { name, value, must: "0 to 1" });
        }
        Ok(())
    }
}
