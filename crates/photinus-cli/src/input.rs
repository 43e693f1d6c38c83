//! Where frames come from: enters what stands on the command line, leaves one stream of [`Entry`]s.

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use photinus_io::dataset::{Dataset, DatasetCamera};
use photinus_io::frames::FrameSource;
use photinus_io::kind::{self, Kind};
use photinus_io::results::ResultsReader;
use photinus_io::video::RawFormat;
use photinus_io::{Error, Result};
use photinus_link::bag::BagFrames;
use photinus_link::recording::Frames;
use photinus_run::Entry;

use crate::failure::Failure;
use crate::number;
use crate::terminal::input_name;

/// What the user says about frames.
#[derive(Debug, clap::Args)]
pub(crate) struct InputArgs {
    /// A dataset folder, a folder of images, image files, a Y4M video, an MCAP recording, a bag of ROS 1, or - for Y4M on standard input
    #[arg(value_name = "INPUT")]
    pub(crate) inputs: Vec<PathBuf>,
    /// The input is raw 8-bit grey frames of this size, nothing between them
    #[arg(long, value_name = "WIDTHxHEIGHT[@RATE]", value_parser = raw_format)]
    raw: Option<RawFormat>,
    /// Stop after N frames
    #[arg(long, value_name = "N", value_parser = number::count)]
    frames: Option<u64>,
    #[command(flatten)]
    dataset: DatasetArgs,
}

/// What the user says about a dataset.
#[derive(Clone, Debug, Default, clap::Args)]
pub(crate) struct DatasetArgs {
    /// Use the camera of this name only, of a dataset or recording with several
    #[arg(long, value_name = "NAME")]
    pub(crate) only: Option<String>,
    /// Allow a dataset to name images outside of its folder
    #[arg(long)]
    allow_outside: bool,
}

/// Frames ready to be read.
pub(crate) struct Input {
    /// The frames; one that cannot be read is an error in its place.
    pub(crate) entries: Entries,
    /// How many there are, where that is known beforehand.
    pub(crate) count: Option<u64>,
    /// The dataset that they are of.
    pub(crate) dataset: Option<Dataset>,
    /// The cameras of the dataset that they are of, in its order: of several cameras, frames come in the order of their times.
    pub(crate) cameras: Vec<DatasetCamera>,
    /// The files that are read, which no output may replace.
    pub(crate) files: Vec<PathBuf>,
    /// The MCAP recording that they are of.
    pub(crate) recording: Option<PathBuf>,
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
    Rig(Rig),
    Spots(ResultsReader<Box<dyn Read + Send>>),
}

/// Frames of cameras that are mounted together.
struct Rig {
    names: Vec<Option<String>>,
    frames: Vec<FrameSource>,
    /// Which camera the next frame is of.
    order: std::vec::IntoIter<usize>,
}

impl Rig {
    /// Frames of these cameras of a dataset, by their times.
    fn new(dataset: &Dataset, cameras: &[usize]) -> Self {
        let all = dataset.cameras();
        let times = |(place, &camera): (usize, &usize)| {
            all[camera].frames.iter().map(move |row| (row.time_s, place)).collect::<Vec<_>>()
        };
        let mut order: Vec<(f64, usize)> = cameras.iter().enumerate().flat_map(times).collect();
        order.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let frames = cameras.iter().map(|&camera| FrameSource::dataset_camera(dataset.clone(), camera));
        let order: Vec<usize> = order.into_iter().map(|(_, place)| place).collect();
        Self {
            names: cameras.iter().map(|&camera| all[camera].name.clone()).collect(),
            frames: frames.collect(),
            order: order.into_iter(),
        }
    }
}

impl Iterator for Rig {
    type Item = Result<Entry>;

    fn next(&mut self) -> Option<Self::Item> {
        let camera = self.order.next()?;
        Some(self.frames[camera].next()?.map(|frame| {
            let mut entry = Entry::from_frame(frame);
            entry.record.camera.clone_from(&self.names[camera]);
            Entry { camera, ..entry }
        }))
    }
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
            Source::Rig(rig) => rig.next(),
            Source::Spots(records) => Some(records.next()?.map(Entry::from_spots)),
        }
    }
}

impl InputArgs {
    /// All frames of these inputs.
    pub(crate) fn of(inputs: &[PathBuf], dataset: &DatasetArgs) -> Self {
        Self { inputs: inputs.to_vec(), raw: None, frames: None, dataset: dataset.clone() }
    }

    /// The same inputs one by one: every folder and video for itself, images together.
    ///
    /// # Errors
    /// As [`Self::open`].
    pub(crate) fn recordings(&self) -> std::result::Result<Vec<Self>, Failure> {
        let of = |inputs| self.with(inputs);
        let (mut recordings, mut images) = (Vec::new(), Vec::new());
        for path in &self.inputs {
            let is_whole = path.is_dir() || self.raw.is_some() || is_video(path)?;
            if is_whole { recordings.push(of(vec![path.clone()])) } else { images.push(path.clone()) }
        }
        if !images.is_empty() || recordings.is_empty() {
            recordings.push(of(images));
        }
        Ok(recordings)
    }

    /// One of the inputs, by itself.
    pub(crate) fn only(&self, input: &Path) -> Self {
        self.with(vec![input.to_owned()])
    }

