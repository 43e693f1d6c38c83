//! What the vehicle says of its motion in messages -> the run's [`Motion`], on the clock of the frames.

use photinus_run::Entry;
use photinus_run::motion::Motion;

use crate::clock_offset::ClockOffset;
use crate::messages::{Health, Turning};
use crate::ros::Level;
use crate::sink_clock::SinkClock;

/// Messages that are heard in one go: a flood must not keep what is due.
const MOST_HEARD: usize = 256;

/// The next message of a topic, when there is one by now: what it says of the body, if anything, or that it cannot be read.
pub type Saying = Box<dyn FnMut() -> Option<Result<Option<Turning>, Unreadable>> + Send>;

/// A message that is none of its kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Unreadable;

/// Hears of the vehicle's motion.
pub struct Heard {
    topics: Vec<Saying>,
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
    /// Listens to these topics; what they say goes into `motion`.
    #[must_use]
    pub fn new(topics: Vec<Saying>, motion: Motion) -> Self {
        Self {
            topics,
            motion,
            clock: SinkClock::new(),
            stamps: ClockOffset::default(),
            frames: ClockOffset::default(),
            messages: 0,
            bad: 0,
        }
    }

    /// Whether anything is listened to.
    #[must_use]
    pub fn is_wanted(&self) -> bool {
        !self.topics.is_empty()
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
            match self.topics.iter_mut().find_map(|topic| topic()) {
                None => return,
                Some(Ok(said)) => {
                    if let Some(turning) = said {
                        self.put(&turning);
                    }
                }
                Some(Err(Unreadable)) => self.bad += 1,
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
        if let Some(velocity) = turning.velocity {
            self.motion.velocity(time_s, velocity);
        }
    }

    /// How it goes: how much later the clock of the frames is than that of the stamps, and what was heard.
    #[must_use]
    pub fn health(&self, of: &str) -> Health {
        let offset_s = self.stamps.offset_s().zip(self.frames.offset_s());
        let mut values = vec![
            ("messages".to_owned(), self.messages.to_string()),
            ("unreadable".to_owned(), self.bad.to_string()),
        ];
        values.extend(offset_s.map(|(stamps_s, frames_s)| {
            ("clock_offset_ms".to_owned(), format!("{:.3}", 1e3 * (stamps_s - frames_s)))
        }));
        Health {
            name: "own motion".to_owned(),
            level: Level::Ok,
            message: format!("is heard on {of}"),
            values,
        }
    }
}
