//! The tables of a configuration file that say which links a run has: each opens a [`Sink`].
//!
//! ```text
//! [record]    file, pixels, split_mb, split_s
//! [ros2]      domain, namespace, remaps, base_frame, imu, odometry, compat
//! [mavlink]   peer, local, system, component, radius_m, reach_m, tells_free, most_hz, stale_ms
//! ```

use std::path::PathBuf;

use photinus::camera::Camera as Lens;
use photinus::frame::Mask;
use photinus_io::calibration::MountingFile;
use photinus_io::{Error, Result};
use photinus_run::sink::Sink;
use serde::Deserialize;

use crate::messages::Viewpoint;
#[cfg(feature = "recording")]
use crate::sink_clock::SinkClock;

/// A camera of the run, as links need to know it.
#[derive(Clone, Debug)]
pub struct Camera {
    /// What its messages are headed with.
    pub view: Viewpoint,
    /// What it looks through.
    pub lens: Lens,
    /// Where it does not look.
    pub mask: Option<Mask>,
    /// How it sits on its vehicle, where that is known.
    pub mounting: Option<MountingFile>,
}

/// `[record]`.
#[cfg(feature = "recording")]
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Record {
    /// The MCAP file; `{time}` in its name becomes the seconds of the epoch, so that a robot that starts again begins another one.
    pub file: PathBuf,
    /// `png` (default), `raw` or `none`.
    #[serde(default)]
    pub pixels: crate::recording::Pixels,
    /// Goes on in another file past this many MB.
    pub split_mb: Option<f64>,
    /// Goes on in another file past this many seconds.
    pub split_s: Option<f64>,
}

#[cfg(feature = "recording")]
impl Record {
    /// Begins the recording.
    ///
    /// # Errors
    /// As [`Recorder::create`](crate::recording::Recorder::create), and when a split is none.
    pub fn open(&self, cameras: &[Camera]) -> Result<Box<dyn Sink>> {
        use crate::recording::{RecordSink, Recorder, Settings, Split};
        let wrong = |split: Option<f64>| split.is_some_and(|split| !(split > 0.0 && split.is_finite()));
        if wrong(self.split_mb) || wrong(self.split_s) {
            return Err(Error::format(&self.file, "a recording is split past a size and a time above 0"));
        }
        let bytes = self.split_mb.map(|megabytes| (megabytes * 1e6) as u64);
        let split = Split { bytes, seconds: self.split_s };
        let fixed =
            (cameras.iter().any(|camera| camera.mounting.is_some())).then(|| mountings(BASE, cameras));
        let now_s = SinkClock::new().now_ns() / 1_000_000_000;
        let file = self.file.to_string_lossy().replace("{time}", &now_s.to_string());
        let recorder = Recorder::create(file, Settings { pixels: self.pixels, split }, fixed)?;
        Ok(Box::new(RecordSink::new(recorder, views(cameras))))
    }
}

/// `[ros2]`.
#[cfg(feature = "ros2")]
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Ros2 {
    /// `ROS_DOMAIN_ID`.
    pub domain: u16,
    /// Before every topic but those that ROS shares.
    pub namespace: String,
    /// Full names of topics and what they are called instead.
    pub remaps: std::collections::BTreeMap<String, String>,
    /// The vehicle's body frame in tf; `base_link` where nothing is said.
    pub base_frame: Option<String>,
    /// Topic of the vehicle's sensor_msgs/Imu, whose frame is the body's.
    pub imu: Option<String>,
    /// Topic of its nav_msgs/Odometry.
    pub odometry: Option<String>,
    /// `uvdar`: the topics and messages of UVDAR's own stack, too.
    pub compat: Option<Compat>,
}

/// Whose topics are published beside our own.
#[cfg(feature = "ros2")]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Compat {
    /// Those of UVDAR's own stack on ROS 2.
    Uvdar,
}

#[cfg(feature = "ros2")]
impl Ros2 {
    /// Joins the domain; what is heard of the vehicle's motion goes into `motion`.
    ///
    /// # Errors
    /// When the network refuses, or a name is none.
    pub fn open(&self, cameras: &[Camera], motion: photinus_run::motion::Motion) -> Result<Box<dyn Sink>> {
        use crate::ros2::{MotionTopics, Ros2Sink};
        let topics = MotionTopics { imu: self.imu.clone(), odometry: self.odometry.clone() };
        let sink = Ros2Sink::new(self.settings(), cameras.to_vec());
        let sink = sink.and_then(|sink| match self.compat {
            Some(Compat::Uvdar) => sink.beside_uvdar(),
            None => Ok(sink),
        });
        let mut sink = sink.and_then(|sink| sink.hearing(&topics, motion)).map_err(refuse)?;
        let base = self.base_frame.as_deref().unwrap_or(BASE);
        let mounted = cameras.iter().filter_map(|camera| Some((camera.view.header(None), camera.mounting?)));
        sink.topics().tell_mountings(base, &mounted.collect::<Vec<_>>());
        Ok(Box::new(sink))
    }

