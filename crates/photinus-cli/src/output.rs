//! Where what was found in frames goes: JSON lines, a table, pictures, lines to read. Every output is opened before any work
//! is done; one that fails is reported and left out, and the others go on.

use std::io::Write;
use std::path::{Path, PathBuf};

use photinus::camera::Camera;
use photinus_io::Result;
use photinus_io::results::{CsvWriter, ResultsWriter};

use crate::ending::Content;
use crate::failure::Failure;
use crate::number;
use crate::overlay::{Overlay, Place};
use crate::resume::Done;
use crate::targets::{FileTarget, FolderTarget, Targets, WriteArgs};
use crate::terminal::Terminal;
use photinus_run::Clock;
use photinus_run::Entry;

/// What the user says about results.
#[derive(Debug, clap::Args)]
pub(crate) struct OutputArgs {
    /// Write the results as JSON lines, a line per frame; - is standard output
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Draw what was found: a PNG per frame into this folder, which is made; into a video if it ends in .y4m; - is a video on
    /// standard output
    #[arg(long, value_name = "DIR|FILE.y4m|-")]
    overlay: Option<PathBuf>,
    /// Draw only every Nth frame
    #[arg(long, value_name = "N", requires = "overlay", default_value_t = 1, hide_default_value = true, value_parser = number::count)]
    overlay_every: u64,
    /// Go on after the last whole line that a stopped run left in --out
    #[arg(long, requires = "out", conflicts_with = "force")]
    resume: bool,
    #[command(flatten)]
    pub(crate) write: WriteArgs,
    /// Print no notes, no progress, no summary
    #[arg(short, long)]
    pub(crate) quiet: bool,
}

/// Lines to read, of what was found in a frame.
type Lines = fn(&Entry) -> Vec<String>;

/// Outputs that may be opened.
pub(crate) struct Claimed {
    out: Option<FileTarget>,
    csv: Option<FileTarget>,
    overlay: Option<PicturesTarget>,
    overlay_every: u64,
    cameras: Vec<Camera>,
    lines: Option<Lines>,
}

/// Where pictures may go.
enum PicturesTarget {
    Folder(FolderTarget),
    Video(FileTarget),
}

/// Open outputs.
pub(crate) struct Outputs {
    sinks: Vec<Sink>,
    /// Whether one was left out.
    failed: bool,
    /// The file that results grow in, where they go to one.
    results: Option<PathBuf>,
}

/// One of them.
enum Sink {
    Results(ResultsWriter<Box<dyn Write>>),
    Table(Box<CsvWriter<Box<dyn Write>>>),
    Pictures { overlay: Box<Overlay>, every: u64, seen: u64 },
    Lines(Lines),
}

impl OutputArgs {
    /// What a stopped run has done, if this one is to go on with it.
    pub(crate) fn done(&self) -> std::result::Result<Option<Done>, Failure> {
        match (&self.out, self.resume) {
            (Some(path), true) => Done::read(path),
            _ => Ok(None),
        }
    }

    /// Where the outputs may go; none of them may replace one of the files that are `read`. The input's cameras, where they are
    /// known, are for the view from above. Without --out and --csv, lines to read are printed.
    ///
    /// # Errors
    /// [`Failure`] when an output would replace something, or cannot be written.
    pub(crate) fn claim(
        &self,
        csv: Option<&Path>,
        read: &[PathBuf],
        cameras: Vec<Camera>,
        lines: Lines,
    ) -> std::result::Result<Claimed, Failure> {
        // What goes on after a stopped run writes over its files.
        let write = WriteArgs { force: self.write.force || self.resume };
        let mut targets = Targets::new(write, read.iter().cloned());
        let out = self.out.as_deref().map(|path| targets.file(path, Content::JsonLines)).transpose()?;
        let csv = csv.map(|path| targets.file(path, Content::Csv)).transpose()?;
        let overlay =
            self.overlay.as_deref().map(|path| PicturesTarget::claim(path, &mut targets)).transpose()?;
        let is_piped = matches!(&overlay, Some(PicturesTarget::Video(video)) if video.is_standard());
        let lines = (out.is_none() && csv.is_none() && !is_piped).then_some(lines);
        Ok(Claimed { out, csv, overlay, overlay_every: self.overlay_every, cameras, lines })
    }
}

