//! `[zenoh]`: keys of Zenoh.

use photinus_io::{Error, Result};
use photinus_run::motion::Motion;
use photinus_run::sink::Sink;
use photinus_run::source::{Opener, Source};
use serde::Deserialize;

use super::{BASE, Camera, mountings};
use crate::zenoh::{KeySource, Settings, ZenohError, ZenohSink};

/// `[zenoh]`.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Zenoh {
    /// What this vehicle is called in keys.
    pub vehicle: String,
    /// Addresses such as `tcp/0.0.0.0:7447` at which others may come; any free port where nothing is said.
    pub listen: Option<Vec<String>>,
    /// Addresses of others, tried until they are there.
    #[serde(default)]
    pub connect: Vec<String>,
    /// Whether others are looked for by multicast; yes where nothing is said.
    #[serde(default = "yes")]
    pub scouting: bool,
    /// Key of the vehicle's sensor_msgs/Imu, whose frame is the body's.
    pub imu: Option<String>,
    /// Key of its nav_msgs/Odometry.
    pub odometry: Option<String>,
}

impl Zenoh {
    /// Joins the network; what is heard of the vehicle's motion goes into `motion`.
    ///
    /// # Errors
    /// When an address is none or taken, or a name cannot stand in a key.
    pub fn open(&self, cameras: &[Camera], motion: Motion) -> Result<Box<dyn Sink>> {
        let sink = ZenohSink::new(&self.settings(), cameras.to_vec(), mountings(BASE, cameras));
        let sink = sink.and_then(|sink| sink.hearing(self.imu.as_deref(), self.odometry.as_deref(), motion));
        Ok(Box::new(sink.map_err(refuse)?))
    }

    /// What opens a key with images, or with `spots` one with the points of UVDAR's detector. It listens at no address, but connects and looks for
    /// others as the table says.
    #[must_use]
    pub fn source(&self, key: &str, spots: bool) -> Opener {
        let settings = Settings { listen: Some(Vec::new()), ..self.settings() };
        let key = key.to_owned();
        Box::new(move || {
            let opened = match spots {
                false => KeySource::images(&settings, &key),
                true => KeySource::points(&settings, &key),
            };
            Ok(Box::new(opened.map_err(refuse)?) as Box<dyn Source>)
        })
    }

    fn settings(&self) -> Settings {
        Settings {
            vehicle: self.vehicle.clone(),
            listen: self.listen.clone(),
            connect: self.connect.clone(),
            scouting: self.scouting,
        }
    }
}

fn yes() -> bool {
    true
}

fn refuse(error: ZenohError) -> Error {
    Error::format("[zenoh]", error.to_string())
}
