//! How long each stage of the flow takes: laps are taken from outside, since the method has no clock.

use std::time::{Duration, Instant};

/// Lap times of the stages, frame by frame.
pub(crate) struct Clock {
    last: Instant,
    stages: Vec<Stage>,
}

/// The laps of one stage.
pub(crate) struct Stage {
    /// What the stage is called.
    pub(crate) name: &'static str,
    laps: Vec<Duration>,
}

impl Clock {
    /// A clock that runs from now.
    pub(crate) fn new() -> Self {
        Self { last: Instant::now(), stages: Vec::new() }
    }

    /// What was done since the lap before is not part of any stage.
    pub(crate) fn skip(&mut self) {
        self.last = Instant::now();
    }

    /// The stage `name` ends now; it began where the lap before ended.
    pub(crate) fn lap(&mut self, name: &'static str) {
        let now = Instant::now();
        let lap = now - self.last;
        self.last = now;
        match self.stages.iter_mut().find(|stage| stage.name == name) {
            Some(stage) => stage.laps.push(lap),
            None => self.stages.push(Stage { name, laps: vec![lap] }),
        }
    }

    /// The stages, in the order of their first laps.
    pub(crate) fn stages(&self) -> &[Stage] {
        &self.stages
    }
}

impl Stage {
    /// The lap in the middle, ms.
    pub(crate) fn median_ms(&self) -> f64 {
        let mut laps = self.laps.clone();
        laps.sort_unstable();
        laps.get(laps.len() / 2).map_or(0.0, |lap| 1e3 * lap.as_secs_f64())
    }

    /// The longest lap, ms.
    pub(crate) fn longest_ms(&self) -> f64 {
        self.laps.iter().max().map_or(0.0, |lap| 1e3 * lap.as_secs_f64())
    }
}
