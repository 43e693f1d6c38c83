//! `[ros2]`: topics of ROS 2.

use photinus_io::{Error, Result};
use photinus_run::sink::Sink;
use serde::Deserialize;

use super::{BASE, Camera};

/// `[ros2]`.
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
    /// A frame of tf with z up: how `base_frame` is turned against it tells the attitude.
    pub world_frame: Option<String>,
    /// `uvdar`: the topics and messages of UVDAR's own stack, too.
    pub compat: Option<Compat>,
}

/// Whose topics are published beside our own.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Compat {
    /// Those of UVDAR's own stack on ROS 2.
    Uvdar,
}

impl Ros2 {
    /// Joins the domain; what is heard of the vehicle's motion goes into `motion`, and `draw` draws pictures for who subscribes to them.
    ///
    /// # Errors
    /// When the network refuses, or a name is none.
    pub fn open(
        &self,
        cameras: &[Camera],
        motion: photinus_run::motion::Motion,
        draw: crate::ros2::Draw,
    ) -> Result<Vec<Box<dyn Sink>>> {
        use crate::ros2::{MotionTopics, Ros2Sink};
        let base = self.base_frame.as_deref().unwrap_or(BASE);
        let tf = self.world_frame.clone().map(|world| [world, base.to_owned()]);
        let topics = MotionTopics { imu: self.imu.clone(), odometry: self.odometry.clone(), tf };
        let sink = Ros2Sink::new(self.settings(), cameras.to_vec());
        let sink = sink.and_then(|sink| match self.compat {
            Some(Compat::Uvdar) => sink.beside_uvdar(),
            None => Ok(sink),
        });
        let mut sink = sink.and_then(|sink| sink.hearing(&topics, motion)).map_err(refuse)?;
        let mounted = cameras.iter().filter_map(|camera| Some((camera.view.header(None), camera.mounting?)));
        sink.topics().tell_mountings(base, &mounted.collect::<Vec<_>>());
        let overlay = sink.overlay(draw).map_err(refuse)?;
        Ok(vec![Box::new(sink), Box::new(overlay)])
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

fn refuse(error: crate::ros2::Ros2Error) -> Error {
    Error::format("[ros2]", error.to_string())
}
