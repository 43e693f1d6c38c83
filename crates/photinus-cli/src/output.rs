//! Where results go: JSON lines, CSV, pictures. Every one is opened before any work is done.

use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};

use photinus::camera::Camera;
use photinus_io::Error;
use photinus_io::results::{CsvWriter, ResultsWriter};

use crate::failure::Failure;
use crate::input::Entry;
use crate::overlay::Overlay;

/// What the user says about results.
#[derive(Debug, clap::Args)]
pub(crate) struct OutputArgs {
    /// Write the results as JSON lines, a line per frame; - is standard output
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Draw what was found into a PNG per frame in this folder, which is made
    #[arg(long, value_name = "DIR")]
    overlay: Option<PathBuf>,
    /// Print no notes, no progress, no summary
    #[arg(short, long)]
    pub(crate) quiet: bool,
}

/// Open outputs.
#[derive(Default)]
pub(crate) struct Outputs {
    results: Option<ResultsWriter<Box<dyn Write>>>,
    table: Option<CsvWriter<Box<dyn Write>>>,
    overlay: Option<Overlay>,
}

impl OutputArgs {
    /// Opens the outputs; none of them may replace one of the files that are `read`. The camera, where it is known,
    /// is for the view from above.
    pub(crate) fn open(
        &self,
        csv: Option<&Path>,
        read: &[PathBuf],
        camera: Option<&Camera>,
    ) -> Result<Outputs, Failure> {
        for path in self.out.as_deref().into_iter().chain(csv) {
            refuse_to_replace(path, read)?;
        }
        if self.out.as_deref().is_some_and(is_stdout) && csv.is_some_and(is_stdout) {
            let reason = "--out and --csv both write to standard output: name a file for one of them";
            return Err(Failure::Input(reason.to_owned()));
        }
        let results = match &self.out {
            None => None,
            Some(path) => {
                let (sink, name) = sink(path)?;
                Some(ResultsWriter::new(sink, name))
            }
        };
        let table = match csv {
            None => None,
            Some(path) => {
                let (sink, name) = sink(path)?;
                Some(CsvWriter::new(sink, name).map_err(Failure::input)?)
            }
        };
        let overlay = self
            .overlay
            .as_ref()
            .map(|folder| Overlay::create(folder, camera.cloned()).map_err(Failure::input))
            .transpose()?;
        Ok(Outputs { results, table, overlay })
    }

    /// Whether the lines of the result are to be read by a person on standard output.
    pub(crate) fn is_for_people(&self, csv: Option<&Path>) -> bool {
        self.out.is_none() && csv.is_none()
    }
}

impl Outputs {
    /// Writes a frame everywhere.
    pub(crate) fn write(&mut self, entry: &Entry) -> Result<(), Failure> {
        if let Some(results) = &mut self.results {
            results.write(&entry.record).map_err(Failure::running)?;
        }
        if let Some(table) = &mut self.table {
            table.write(&entry.record).map_err(Failure::running)?;
        }
        if let Some(overlay) = &self.overlay {
            let image = entry.image.as_ref().map(|image| image.view());
            overlay.draw(&entry.record, image, entry.gravity.as_ref(), &[]).map_err(Failure::running)?;
        }
        Ok(())
    }
}

fn is_stdout(path: &Path) -> bool {
    path.as_os_str() == "-"
}

/// Opens an output, with its name for the messages; `-` is standard output.
fn sink(path: &Path) -> Result<(Box<dyn Write>, &Path), Failure> {
    match is_stdout(path) {
        true => Ok((Box::new(std::io::stdout()), Path::new("standard output"))),
        false => Ok((Box::new(create(path)?), path)),
    }
}

/// Creates a file, or says why it cannot be.
pub(crate) fn create(path: &Path) -> Result<File, Failure> {
    File::create(path).map_err(|error| {
        let advice = match error.kind() {
            std::io::ErrorKind::NotFound => "make its folder first, or write elsewhere",
            std::io::ErrorKind::IsADirectory => "name a file, not a folder",
            _ => "write elsewhere, or change the permissions",
        };
        Failure::input(Error::io(path, error).advise(advice))
    })
}

/// Refuses to write to a file that is read: it would be emptied before its turn comes.
pub(crate) fn refuse_to_replace(path: &Path, read: &[PathBuf]) -> Result<(), Failure> {
    let Ok(target) = path.canonicalize() else { return Ok(()) };
    let is_target = |file: &&PathBuf| file.canonicalize().is_ok_and(|file| file == target);
    match read.iter().find(is_target) {
        None => Ok(()),
        Some(_) => Err(Failure::Input(format!(
            "{}: this file is an input, it would be replaced; write elsewhere",
            path.display()
        ))),
    }
}

/// Files of somebody else, or of another run, are left alone.
pub(crate) fn refuse_to_mix(folder: &Path) -> Result<(), Failure> {
    let is_empty = |mut entries: std::fs::ReadDir| entries.next().is_none();
    match folder.exists() && !std::fs::read_dir(folder).is_ok_and(is_empty) {
        false => Ok(()),
        true => Err(Failure::Input(format!(
            "{}: it is there already; remove it, or name another folder with --out",
            folder.display()
        ))),
    }
}
