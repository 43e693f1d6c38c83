//! How long each stage of the flow takes: laps are taken from outside, since the method has no clock.

use std::time::Instant;

use crate::quantiles::Quantiles;

/// Lap times of the stages, frame by frame.
pub struct Clock {
    last: Instant,
    stages: Vec<Stage>,
}

/// The laps of one stage.
pub struct Stage {
    /// What the stage is called.
    pub name: &'static str,
    /// Their times, ms.
    pub laps_ms: Quantiles,
}

impl Default for Clock {
    fn default() -> Self {
        Self::new()
    }
}

impl Clock {
    /// A clock that runs from now.
    pub fn new() -> Self {
        Self { last: Instant::now(), stages: Vec::new() }
    }

    /// What was done since the lap before is not part of any stage.
    pub fn skip(&mut self) {
        self.last = Instant::now();
    }

    /// The stage `name` ends now; it began where the lap before ended.
    pub fn lap(&mut self, name: &'static str) {
        let now = Instant::now();
        let lap_ms = 1e3 * (now - self.last).as_secs_f64();
        self.last = now;
        match self.stages.iter_mut().find(|stage| stage.name == name) {
            Some(stage) => stage.laps_ms.add(lap_ms),
            None => {
                let mut laps_ms = Quantiles::default();
                laps_ms.add(lap_ms);
                self.stages.push(Stage { name, laps_ms });
            }
        }
    }

    /// The stages, in the order of their first laps.
    pub fn stages(&self) -> &[Stage] {
        &self.stages
    }
}
