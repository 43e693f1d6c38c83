//! An autopilot as a sink of a run, and as what tells the run how the vehicle moves.

use photinus_io::Result;
use photinus_run::Entry;
use photinus_run::motion::Motion;
use photinus_run::sink::Sink;

use super::{Autopilot, Heard};
use crate::clock_offset::ClockOffset;
use crate::sink_clock::SinkClock;

/// Messages that are heard in one go.
const MOST_HEARD: usize = 64;

/// Tells an autopilot what a run finds.
pub struct AutopilotSink {
    autopilot: Autopilot,
    clock: SinkClock,
    motion: Motion,
    /// From the clock of the frames to that of the sink.
    frames: ClockOffset,
}

impl AutopilotSink {
    /// What the autopilot says of its motion goes into `motion`, on the clock of the frames. `open` gets the time of the sink's clock, s, and makes the link with every camera of the run, in their order.
    ///
    /// # Errors
    /// That of `open`.
    pub fn new(
        motion: Motion,
        open: impl FnOnce(f64) -> std::io::Result<Autopilot>,
    ) -> std::io::Result<Self> {
        let clock = SinkClock::new();
        Ok(Self { autopilot: open(clock.now_s())?, clock, motion, frames: ClockOffset::default() })
    }

    /// What the autopilot said meanwhile, and what is due to it.
    fn turn(&mut self) {
        let now_s = self.clock.now_s();
        // A flood must not keep what is due.
        for _ in 0..MOST_HEARD {
            let Some(heard) = self.autopilot.hear(now_s) else { break };
            let Some(offset_s) = self.frames.offset_s() else { continue };
            match heard {
                Heard::Attitude(heard) => self.motion.attitude(heard.time_s - offset_s, heard.enu_from_body),
                Heard::Turn(heard) => self.motion.rate(heard.time_s - offset_s, heard.turn_rad_s),
                Heard::Speed(heard) => self.motion.velocity(heard.time_s - offset_s, heard.velocity),
                Heard::Own(_) => {}
            }
        }
        self.autopilot.tick(now_s);
    }
}

impl Sink for AutopilotSink {
    fn name(&self) -> String {
        "mavlink".to_owned()
    }

    fn frame(&mut self, entry: &Entry) -> Result<()> {
        let now_s = self.clock.now_s();
        if let Some((time_s, taken)) = entry.record.time_s.zip(entry.taken) {
            self.frames.hear(time_s + entry.exposure_s.unwrap_or(0.0), self.clock.seconds(taken));
        }
        let exposed_s = entry.taken.map_or(now_s, |taken| self.clock.seconds(taken));
        self.autopilot.located(entry.camera, &entry.record, exposed_s, now_s);
        self.turn();
        Ok(())
    }

    fn idle(&mut self) -> Result<()> {
        self.turn();
        Ok(())
    }
}