impl Claimed {
    /// Opens the outputs. What is `done` stays, and they go on after it.
    ///
    /// # Errors
    /// [`photinus_io::Error`] when one cannot be opened.
    pub(crate) fn open(self, done: Option<&Done>) -> Result<Outputs> {
        let mut sinks = Vec::new();
        let results = self.out.as_ref().filter(|out| out.is_file()).map(|out| out.path().to_owned());
        if let Some(target) = self.out {
            let file = match done {
                Some(done) => Box::new(done.reopen()?),
                None => sink(&target)?,
            };
            sinks.push(Sink::Results(ResultsWriter::new(file, target.name())));
        }
        if let Some(target) = self.csv {
            let mut table = CsvWriter::new(sink(&target)?, target.name())?;
            if let Some(done) = done {
                done.records()?.try_for_each(|record| table.write(&record?))?;
            }
            sinks.push(Sink::Table(Box::new(table)));
        }
        if let Some(target) = self.overlay {
            let overlay = Box::new(Overlay::new(target.open()?, self.cameras)?);
            sinks.push(Sink::Pictures { overlay, every: self.overlay_every, seen: 0 });
        }
        sinks.extend(self.lines.map(Sink::Lines));
        Ok(Outputs { sinks, failed: false, results })
    }
}

impl Outputs {
    /// Writes a frame everywhere. An output that fails is reported and left out.
    ///
    /// # Errors
    /// [`Failure`] when no output is left.
    pub(crate) fn write(
        &mut self,
        entry: &Entry,
        clock: &mut Clock,
        terminal: &Terminal,
    ) -> std::result::Result<(), Failure> {
        let alone = self.sinks.len() == 1;
        let mut last = None;
        clock.skip();
        self.sinks.retain_mut(|sink| match sink.write(entry, terminal) {
            Ok(()) => {
                clock.lap(sink.stage());
                true
            }
            Err(error) if alone => {
                last = Some(error);
                false
            }
            Err(error) => {
                self.failed = true;
                terminal
                    .error(format_args!("{error}; nothing more is written there, the other outputs go on"));
                false
            }
        });
        match last {
            // A reader that has had enough is no failure, unless something else was lost before.
            Some(error) if self.failed => Err(Failure::Running(error.to_string())),
            Some(error) => Err(Failure::running(error)),
            None if self.sinks.is_empty() => Err(Failure::Output),
            None => Ok(()),
        }
    }

    /// Whether an output was left out.
    pub(crate) fn failed(&self) -> bool {
        self.failed
    }

    /// The file that results grow in, where they go to one.
    pub(crate) fn results(&self) -> Option<&Path> {
        self.results.as_deref()
    }
}

impl PicturesTarget {
    fn claim(path: &Path, targets: &mut Targets) -> std::result::Result<Self, Failure> {
        let is_video = path.as_os_str() == "-" || path.extension().is_some_and(|ending| ending == "y4m");
        Ok(match is_video {
            true => Self::Video(targets.file(path, Content::Y4m)?),
            false => Self::Folder(targets.folder(path)?),
        })
    }

    fn open(&self) -> Result<Place> {
        Ok(match self {
            Self::Folder(folder) => Place::folder(folder.grow()?),
            Self::Video(file) => Place::video(sink(file)?, file.name()),
        })
    }
}

impl Sink {
    /// What the clock calls the writing of it.
    fn stage(&self) -> &'static str {
        match self {
            Self::Results(_) | Self::Lines(_) => "writing",
            Self::Table(_) => "table",
            Self::Pictures { .. } => "overlay",
        }
    }

    fn write(&mut self, entry: &Entry, terminal: &Terminal) -> Result<()> {
        match self {
            Self::Results(results) => results.write(&entry.record),
            Self::Table(table) => table.write(&entry.record),
            Self::Pictures { overlay, every, seen } => {
                *seen += 1;
                if (*seen - 1) % *every != 0 {
                    return Ok(());
                }
                let image = entry.image.as_ref().map(|image| image.view());
                overlay.draw(entry.camera, &entry.record, image, entry.gravity.as_ref(), &[])
            }
            Self::Lines(lines) => lines(entry).iter().try_for_each(|line| terminal.line(line)),
        }
    }
}

/// Opens a file that grows, or standard output.
fn sink(target: &FileTarget) -> Result<Box<dyn Write>> {
    match target.is_standard() {
        true => Ok(Box::new(std::io::stdout())),
        false => Ok(Box::new(target.grow()?)),
    }
}