    fn with(&self, inputs: Vec<PathBuf>) -> Self {
        Self { inputs, raw: self.raw, frames: self.frames, dataset: self.dataset.clone() }
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

    /// The images of a recording; of several cameras, those that --only names.
    fn recording(&self, path: &Path) -> std::result::Result<Input, Failure> {
        let frames = Frames::open(path, self.dataset.only.as_deref()).map_err(Failure::input)?;
        let count = frames.total();
        let frames = Source::Frames(FrameSource::other(frames));
        let input = Input::new(frames, count, self.inputs.clone(), path);
        Ok(Input { recording: Some(path.to_owned()), ..input })
    }

    /// The same of a bag of ROS 1.
    fn bag(&self, path: &Path) -> std::result::Result<Input, Failure> {
        let frames = BagFrames::open(path, self.dataset.only.as_deref()).map_err(Failure::input)?;
        let count = frames.total();
        let frames = Source::Frames(FrameSource::other(frames));
        let input = Input::new(frames, count, self.inputs.clone(), path);
        Ok(Input { recording: Some(path.to_owned()), ..input })
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
                "no input: name a dataset folder, image files or a folder of them, a Y4M video, an MCAP recording, a bag of ROS 1, or - for Y4M on standard input"
                    .to_owned(),
            )),
            _ if self.raw.is_some() => Err(Failure::Input(
                "--raw takes one stream: name one file, or - for standard input".to_owned(),
            )),
            [path] if is_stream(path) => video(FrameSource::y4m(open(path)?, path), path),
            [path] => match Kind::of(path).map_err(Failure::input)? {
                Kind::Video => video(FrameSource::y4m(open(path)?, path), path),
                Kind::ImageFolder => images(&kind::images_in(path).map_err(Failure::input)?),
                Kind::Dataset | Kind::Folder => self.dataset(path),
                Kind::Recording => self.recording(path),
                Kind::Bag => self.bag(path),
                _ => images(&self.inputs),
            },
            paths => images(paths),
        }
    }

    fn dataset(&self, folder: &Path) -> std::result::Result<Input, Failure> {
        let dataset = Dataset::read(folder).map_err(Failure::input)?;
        if !self.dataset.allow_outside {
            let advice = "move it there, or allow it with --allow-outside";
            dataset.check_inside().map_err(|error| Failure::input(error.advise(advice)))?;
        }
        let cameras = self.dataset.cameras(&dataset)?;
        let chosen: Vec<DatasetCamera> =
            cameras.iter().map(|&camera| dataset.cameras()[camera].clone()).collect();
        let count = chosen.iter().map(|camera| camera.frames.len() as u64).sum();
        let source = match chosen.as_slice() {
            [DatasetCamera { name: None, .. }] => Source::Frames(FrameSource::dataset(dataset.clone())),
            _ => Source::Rig(Rig::new(&dataset, &cameras)),
        };
        let mut input = Input::new(source, Some(count), dataset.files(), folder);
        (input.dataset, input.cameras) = (Some(dataset), chosen);
        Ok(input)
    }
}

impl DatasetArgs {
    /// The cameras that are meant, by their places in the dataset.
    ///
    /// # Errors
    /// [`Failure`] when there is none of that name.
    fn cameras(&self, dataset: &Dataset) -> std::result::Result<Vec<usize>, Failure> {
        let all = dataset.cameras();
        let Some(name) = &self.only else { return Ok((0..all.len()).collect()) };
        match all.iter().position(|camera| camera.name.as_ref() == Some(name)) {
            Some(camera) => Ok(vec![camera]),
            None => Err(Failure::Input(format!("--only {name}: the dataset has {}", names(all)))),
        }
    }
}

/// The names of cameras, in words.
pub(crate) fn names(cameras: &[DatasetCamera]) -> String {
    let names: Vec<&str> = cameras.iter().filter_map(|camera| camera.name.as_deref()).collect();
    if names.is_empty() {
        "one camera, without a name".to_owned()
    } else {
        format!("the cameras {}", names.join(", "))
    }
}

impl Input {
    /// The camera of the dataset, where there is a dataset.
    ///
    /// # Errors
    /// [`Failure`] when there are several cameras.
    pub(crate) fn one_camera(&self) -> std::result::Result<Option<&DatasetCamera>, Failure> {
        match self.cameras.as_slice() {
            [] => Ok(None),
            [camera] => Ok(Some(camera)),
            several => {
                let reason = format!("{}: it has {}; choose one with --only NAME", self.name, names(several));
                Err(Failure::Input(reason))
            }
        }
    }

    fn new(source: Source, count: Option<u64>, files: Vec<PathBuf>, name: &Path) -> Self {
        let entries = Entries { source, left: u64::MAX };
        let (cameras, name) = (Vec::new(), input_name(name).into_owned());
        Self { entries, count, dataset: None, cameras, files, recording: None, name }
    }
}

/// Whether an input is standard input, which is taken for a video, since it can be read only once.
fn is_stream(path: &Path) -> bool {
    path.as_os_str() == "-"
}

/// Whether an input is a video.
fn is_video(path: &Path) -> std::result::Result<bool, Failure> {
    Ok(is_stream(path)
        || matches!(Kind::of(path).map_err(Failure::input)?, Kind::Video | Kind::Recording | Kind::Bag))
}

/// Image files: all of them must be there, whatever they hold.
fn images(paths: &[PathBuf]) -> std::result::Result<Input, Failure> {
    for path in paths {
        let refuse =
            |reason: &str, advice: &str| Err(Failure::input(Error::format(path, reason).advise(advice)));
        if path.as_os_str() == "-" {
            return refuse("a stream among several inputs", "name it alone, or image files");
        }
        match Kind::of(path).map_err(Failure::input)? {
            Kind::Dataset | Kind::ImageFolder | Kind::Folder => {
                return refuse("a folder among several inputs", "name one folder, or image files");
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
