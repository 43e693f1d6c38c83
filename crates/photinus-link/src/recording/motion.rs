//! What others' recordings say of the vehicle's own motion: sensor_msgs/Imu and nav_msgs/Odometry come in, attitudes and rates come out.

use std::path::Path;

use nalgebra::{UnitQuaternion, Vector3};
use photinus_io::{Error, Result};

use super::Recording;
use crate::cdr;
use crate::messages::{Turning, of_imu, of_odometry};
use crate::ros::{Imu, Message, Odometry};

/// How the vehicle's body turned, by the stamps of the messages.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Motions {
    /// Rates against the world in the body frame, rad/s, in the order of time.
    pub rates: Vec<(f64, Vector3<f64>)>,
    /// Attitudes world_from_body, world with z up, in the order of time.
    pub attitudes: Vec<(f64, UnitQuaternion<f64>)>,
}

impl Motions {
    /// What the only topic of an IMU and the only one of an odometry say; of several of a kind nobody knows which is the body's, and none is
    /// taken. What the IMU does not say (an attitude, a rate) the odometry does.
    ///
    /// # Errors
    /// [`Error`] when the file cannot be read, or a message is none.
    pub fn read(path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        let imu = Self::of_topic(path, Imu::NAME, |bytes| cdr::decode(bytes).map(|imu| of_imu(&imu)))?;
        let odometry = Self::of_topic(path, Odometry::NAME, |bytes| {
            cdr::decode(bytes).map(|odometry| of_odometry(&odometry))
        })?;
        let or = |own: bool| if own { &imu } else { &odometry };
        Ok(Self {
            rates: or(!imu.rates.is_empty()).rates.clone(),
            attitudes: or(!imu.attitudes.is_empty()).attitudes.clone(),
        })
    }

    fn of_topic(
        path: &Path,
        kind: &str,
        turning: impl Fn(&[u8]) -> std::result::Result<Turning, cdr::CdrError>,
    ) -> Result<Self> {
        let recording = Recording::open(path)?;
        let topics = recording.topics();
        let mut named = topics.iter().filter(|topic| topic.kind == kind).map(|topic| topic.name.as_str());
        let (Some(topic), None) = (named.next(), named.next()) else { return Ok(Self::default()) };
        let mut messages = recording.messages([topic], 0)?;
        let mut motions = Self::default();
        while let Some(said) = messages.next(|_, bytes| turning(bytes)) {
            let said =
                said?.map_err(|error| Error::format(path, format!("a message of {topic}: {error}")))?;
            let Turning { time_s, attitude, rate_rad_s } = said;
            // What is not later than the one before says nothing new.
            if let Some(rate) = rate_rad_s.filter(|_| motions.rates.last().is_none_or(|last| last.0 < time_s))
            {
                motions.rates.push((time_s, rate));
            }
            if let Some(attitude) =
                attitude.filter(|_| motions.attitudes.last().is_none_or(|last| last.0 < time_s))
            {
                motions.attitudes.push((time_s, attitude));
            }
        }
        Ok(motions)
    }

    /// Whether nothing is said.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.rates.is_empty() && self.attitudes.is_empty()
    }
}
