//! Frames wherever they come from: image files, a dataset folder, a Y4M or raw stream all leave as [`Frame`]s.
//!
//! A frame that cannot be read is an error in its place, and the next one follows where the source has one: a long
//! run goes on past a broken file.

use std::io::Read;
use std::path::{Path, PathBuf};

use nalgebra::{Unit, Vector3};

use photinus::tracking::{Moving, Turned};

use crate::dataset::Dataset;
use crate::image::{Conversion, GreyImage, read_image};
use crate::video::{RawFormat, RawFrames, VideoFrame, Y4mFrames};
use crate::{Place, Result};

/// A frame and what is known about it.
#[derive(Clone, Debug, PartialEq)]
pub struct Frame {
    /// The pixels.
    pub image: GreyImage,
    /// Its number in the source, from 0 unless the source numbers its frames.
    pub index: u64,
    /// When it was taken, s, where the source knows.
    pub time_s: Option<f64>,
    /// The image file as it is named, or the stream.
    pub source: String,
    /// How long it was exposed, s, where the source says it of each.
    pub exposure_s: Option<f64>,
    /// Direction of gravity (down) in the camera frame, where the source knows.
    pub gravity: Option<Unit<Vector3<f64>>>,
    /// How the camera moved, where the source knows.
    pub moved: Moved,
    /// What was done to the stored samples.
    pub conversions: Vec<Conversion>,
}

/// How a camera moved.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moved {
    /// How it turned since the frame before.
    pub turned: Option<Turned>,
    /// How fast it moves over the ground: where cameras are followed together, the vehicle that carries them.
    pub moving: Option<Moving>,
    /// Where it was followed together with other cameras of its vehicle.
    pub together: Option<Together>,
}

/// What is known of a frame that is followed together with those of other cameras.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Together {
    /// How many frames of all of them were handed in before it.
    pub order: u64,
    /// How it turned since the frame before in time, of any of them.
    pub turned: Option<Turned>,
}

/// Frames of one source, in order.
pub struct FrameSource(Kind);

type Stream = Box<dyn Read + Send>;

enum Kind {
    Images { paths: Vec<PathBuf>, next: usize },
    Dataset { dataset: Box<Dataset>, camera: usize, next: usize },
    Y4m { frames: Y4mFrames<Stream>, name: String },
    Raw { frames: RawFrames<Stream>, name: String },
    Other(Box<dyn Iterator<Item = Result<Frame>> + Send>),
}

impl FrameSource {
    /// Frames of a format that another crate reads.
    pub fn other(frames: impl Iterator<Item = Result<Frame>> + Send + 'static) -> Self {
        Self(Kind::Other(Box::new(frames)))
    }

    /// Image files, numbered as they are listed; their times are not known.
    pub fn images(paths: Vec<PathBuf>) -> Self {
        Self(Kind::Images { paths, next: 0 })
    }

    /// The images of a dataset, with its numbers, times and gravity; of several cameras, those of the first one.
    pub fn dataset(dataset: Dataset) -> Self {
        Self::dataset_camera(dataset, 0)
    }

    /// The images of camera number `camera` of a dataset; none when it has no such camera.
    pub fn dataset_camera(dataset: Dataset, camera: usize) -> Self {
        Self(Kind::Dataset { dataset: Box::new(dataset), camera, next: 0 })
    }

    /// A Y4M stream: an open file, standard input. `name` is for the messages and for [`Frame::source`].
    ///
    /// # Errors
    /// As [`Y4mFrames::new`].
    pub fn y4m(stream: impl Read + Send + 'static, name: impl AsRef<Path>) -> Result<Self> {
        let frames = Y4mFrames::new(Box::new(stream) as Stream, &name)?;
        Ok(Self(Kind::Y4m { frames, name: name.as_ref().display().to_string() }))
    }

    /// A stream of raw grey frames; `name` is for the messages and for [`Frame::source`].
    ///
    /// # Errors
    /// As [`RawFrames::new`].
    pub fn raw(
        stream: impl Read + Send + 'static,
        name: impl AsRef<Path>,
        format: RawFormat,
    ) -> Result<Self> {
        let frames = RawFrames::new(Box::new(stream) as Stream, &name, format)?;
        Ok(Self(Kind::Raw { frames, name: name.as_ref().display().to_string() }))
    }
}

impl FrameSource {
    /// Moves on to frame number `frame` without reading those before it, and says how many it passed: none in a stream, where
    /// they must be read.
    pub fn skip_to(&mut self, frame: u64) -> u64 {
        let (next, target) = match &mut self.0 {
            Kind::Images { paths, next } => {
                let target = usize::try_from(frame).unwrap_or(usize::MAX).min(paths.len());
                (next, target)
            }
            Kind::Dataset { dataset, camera, next } => {
                let rows = dataset.cameras().get(*camera).map_or(&[][..], |camera| &camera.frames);
                (next, rows.partition_point(|row| row.frame < frame))
            }
            Kind::Y4m { .. } | Kind::Raw { .. } | Kind::Other(_) => return 0,
        };
        let passed = target.saturating_sub(*next);
        *next += passed;
        passed as u64
    }
}

impl Iterator for FrameSource {
    type Item = Result<Frame>;

