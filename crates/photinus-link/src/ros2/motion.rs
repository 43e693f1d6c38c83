//! What the vehicle says of its motion on ROS 2 topics -> the run's [`Motion`], on the clock of the frames.

use photinus_run::Entry;
use photinus_run::motion::Motion;

use super::{Inbox, Node, Ros2Error};
use crate::clock_offset::ClockOffset;
use crate::messages::{Turning, of_imu, of_odometry};
use crate::ros::{Imu, Odometry};
use crate::sink_clock::SinkClock;

/// Messages that are heard in one go: a flood must not keep what is due.
const MOST_HEARD: usize = 256;

/// Topics of the vehicle's motion.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct MotionTopics {
    /// sensor_msgs/Imu, by its full name.
    pub imu: Option<String>,
    /// nav_msgs/Odometry, by its full name.
    pub odometry: Option<String>,
}

/// Hears of the vehicle's motion.
pub struct Heard {
    imu: Option<Inbox<Imu>>,
    odometry: Option<Inbox<Odometry>>,
    motion: Motion,
    clock: SinkClock,
    /// From the clock of the stamps to that of the sink.
    stamps: ClockOffset,
    /// From the clock of the frames to that of the sink.
    frames: ClockOffset,
    messages: u64,
    bad: u64,
}

impl Heard {
    /// Subscribes to the topics; what they say goes into `motion`.
    ///
    /// # Errors
    /// [`Ros2Error`] when the network refuses, or a name is none.
    pub fn new(node: &mut Node, topics: &MotionTopics, motion: Motion) -> Result<Self, Ros2Error> {
        Ok(Self {
            imu: topics.imu.as_deref().map(|topic| node.inbox(topic)).transpose()?,
            odometry: topics.odometry.as_deref().map(|topic| node.inbox(topic)).transpose()?,
            motion,
            clock: SinkClock::new(),
            stamps: ClockOffset::default(),
            frames: ClockOffset::default(),
            messages: 0,
            bad: 0,
        })
    }

    /// Whether anything is listened to.
    #[must_use]
    pub fn is_wanted(&self) -> bool {
        self.imu.is_some() || self.odometry.is_some()
    }

    /// A frame came: it tells the clock of the frames.
    pub fn frame(&mut self, entry: &Entry) {
        if let Some((time_s, taken)) = entry.record.time_s.zip(entry.taken) {
            self.frames.hear(time_s + entry.exposure_s.unwrap_or(0.0), self.clock.seconds(taken));
        }
    }

    /// Takes what came meanwhile.
    pub fn hear(&mut self) {
        for _ in 0..MOST_HEARD {
            let imu = self.imu.as_mut().and_then(Inbox::take).map(|imu| imu.map(|imu| of_imu(&imu)));
            let said =
                imu.or_else(|| Some(self.odometry.as_mut()?.take()?.map(|odometry| of_odometry(&odometry))));
            match said {
                None => return,
                Some(Ok(turning)) => self.put(&turning),
                Some(Err(_)) => self.bad += 1,
            }
        }
    }

    fn put(&mut self, turning: &Turning) {
        self.messages += 1;
        let on_sink_s = self.stamps.hear(turning.time_s, self.clock.now_s());
        let Some(frames_s) = self.frames.offset_s() else { return };
        let time_s = on_sink_s - frames_s;
        if let Some(rate_rad_s) = turning.rate_rad_s {
            self.motion.rate(time_s, rate_rad_s);
        }
        if let Some(attitude) = turning.attitude {
            self.motion.attitude(time_s, attitude);
        }
    }

    /// How it goes, by name and value: how much later the clock of the frames is than that of the stamps, and what was heard.
    #[must_use]
    pub fn told(&self) -> Vec<(String, String)> {
        let offset_s = self
            .stamps
            .offset_s()
            .zip(self.frames.offset_s())
            .map(|(stamps_s, frames_s)| stamps_s - frames_s);
        let mut told = vec![
            ("messages".to_owned(), self.messages.to_string()),
            ("unreadable".to_owned(), self.bad.to_string()),
        ];
        told.extend(
            offset_s.map(|offset_s| ("clock_offset_ms".to_owned(), format!("{:.3}", 1e3 * offset_s))),
        );
        told
    }
}
