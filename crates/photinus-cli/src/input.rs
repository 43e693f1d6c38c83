//! Where frames come from: enters what stands on the command line, leaves one stream of [`Entry`]s.

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use nalgebra::{Unit, Vector3};
use photinus_io::dataset::Dataset;
use photinus_io::frames::{Frame, FrameSource};
use photinus_io::image::{Conversion, GreyImage};
use photinus_io::results::{FrameRecord, ResultsReader};
use photinus_io::video::RawFormat;
use photinus_io::{Error, Result};

use crate::failure::Failure;
use crate::kind::{Kind, kind_of};
use crate::terminal::input_name;

/// What the user says about frames.
#[derive(Debug, clap::Args)]
pub(crate) struct InputArgs {
    /// A dataset folder, image files, a Y4M video, or - for Y4M on standard input
    #[arg(value_name = "INPUT")]
    pub(crate) inputs: Vec<PathBuf>,
    /// The input is raw 8-bit grey frames of this size, nothing between them
    #[arg(long, value_name = "WIDTHxHEIGHT[@RATE]", value_parser = raw_format)]
    raw: Option<RawFormat>,
    /// Stop after N frames
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    frames: Option<u64>,
    /// Let a dataset name images outside of its folder
    #[arg(long)]
    allow_outside: bool,
}

/// A frame on its way to a record of results.
pub(crate) struct Entry {
    /// Number, time and source; the rest is filled in. Spots stand in it already when they came in place of pixels.
    pub(crate) record: FrameRecord,
    /// The pixels, unless spots came in their place.
    pub(crate) image: Option<GreyImage>,
    /// Direction of gravity (down) in the camera frame, where the source knows.
    pub(crate) gravity: Option<Unit<Vector3<f64>>>,
    /// What was done to the stored samples.
    pub(crate) conversions: Vec<Conversion>,
}

/// Frames ready to be read.
pub(crate) struct Input {
    /// The frames; one that cannot be read is an error in its place.
    pub(crate) entries: Entries,
    /// How many there are, where that is known beforehand.
    pub(crate) count: Option<u64>,
    /// The dataset that they are of.
    pub(crate) dataset: Option<Dataset>,
    /// The files that are read, which no output may replace.
    pub(crate) files: Vec<PathBuf>,
    /// What it is called in messages.
    pub(crate) name: String,
}

/// Frames, or spots in their place, in order.
pub(crate) struct Entries {
    source: Source,
    /// How many may still come.
    left: u64,
}

enum Source {
    Frames(FrameSource),
    Spots(ResultsReader<Box<dyn Read + Send>>),
}

impl Entries {
    /// Moves on to frame number `frame`, where that can be done without reading those before it.
    pub(crate) fn skip_to(&mut self, frame: u64) {
        if let Source::Frames(frames) = &mut self.source {
            self.left = self.left.saturating_sub(frames.skip_to(frame));
        }
    }
}

impl Iterator for Entries {
    type Item = Result<Entry>;

    fn next(&mut self) -> Option<Self::Item> {
        self.left = self.left.checked_sub(1)?;
        match &mut self.source {
            Source::Frames(frames) => Some(frames.next()?.map(Entry::from_frame)),
            Source::Spots(records) => Some(records.next()?.map(Entry::from_spots)),
        }
    }
}

impl InputArgs {
    /// All frames of these inputs.
    pub(crate) fn of(inputs: &[PathBuf], allow_outside: bool) -> Self {
        Self { inputs: inputs.to_vec(), raw: None, frames: None, allow_outside }
    }

    /// Opens the frames.
    pub(crate) fn open(&self) -> std::result::Result<Input, Failure> {
        let mut input = self.source()?;
        if let Some(limit) = self.frames {
            input.entries.left = limit;
            input.count = input.count.map(|count| count.min(limit));
        }
        Ok(input)
    }

    /// Opens spots of another program in place of frames.
    pub(crate) fn open_spots(&self, path: &Path) -> std::result::Result<Input, Failure> {
        if !self.inputs.is_empty() || self.raw.is_some() {
            return Err(Failure::Input("frames and --spots are given: keep one of them".to_owned()));
        }
        let spots = Source::Spots(ResultsReader::new(open(path)?, path));
        let mut input = Input::new(spots, None, vec![path.to_owned()], path);
        input.entries.left = self.frames.unwrap_or(u64::MAX);
        Ok(input)
    }

    fn source(&self) -> std::result::Result<Input, Failure> {
        let video = |frames: Result<FrameSource>, path: &Path| {
            let frames = Source::Frames(frames.map_err(Failure::input)?);
            Ok(Input::new(frames, None, self.inputs.clone(), path))
        };
        if let (Some(format), [path]) = (self.raw, self.inputs.as_slice()) {
            return video(FrameSource::raw(open(path)?, path, format), path);
        }
        match self.inputs.as_slice() {
            [] => Err(Failure::Input(
                "no input: name a dataset folder, image files, a Y4M video, or - for Y4M on standard input"
                    .to_owned(),
            )),
            _ if self.raw.is_some() => Err(Failure::Input(
                "--raw takes one stream: name one file, or - for standard input".to_owned(),
            )),
            [path] if path.is_dir() => self.dataset(path),
            [path] if is_video(path)? => video(FrameSource::y4m(open(path)?, path), path),
            paths => images(paths),
        }
    }

