//! The folder of one flight: truth, every vehicle's results, metrics, the page.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

use photinus_io::whole::WholeFolder;
use photinus_io::{Error, Result};
use photinus_swarm::{Metrics, Scenario, World, record};
use serde::Serialize;

use super::page;
use super::page::Film;
use crate::failure::Failure;
use crate::targets::FolderTarget;

/// Lines are written no more often than this, per second, and of large groups less often.
const LINES_HZ: f64 = 20.0;
/// Vehicles whose lines are written that often; of more, in proportion less often.
const FEW: usize = 10;

/// A folder in the making.
pub(super) struct Folder {
    making: WholeFolder,
    truth: Writer,
    vehicles: Vec<Writer>,
    film: Film,
    every: u64,
    frame: u64,
}

/// A file of lines.
struct Writer {
    file: BufWriter<File>,
    path: PathBuf,
}

impl Writer {
    fn create(path: PathBuf) -> Result<Self> {
        let file = File::create(&path).map_err(|error| Error::io(&path, error))?;
        Ok(Self { file: BufWriter::new(file), path })
    }

    fn line(&mut self, value: &impl Serialize) -> Result<()> {
        let text = json(value, &self.path)?;
        writeln!(self.file, "{text}").map_err(|error| Error::io(&self.path, error))
    }

    fn finish(mut self) -> Result<()> {
        self.file.flush().map_err(|error| Error::io(&self.path, error))
    }
}

impl Folder {
    pub(super) fn create(target: &FolderTarget, scenario: &Scenario) -> std::result::Result<Self, Failure> {
        let making = target.whole().map_err(Failure::input)?;
        let made = || -> Result<(Writer, Vec<Writer>)> {
            let folder = making.path().join("vehicles");
            std::fs::create_dir(&folder).map_err(|error| Error::io(&folder, error))?;
            let truth = Writer::create(making.path().join("truth.jsonl"))?;
            let writer = |index| Writer::create(folder.join(format!("{index:03}.jsonl")));
            Ok((truth, (0..scenario.vehicles.len()).map(writer).collect::<Result<_>>()?))
        };
        let (truth, vehicles) = made().map_err(|error| Failure::running(making.tell(error)))?;
        let crowd = (scenario.vehicles.len() as f64 / FEW as f64).max(1.0);
        let every = (scenario.rate_hz / LINES_HZ * crowd).ceil().max(1.0) as u64;
        Ok(Self { truth, vehicles, film: Film::new(scenario), every, frame: 0, making })
    }

    /// Takes a frame.
    pub(super) fn take(&mut self, world: &World) -> Result<()> {
        let time_s = world.time_s();
        if self.frame.is_multiple_of(self.every) {
            self.truth.line(&record::truth(world, time_s)).map_err(|error| self.making.tell(error))?;
            for (index, writer) in self.vehicles.iter_mut().enumerate() {
                writer.line(&record::line(world, index, time_s)).map_err(|error| self.making.tell(error))?;
            }
        }
        self.film.take(world, self.frame);
        self.frame += 1;
        Ok(())
    }

    /// Writes what comes last and gives the folder its name.
    pub(super) fn keep(self, scenario: &Scenario, metrics: &Metrics) -> std::result::Result<(), Failure> {
        let Self { making, truth, vehicles, film, .. } = self;
        let finish = || -> Result<()> {
            truth.finish()?;
            vehicles.into_iter().try_for_each(Writer::finish)?;
            write_json(&making.path().join("metrics.json"), metrics)?;
            page::flight(scenario, metrics, &film)?.write(making.path())
        };
        finish().map_err(|error| Failure::running(making.tell(error)))?;
        making.keep().map_err(Failure::running)
    }
}

/// Writes a value as JSON to read.
pub(super) fn write_json(path: &Path, value: &impl Serialize) -> Result<()> {
    let text = serde_json::to_string_pretty(value).map_err(|error| Error::format(path, error.to_string()))?;
    std::fs::write(path, text + "\n").map_err(|error| Error::io(path, error))
}

fn json(value: &impl Serialize, path: &Path) -> Result<String> {
    serde_json::to_string(value).map_err(|error| Error::format(path, error.to_string()))
}
