//! Flights: one, or one for each of many seeds, shared out among threads.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc;

use photinus_io::{Error, Result};

use crate::metrics::{Metrics, Tally};
use crate::perception::{Grade, StandInTable};
use crate::scenario::Scenario;
use crate::world::World;

/// What is to be flown.
#[derive(Clone, Debug)]
pub struct Run {
    /// The scenario.
    pub scenario: Arc<Scenario>,
    /// Where it came from, for messages.
    pub path: PathBuf,
    /// How vehicles see.
    pub grade: Grade,
    /// What stands in for frames.
    pub table: Arc<StandInTable>,
}

/// How far it is.
#[derive(Clone, Debug)]
pub enum Progress {
    /// A frame of some flight is done.
    Frame,
    /// A flight is over.
    Flight(Box<Metrics>),
}

impl Run {
    /// With the table that the program carries.
    pub fn new(scenario: Scenario, path: impl Into<PathBuf>, grade: Grade) -> Self {
        let table = Arc::new(StandInTable::carried());
        Self { scenario: Arc::new(scenario), path: path.into(), grade, table }
    }

    /// Flies under the scenario's own seed, with eyes shared out among `threads`; `watch` is shown the world at every frame, after everybody looked and
    /// decided, and stops the flight by its error.
    ///
    /// # Errors
    /// That of `watch`; [`Error`] where vehicles do not fit, a locator refuses its settings, or a vehicle's state is no longer finite.
    pub fn fly(&self, threads: usize, mut watch: impl FnMut(&World) -> Result<()>) -> Result<Metrics> {
        let scenario = Arc::clone(&self.scenario);
        let mut world = World::new(scenario, self.grade, &self.table, threads, &self.path)?;
        let mut tally = Tally::new(&world);
        for frame in 0..self.scenario.frames() {
            world.look();
            tally.take(&world);
            watch(&world)?;
            world.pass(&mut |touch| tally.near(&touch));
            if let Some(lost) = world.robots().iter().position(|robot| !robot.state.is_finite()) {
                let reason = format!("after frame {frame} nobody can say where vehicle {lost} is");
                return Err(Error::format(&self.path, reason).advise("please report it with the scenario"));
            }
        }
        Ok(tally.metrics(&world))
    }

    /// The same under another seed.
    #[must_use]
    pub fn with_seed(&self, seed: u64) -> Self {
        let scenario = Scenario { seed, ..(*self.scenario).clone() };
        Self { scenario: Arc::new(scenario), ..self.clone() }
    }

    /// Flies under `seeds` seeds from the scenario's own on, on this many threads; the numbers of each flight, in the order of seeds. `tell` hears of every
    /// frame and flight, and stops everything by answering no.
    ///
    /// # Errors
    /// The first of [`Run::fly`].
    pub fn monte_carlo(
        &self,
        seeds: usize,
        threads: usize,
        mut tell: impl FnMut(Progress) -> bool,
    ) -> Result<Vec<Metrics>> {
        let next = AtomicUsize::new(0);
        let stopped = AtomicBool::new(false);
        let (sender, receiver) = mpsc::channel();
        let mut flights: Vec<Option<Metrics>> = vec![None; seeds];
        let mut failed = None;
        std::thread::scope(|scope| {
            for _ in 0..threads.clamp(1, seeds.max(1)) {
                let (sender, next, stopped) = (sender.clone(), &next, &stopped);
                scope.spawn(move || {
                    loop {
                        let index = next.fetch_add(1, Ordering::Relaxed);
                        if index >= seeds || stopped.load(Ordering::Relaxed) {
                            return;
                        }
                        let run = self.with_seed(self.scenario.seed + index as u64);
                        let flown = run.fly(1, |_| {
                            // nobody listens any more only when all is over
                            let _ = sender.send((index, None));
                            if stopped.load(Ordering::Relaxed) { Err(stop(&self.path)) } else { Ok(()) }
                        });
                        let _ = sender.send((index, Some(flown)));
                    }
                });
            }
            drop(sender);
            for (index, news) in receiver {
                let goes_on = match news {
                    None => tell(Progress::Frame),
                    Some(Ok(metrics)) => {
                        flights[index] = Some(metrics.clone());
                        tell(Progress::Flight(Box::new(metrics)))
                    }
                    Some(Err(error)) => {
                        if failed.is_none() && !stopped.load(Ordering::Relaxed) {
                            failed = Some(error);
                        }
                        false
                    }
                };
                if !goes_on {
                    stopped.store(true, Ordering::Relaxed);
                }
            }
        });
        match failed {
            Some(error) => Err(error),
            None => Ok(flights.into_iter().flatten().collect()),
        }
    }
}

/// The error of a flight that nobody waits for any more.
fn stop(path: &Path) -> Error {
    Error::format(path, "stopped")
}