    fn next(&mut self) -> Option<Self::Item> {
        match &mut self.0 {
            Kind::Images { paths, next } => {
                let path = paths.get(*next)?;
                *next += 1;
                Some(from_image(path, *next as u64 - 1))
            }
            Kind::Dataset { dataset, camera, next } => {
                *next += 1;
                from_dataset(dataset, *camera, *next - 1)
            }
            Kind::Y4m { frames, name } => {
                let conversions = frames.conversions();
                Some(frames.next()?.map(|frame| from_video(frame, name, conversions)))
            }
            Kind::Raw { frames, name } => {
                Some(frames.next()?.map(|frame| from_video(frame, name, Vec::new())))
            }
            Kind::Other(frames) => frames.next(),
        }
    }
}

fn from_image(path: &Path, index: u64) -> Result<Frame> {
    let file = read_image(path)?;
    let source = path.display().to_string();
    Ok(Frame {
        image: file.image,
        index,
        time_s: None,
        source,
        gravity: None,
        exposure_s: None,
        moved: Moved::default(),
        conversions: file.conversions,
    })
}

fn from_dataset(dataset: &Dataset, camera: usize, number: usize) -> Option<Result<Frame>> {
    let camera = dataset.cameras().get(camera)?;
    let row = camera.frames.get(number)?;
    let file = read_image(dataset.path(&row.image)).map_err(|error| {
        let table = camera.frames_file.display();
        let advice = format!("line {} of {table} names it: restore it or remove that line", row.line);
        error.at(Place::Frame(row.frame)).advise(advice)
    });
    Some(file.map(|file| Frame {
        image: file.image,
        index: row.frame,
        time_s: Some(row.time_s),
        source: row.image.display().to_string(),
        gravity: row.gravity,
        exposure_s: None,
        moved: Moved::default(),
        conversions: file.conversions,
    }))
}

fn from_video(frame: VideoFrame, name: &str, conversions: Vec<Conversion>) -> Frame {
    let VideoFrame { index, time_s, image } = frame;
    Frame {
        image,
        index,
        time_s,
        source: name.to_owned(),
        gravity: None,
        exposure_s: None,
        moved: Moved::default(),
        conversions,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dataset::{DatasetInfo, DatasetWriter};
    use crate::image::write_png;
    use crate::scratch::Folder;
    use crate::video::Y4mWriter;

    fn image(seed: u8) -> GreyImage {
        GreyImage::new(vec![seed; 12], 4, 3).unwrap()
    }

    #[test]
    fn a_broken_image_is_an_error_in_its_place() {
        let folder = Folder::new("frames-images");
        let paths: Vec<_> = ["a.png", "b.png", "c.png"].iter().map(|name| folder.path().join(name)).collect();
        write_png(&paths[0], &image(1).view()).unwrap();
        folder.file("b.png", b"\x89PNG\r\n\x1a\nbroken");
        write_png(&paths[2], &image(3).view()).unwrap();
        let frames: Vec<_> = FrameSource::images(paths.clone()).collect();
        assert_eq!(frames.len(), 3);
        assert!(frames[1].as_ref().unwrap_err().to_string().contains("b.png: "));
        let last = frames[2].as_ref().unwrap();
        assert_eq!((&last.image, last.index, last.time_s), (&image(3), 2, None));
        assert_eq!(last.source, paths[2].display().to_string());
    }

    #[test]
    fn a_missing_image_of_a_dataset_names_the_line() {
        let folder = Folder::new("frames-dataset");
        let info = DatasetInfo {
            camera: "camera.txt".into(),
            airframe: "airframe.toml".into(),
            exposure_us: 1000.0,
            rate_hz: 60.0,
            spot_curve: None,
            mask: None,
            codes: None,
            vehicles: None,
            sky: None,
        };
        let mut writer = DatasetWriter::create(folder.path(), &info).unwrap();
        let down = Some(Vector3::y_axis());
        for seed in 0..3 {
            writer.frame(&image(seed).view(), f64::from(seed) / 60.0, down).unwrap();
        }
        std::fs::remove_file(folder.path().join("images/000001.png")).unwrap();
        let frames: Vec<_> = FrameSource::dataset(Dataset::read(folder.path()).unwrap()).collect();
        assert_eq!(frames.len(), 3);
        let message = frames[1].as_ref().unwrap_err().to_string();
        assert!(message.contains("000001.png, frame 1: "), "{message}");
        assert!(
            message.ends_with("; line 3 of frames.csv names it: restore it or remove that line"),
            "{message}"
        );
        let last = frames[2].as_ref().unwrap();
        assert_eq!((last.index, last.time_s, last.gravity), (2, Some(2.0 / 60.0), down));
        assert_eq!(last.source, "images/000002.png");
    }

    #[test]
    fn streams_give_the_same_frames_as_files() {
        let mut writer = Y4mWriter::new(Vec::new(), "-", (4, 3), (20, 1)).unwrap();
        writer.write(&image(7).view()).unwrap();
        let y4m = FrameSource::y4m(std::io::Cursor::new(writer.finish().unwrap()), "-").unwrap();
        let format = RawFormat { width: 4, height: 3, rate_hz: Some(20.0) };
        let raw = FrameSource::raw(std::io::Cursor::new(vec![7; 12]), "-", format).unwrap();
        let frames = |source: FrameSource| source.map(|frame| frame.unwrap()).collect::<Vec<_>>();
        let y4m = frames(y4m);
        assert_eq!(y4m, frames(raw));
        assert_eq!((y4m.len(), &y4m[0].image, y4m[0].source.as_str()), (1, &image(7), "-"));
    }
}