    fn dataset(&self, folder: &Path) -> std::result::Result<Input, Failure> {
        let dataset = Dataset::read(folder).map_err(Failure::input)?;
        if !self.allow_outside {
            let advice = "move it there, or allow it with --allow-outside";
            dataset.check_inside().map_err(|error| Failure::input(error.advise(advice)))?;
        }
        let frames = Source::Frames(FrameSource::dataset(dataset.clone()));
        let mut input = Input::new(frames, Some(dataset.frames().len() as u64), dataset.files(), folder);
        input.dataset = Some(dataset);
        Ok(input)
    }
}

impl Input {
    fn new(source: Source, count: Option<u64>, files: Vec<PathBuf>, name: &Path) -> Self {
        let entries = Entries { source, left: u64::MAX };
        Self { entries, count, dataset: None, files, name: input_name(name).into_owned() }
    }
}

impl Entry {
    pub(crate) fn from_frame(frame: Frame) -> Self {
        let record = FrameRecord {
            frame: Some(frame.index),
            time_s: frame.time_s,
            latency_s: None,
            source: frame.source,
            spots: Vec::new(),
            rejected: Vec::new(),
            neighbours: Vec::new(),
        };
        Self { record, image: Some(frame.image), gravity: frame.gravity, conversions: frame.conversions }
    }

    fn from_spots(record: FrameRecord) -> Self {
        let record = FrameRecord { neighbours: Vec::new(), ..record };
        Self { record, image: None, gravity: None, conversions: Vec::new() }
    }
}

/// Whether an input is a video. Standard input is taken for one, since it can be read only once.
fn is_video(path: &Path) -> std::result::Result<bool, Failure> {
    Ok(path.as_os_str() == "-" || kind_of(path).map_err(Failure::input)? == Kind::Video)
}

/// Image files: all of them must be there, whatever they hold.
fn images(paths: &[PathBuf]) -> std::result::Result<Input, Failure> {
    for path in paths {
        let refuse =
            |reason: &str, advice: &str| Err(Failure::input(Error::format(path, reason).advise(advice)));
        if path.as_os_str() == "-" {
            return refuse("a stream among several inputs", "name it alone, or image files");
        }
        match kind_of(path).map_err(Failure::input)? {
            Kind::Dataset => {
                return refuse("a folder among several inputs", "name one dataset folder, or image files");
            }
            Kind::Video => return refuse("a video among several inputs", "name one video, or image files"),
            _ => {}
        }
    }
    let count = paths.len() as u64;
    let frames = Source::Frames(FrameSource::images(paths.to_vec()));
    let name = paths.first().map_or(Path::new("no file"), PathBuf::as_path);
    Ok(Input::new(frames, Some(count), paths.to_vec(), name))
}

/// A file, or standard input for `-`.
fn open(path: &Path) -> std::result::Result<Box<dyn Read + Send>, Failure> {
    if path.as_os_str() == "-" {
        return Ok(Box::new(std::io::stdin()));
    }
    match File::open(path) {
        Ok(file) => Ok(Box::new(file)),
        Err(error) => Err(Failure::input(Error::io(path, error))),
    }
}

fn raw_format(text: &str) -> std::result::Result<RawFormat, String> {
    let wrong = || "give the size as 752x480, or with the frames per second as 752x480@60".to_owned();
    let (size, rate) = match text.split_once('@') {
        Some((size, rate)) => (size, Some(rate)),
        None => (text, None),
    };
    let (width, height) = size.split_once('x').ok_or_else(wrong)?;
    let rate_hz: Option<f64> = rate.map(|rate| rate.parse().map_err(|_| wrong())).transpose()?;
    if rate_hz.is_some_and(|rate_hz| !(rate_hz.is_finite() && rate_hz > 0.0)) {
        return Err(wrong());
    }
    Ok(RawFormat {
        width: width.parse().map_err(|_| wrong())?,
        height: height.parse().map_err(|_| wrong())?,
        rate_hz,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn raw_sizes_are_read_with_and_without_a_rate() {
        assert_eq!(
            raw_format("752x480@59.5"),
            Ok(RawFormat { width: 752, height: 480, rate_hz: Some(59.5) })
        );
        assert_eq!(raw_format("4x3"), Ok(RawFormat { width: 4, height: 3, rate_hz: None }));
        for wrong in ["752", "752x", "x480", "-1x480", "752x480@", "752x480@nan", "752x480@0", "752 x 480"] {
            assert!(raw_format(wrong).is_err(), "{wrong}");
        }
    }
}