    /// What opens a topic with images, or with `spots` one with the points of UVDAR's detector.
    #[must_use]
    pub fn source(&self, topic: &str, spots: bool) -> photinus_run::source::Opener {
        use crate::ros2::{ImageSource, PointSource};
        use photinus_run::source::Source;
        let (settings, topic) = (self.settings(), topic.to_owned());
        Box::new(move || {
            let settings = settings.clone();
            Ok(match spots {
                false => Box::new(ImageSource::new(settings, &topic).map_err(refuse)?) as Box<dyn Source>,
                true => Box::new(PointSource::new(settings, &topic).map_err(refuse)?),
            })
        })
    }

    fn settings(&self) -> crate::ros2::Settings {
        let remaps = self.remaps.clone().into_iter().collect();
        crate::ros2::Settings { domain: self.domain, namespace: self.namespace.clone(), remaps }
    }
}

#[cfg(feature = "ros2")]
fn refuse(error: crate::ros2::Ros2Error) -> Error {
    Error::format("[ros2]", error.to_string())
}

/// `[mavlink]`.
#[cfg(feature = "mavlink")]
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Mavlink {
    /// The autopilot's address, such as `127.0.0.1:14540`.
    pub peer: String,
    /// The own address; any free port where nothing is said.
    #[serde(default = "any_port")]
    pub local: String,
    /// The vehicle that this computer is on.
    pub system: Option<u8>,
    /// This computer on it.
    pub component: Option<u8>,
    /// How far from its origin a neighbour reaches, m.
    pub radius_m: Option<f64>,
    /// Neighbours are seen up to here, m.
    pub reach_m: Option<f64>,
    /// Whether a direction in which no neighbour is seen is told as free.
    #[serde(default)]
    pub tells_free: bool,
    /// Most OBSTACLE_DISTANCE a second.
    pub most_hz: Option<f64>,
    /// An answer that is older, ms, is none.
    pub stale_ms: Option<f64>,
}

#[cfg(feature = "mavlink")]
impl Mavlink {
    /// Opens the link; what the autopilot says of its motion goes into `motion`.
    ///
    /// # Errors
    /// When an address is none, a port is taken, a number is not above 0, or a camera has no mounting.
    pub fn open(&self, cameras: &[Camera], motion: photinus_run::motion::Motion) -> Result<Box<dyn Sink>> {
        use crate::mavlink::{Autopilot, AutopilotSink, Obstacles, Outlook, Settings};
        let known = Settings::default();
        let numbers = [self.radius_m, self.reach_m, self.most_hz, self.stale_ms];
        if numbers.into_iter().flatten().any(|number| !(number > 0.0 && number.is_finite())) {
            return Err(Error::format("[mavlink]", "radius_m, reach_m, most_hz and stale_ms are above 0"));
        }
        let settings = Settings {
            system: self.system.unwrap_or(known.system),
            component: self.component.unwrap_or(known.component),
            obstacles: Obstacles {
                radius_m: self.radius_m.unwrap_or(known.obstacles.radius_m),
                reach_m: self.reach_m.unwrap_or(known.obstacles.reach_m),
                tells_free: self.tells_free,
            },
            most_hz: self.most_hz.unwrap_or(known.most_hz),
            stale_s: self.stale_ms.map_or(known.stale_s, |ms| ms * 1e-3),
        };
        if let Some(camera) = cameras.iter().find(|camera| camera.mounting.is_none()) {
            let reason = format!("how camera {} sits on the vehicle is not known", camera.view.camera);
            return Err(Error::format("[mavlink]", reason).advise("give its mounting"));
        }
        let open = |now_s: f64| {
            let mut link = Autopilot::new(self.local.as_str(), self.peer.as_str(), settings, now_s)?;
            for camera in cameras {
                let Some(mounting) = camera.mounting else { continue };
                let place = (mounting.body_from_camera, mounting.position_m.unwrap_or_default());
                let outlook = Outlook::new(&camera.lens, place, camera.mask.as_ref());
                link.camera(&camera.view.camera, outlook, place);
            }
            Ok(link)
        };
        let sink = AutopilotSink::new(motion, open).map_err(|error| Error::io("[mavlink]", error))?;
        Ok(Box::new(sink))
    }
}

/// The vehicle's body frame, by REP 105.
const BASE: &str = "base_link";

#[cfg(feature = "mavlink")]
fn any_port() -> String {
    "0.0.0.0:0".to_owned()
}

#[cfg(feature = "recording")]
fn views(cameras: &[Camera]) -> Vec<Viewpoint> {
    cameras.iter().map(|camera| camera.view.clone()).collect()
}

#[cfg(feature = "recording")]
fn mountings(base: &str, cameras: &[Camera]) -> crate::ros::TFMessage {
    let transform = |camera: &Camera| {
        crate::messages::mounting_transform(&camera.mounting?, base, &camera.view.header(None))
    };
    crate::ros::TFMessage { transforms: cameras.iter().filter_map(transform).collect() }
}
