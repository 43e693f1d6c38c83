//! What others' recordings, MCAP or bags of ROS 1, say of the vehicle's own motion: sensor_msgs/Imu and nav_msgs/Odometry come in, attitudes, rates and velocities come out.

use std::path::Path;

use nalgebra::{UnitQuaternion, Vector3};
use photinus_io::kind::Kind;
use photinus_io::{Error, Result};
use photinus_run::motion::Velocity;

use super::{Recording, Topic};
use crate::bag::{self, Bag};
use crate::cdr;
use crate::messages::{Turning, of_imu, of_odometry};
use crate::ros::{Imu, Message, Odometry};

/// How the vehicle's body turned and moved, by the stamps of the messages.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Motions {
    /// Rates against the world in the body frame, rad/s, in the order of time.
    pub rates: Vec<(f64, Vector3<f64>)>,
    /// Attitudes world_from_body, world with z up, in the order of time.
    pub attitudes: Vec<(f64, UnitQuaternion<f64>)>,
    /// Velocities over the ground in the body frame, in the order of time.
    pub velocities: Vec<(f64, Velocity)>,
}

impl Motions {
    /// What the only topic of an IMU and the only one of an odometry say; of several of a kind nobody knows which is the body's, and none is
    /// taken. What the IMU does not say (an attitude, a rate) the odometry does.
    ///
    /// # Errors
    /// [`Error`] when the file cannot be read, or a message is none.
    pub fn read(path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        let imu = Self::of_topic(
            path,
            Imu::NAME,
            |bytes| cdr::decode(bytes).ok().map(|imu| of_imu(&imu)),
            |bytes| bag::imu(bytes).map(|imu| of_imu(&imu)),
        )?;
        let odometry = Self::of_topic(
            path,
            Odometry::NAME,
            |bytes| cdr::decode(bytes).ok().map(|odometry| of_odometry(&odometry)),
            |bytes| bag::odometry(bytes).map(|odometry| of_odometry(&odometry)),
        )?;
        let or = |own: bool| if own { &imu } else { &odometry };
        Ok(Self {
            rates: or(!imu.rates.is_empty()).rates.clone(),
            attitudes: or(!imu.attitudes.is_empty()).attitudes.clone(),
            velocities: odometry.velocities.clone(),
        })
    }

    fn of_topic(
        path: &Path,
        kind: &str,
        of_cdr: impl Fn(&[u8]) -> Option<Turning>,
        of_ros1: impl Fn(&[u8]) -> Option<Turning>,
    ) -> Result<Self> {
        let mut motions = Self::default();
        let none = |topic: &str| Error::format(path, format!("a message of {topic} is no {kind}"));
        if Kind::of(path)? == Kind::Bag {
            let bag = Bag::open(path)?;
            if let Some(topic) = only(bag.topics(), kind) {
                bag.messages(&topic, |bytes| {
                    motions.put(of_ros1(bytes).ok_or_else(|| none(&topic.name))?);
                    Ok(())
                })?;
            }
            return Ok(motions);
        }
        let recording = Recording::open(path)?;
        if let Some(topic) = only(recording.topics(), kind) {
            let mut messages = recording.messages([topic.name.as_str()], 0)?;
            while let Some(said) = messages.next(|_, bytes| of_cdr(bytes)) {
                motions.put(said?.ok_or_else(|| none(&topic.name))?);
            }
        }
        Ok(motions)
    }

    /// What is not later than the one before says nothing new.
    fn put(&mut self, said: Turning) {
        let Turning { time_s, attitude, rate_rad_s, velocity } = said;
        put(&mut self.rates, time_s, rate_rad_s);
        put(&mut self.attitudes, time_s, attitude);
        put(&mut self.velocities, time_s, velocity);
    }

    /// Whether nothing is said.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.rates.is_empty() && self.attitudes.is_empty() && self.velocities.is_empty()
    }
}

fn put<T>(told: &mut Vec<(f64, T)>, time_s: f64, value: Option<T>) {
    let is_later = told.last().is_none_or(|last| last.0 < time_s);
    told.extend(value.filter(|_| is_later).map(|value| (time_s, value)));
}

/// The only topic with messages of this kind.
fn only(topics: Vec<Topic>, kind: &str) -> Option<Topic> {
    let mut of_kind = topics.into_iter().filter(|topic| topic.kind == kind);
    of_kind.next().filter(|_| of_kind.next().is_none())
}
