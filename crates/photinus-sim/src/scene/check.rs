//! Numbers of a scene: each is what it must be, or its key is named.

use std::path::Path;

use nalgebra::Vector3;
use photinus_io::{Error, Place, Result, physics};

/// Checks the numbers of one file.
#[derive(Clone, Copy, Debug)]
pub struct Check<'a> {
    /// The file.
    pub path: &'a Path,
}

impl Check<'_> {
    /// The error of a key.
    pub fn refuse(&self, key: &str, reason: impl Into<String>) -> Error {
        Error::format(self.path, reason).at(Place::Key(key.to_owned()))
    }

    /// A number between two others.
    ///
    /// # Errors
    /// [`Error`] with the key and the range.
    pub fn within(&self, key: &str, value: f64, (least, most): (f64, f64)) -> Result<f64> {
        if (least..=most).contains(&value) {
            return Ok(value);
        }
        Err(self.refuse(key, format!("{value:?} is out of range")).advise(format!("give {least} to {most}")))
    }

    /// A number above 0.
    ///
    /// # Errors
    /// [`Error`] with the key and the limit.
    pub fn positive(&self, key: &str, value: f64, most: f64) -> Result<f64> {
        if value > 0.0 && value <= most {
            return Ok(value);
        }
        Err(self
            .refuse(key, format!("{value} is not a positive number"))
            .advise(format!("give up to {most}")))
    }

    /// Frames, bits or measurements per second.
    ///
    /// # Errors
    /// [`Error`] with the key and the range.
    pub fn rate(&self, key: &str, value_hz: f64) -> Result<f64> {
        physics::within(self.path, key, value_hz, &physics::RATE_HZ)
    }

    /// A share, 0 to 1.
    ///
    /// # Errors
    /// [`Error`] with the key and the range.
    pub fn share(&self, key: &str, value: f64) -> Result<f64> {
        self.within(key, value, (0.0, 1.0))
    }

    /// A place.
    ///
    /// # Errors
    /// [`Error`] with the key and the range.
    pub fn place(&self, key: &str, place_m: [f64; 3]) -> Result<Vector3<f64>> {
        for value in place_m {
            physics::within(self.path, key, value, &physics::PLACE_M)?;
        }
        Ok(Vector3::from(place_m))
    }

    /// An angle, rad from deg.
    ///
    /// # Errors
    /// [`Error`] with the key and the range.
    pub fn angle(&self, key: &str, value_deg: f64) -> Result<f64> {
        self.within(key, value_deg, (-360.0, 360.0)).map(f64::to_radians)
    }
}
