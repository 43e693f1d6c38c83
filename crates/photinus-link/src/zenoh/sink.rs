//! Zenoh as a sink of a run, and as what tells the run how the vehicle moves.

use photinus_io::Result;
use photinus_run::Entry;
use photinus_run::health::Health;
use photinus_run::motion::Motion;
use photinus_run::sink::Sink;

use super::{Link, Settings, ZenohError};
use crate::config::Camera;
use crate::heard::{Heard, Saying, Unreadable};
use crate::messages::{Messages, diagnostics, of_imu, of_odometry, parts};
use crate::ros::{Imu, Message, Odometry, TFMessage, Time};
use crate::sink_clock::SinkClock;
use crate::topics;

/// Messages of the vehicle's motion that may wait.
const MOST_WAITING: usize = 64;

/// Puts what a run finds.
pub struct ZenohSink {
    link: Link,
    heard: Option<Heard>,
    cameras: Vec<Camera>,
    /// How cameras sit on their vehicle. Zenoh keeps nothing for who comes later, so it is told with each health.
    mountings: TFMessage,
    clock: SinkClock,
    lost: u64,
}

impl ZenohSink {
    /// Joins the network; `cameras` are those of the run, in their order.
    ///
    /// # Errors
    /// As [`Link::open`].
    pub fn new(
        settings: &Settings,
        cameras: Vec<Camera>,
        mountings: TFMessage,
    ) -> std::result::Result<Self, ZenohError> {
        let link = Link::open(settings)?;
        Ok(Self { link, heard: None, cameras, mountings, clock: SinkClock::new(), lost: 0 })
    }

    /// Hears of the vehicle's motion on these keys (sensor_msgs/Imu, nav_msgs/Odometry); what they say goes into `motion`.
    ///
    /// # Errors
    /// As [`Link::inbox`].
    pub fn hearing(
        mut self,
        imu: Option<&str>,
        odometry: Option<&str>,
        motion: Motion,
    ) -> std::result::Result<Self, ZenohError> {
        let mut said: Vec<Saying> = Vec::new();
        if let Some(key) = imu {
            let mut inbox = self.link.inbox::<Imu>(key, MOST_WAITING)?;
            said.push(Box::new(move || {
                Some(inbox.take()?.map(|imu| Some(of_imu(&imu))).map_err(|_| Unreadable))
            }));
        }
        if let Some(key) = odometry {
            let mut inbox = self.link.inbox::<Odometry>(key, MOST_WAITING)?;
            said.push(Box::new(move || {
                Some(inbox.take()?.map(|told| Some(of_odometry(&told))).map_err(|_| Unreadable))
            }));
        }
        self.heard = Some(Heard::new(said, motion)).filter(Heard::is_wanted);
        Ok(self)
    }

    /// How many messages the network did not take.
    #[must_use]
    pub fn lost(&self) -> u64 {
        self.lost
    }

    fn tell<M: Message>(&mut self, topic: &str, message: &M) {
        self.lost += u64::from(self.link.tell(topic, message).is_err());
    }
}

impl Sink for ZenohSink {
    fn name(&self) -> String {
        "zenoh".to_owned()
    }

    fn frame(&mut self, entry: &Entry) -> Result<()> {
        if let Some(camera) = self.cameras.get(entry.camera) {
            let told = Messages::of(&entry.record, &camera.view.exposed(entry.exposure_s));
            self.tell(topics::DETECTIONS, &told.detections);
            self.tell(topics::NEIGHBOURS, &told.neighbours);
            self.tell(topics::TRACKS, &told.tracks);
            self.tell(topics::MARKERS, &told.markers);
            if !told.transforms.transforms.is_empty() {
                self.tell(topics::TRANSFORMS, &told.transforms);
            }
        }
        if let Some(heard) = &mut self.heard {
            heard.frame(entry);
            heard.hear();
        }
        Ok(())
    }

    fn health(&mut self, health: &Health) -> Result<()> {
        let mut parts = parts(health);
        parts.extend(self.heard.as_ref().map(|heard| heard.health("keys of Zenoh")));
        let now = Time::from_nanoseconds(self.clock.now_ns());
        self.tell(topics::DIAGNOSTICS, &diagnostics(&parts, now));
        if !self.mountings.transforms.is_empty() {
            let mountings = std::mem::take(&mut self.mountings);
            self.tell(topics::STATIC_TRANSFORMS, &mountings);
            self.mountings = mountings;
        }
        Ok(())
    }

    fn idle(&mut self) -> Result<()> {
        if let Some(heard) = &mut self.heard {
            heard.hear();
        }
        Ok(())
    }
}
