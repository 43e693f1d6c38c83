//! Frames, results and whatever else has a message -> MCAP files.

use std::path::{Path, PathBuf};

use nalgebra::{Unit, Vector3};
use photinus::frame::FrameView;
use photinus::tracking::{Moving, Turned};
use photinus_io::frames::Moved;
use photinus_io::results::{FrameRecord, ResultsWriter};
use photinus_io::{Error, Result};

use super::part::Part;
use super::pixels::{self, Pixels};
use crate::messages::{Messages, Viewpoint};
use crate::ros::{self, CompressedImage, Image, Message, Text};
use crate::{cdr, topics};

/// When a recording goes on in another file.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Split {
    /// Past this many bytes of messages.
    pub bytes: Option<u64>,
    /// Past this many seconds.
    pub seconds: Option<f64>,
}

/// How a recording is written.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Settings {
    /// Which pixels it keeps.
    pub pixels: Pixels,
    /// When it goes on in another file.
    pub split: Split,
}

/// A recording in the making. Whoever ends it calls [`Recorder::finish`]; one that is dropped ends as well as it can, and one whose
/// program dies is mended by [`recover`](super::recover).
pub struct Recorder {
    path: PathBuf,
    settings: Settings,
    part: Option<Part>,
    parts: u32,
    /// What tf_static says, at the beginning of every file.
    fixed: Option<ros::TFMessage>,
    room: Room,
}

/// Buffers that every message uses anew.
#[derive(Default)]
struct Room {
    message: Vec<u8>,
    rows: Vec<u8>,
    packed: Vec<u8>,
}

/// A frame that was located.
#[derive(Clone, Copy, Debug)]
pub struct Located<'a> {
    /// What was found.
    pub record: &'a FrameRecord,
    /// Its pixels, where they are to be kept.
    pub image: Option<FrameView<'a>>,
    /// The direction of gravity that was known, in the camera frame.
    pub gravity: Option<Unit<Vector3<f64>>>,
    /// How the camera moved, as far as it was known.
    pub moved: Moved,
}

impl Recorder {
    /// A recording at `path`; of a split one, the first file: the second of `flight.mcap` is `flight.1.mcap`. `fixed` says how cameras sit.
    ///
    /// # Errors
    /// [`Error`] when there is such a file already, or none can be made.
    pub fn create(path: impl AsRef<Path>, settings: Settings, fixed: Option<ros::TFMessage>) -> Result<Self> {
        let path = path.as_ref().to_owned();
        let part = Some(Part::create(&path)?);
        Ok(Self { path, settings, part, parts: 1, fixed, room: Room::default() })
    }

    /// Writes a frame with all that is told of it; `arrived_ns` is when, on the one clock that orders the recording.
    ///
    /// # Errors
    /// As [`Recorder::message`].
    pub fn located(&mut self, located: &Located<'_>, view: &Viewpoint, arrived_ns: u64) -> Result<()> {
        self.frame(located, view, arrived_ns)?;
        let record = located.record;
        let at = (view.header(record.time_s).stamp.nanoseconds(), arrived_ns);
        let told = Messages::of(record, view);
        self.put(topics::DETECTIONS, &told.detections, at)?;
        self.put(topics::NEIGHBOURS, &told.neighbours, at)?;
        self.put(topics::MARKERS, &told.markers, at)?;
        if !told.tracks.neighbours.is_empty() {
            self.put(topics::TRACKS, &told.tracks, at)?;
        }
        if !told.transforms.transforms.is_empty() {
            self.put(topics::TRANSFORMS, &told.transforms, at)?;
        }
        self.put(topics::RESULTS, &Text { data: line(record)? }, at)
    }

    /// Writes a frame alone, with what is known of it, and nothing that was found.
    ///
    /// # Errors
    /// As [`Recorder::message`].
    pub fn frame(&mut self, frame: &Located<'_>, view: &Viewpoint, arrived_ns: u64) -> Result<()> {
        self.turn(arrived_ns)?;
        let record = frame.record;
        let header = view.header(record.time_s);
        let at = (header.stamp.nanoseconds(), arrived_ns);
        let together = frame.moved.together;
        let known = ros::Frame {
            header: header.clone(),
            camera: view.camera.clone(),
            frame: record.frame.unwrap_or_default(),
            time: record.time_s.unwrap_or(f64::NAN),
            exposure: view.exposure_s.unwrap_or(f64::NAN),
            source: record.source.clone(),
            gravity: frame.gravity.map(|down| down.as_slice().to_vec()).unwrap_or_default(),
            turned: frame.moved.turned.as_ref().map(turned).unwrap_or_default(),
            moving: frame.moved.moving.as_ref().map(moving).unwrap_or_default(),
            order: together.iter().map(|own| own.order).collect(),
            turned_since_any: together.and_then(|own| own.turned).as_ref().map(turned).unwrap_or_default(),
        };
        self.put(&topics::of_camera(&view.camera, "frame"), &known, at)?;
        match &frame.image {
            Some(image) => self.image(image, view, &header, at),
            None => Ok(()),
        }
    }

    /// Writes a message that was made at `made_ns` and arrived at `arrived_ns`.
    ///
    /// # Errors
    /// [`Error`] when it cannot be written: the disk is full, the message without an encoding.
    pub fn message(
        &mut self,
        topic: &str,
        message: &impl Message,
        made_ns: u64,
        arrived_ns: u64,
    ) -> Result<()> {
        self.turn(arrived_ns)?;
        self.put(topic, message, (made_ns, arrived_ns))
    }

    /// Sees to it that what was written is in the file. Called by itself every second of the messages' clock; who waits for messages
    /// longer than that calls it.
    ///
    /// # Errors
    /// [`Error`] when the disk refuses.
    pub fn flush(&mut self) -> Result<()> {
        self.part.as_mut().map_or(Ok(()), Part::flush)
    }

    /// Ends the recording.
    ///
    /// # Errors
    /// [`Error`] when the index cannot be written; the file can be recovered then.
    pub fn finish(mut self) -> Result<()> {
        self.part.take().map_or(Ok(()), Part::finish)
    }

    fn image(
        &mut self,
        image: &FrameView<'_>,
        view: &Viewpoint,
        header: &ros::Header,
        at: (u64, u64),
    ) -> Result<()> {
        let (mut rows, mut packed) =
            (std::mem::take(&mut self.room.rows), std::mem::take(&mut self.room.packed));
        let side = |px: usize| u32::try_from(px).unwrap_or(u32::MAX);
        let header = header.clone();
        let written = match self.settings.pixels {
            Pixels::None => Ok(()),
            Pixels::Raw => {
                pixels::packed(image, &mut rows);
                let (width, height) = (side(image.width()), side(image.height()));
                let encoding = "mono8".to_owned();
                let raw = Image {
                    header,
                    height,
                    width,
                    encoding,
                    is_bigendian: 0,
                    step: width,
                    data: (&*rows).into(),
                };
                self.put(&topics::of_camera(&view.camera, "image"), &raw, at)
            }
            Pixels::Png => {
                let failed = |error| Error::io(&self.path, error);
                pixels::png(image, &mut rows, &mut packed).map_err(failed).and_then(|()| {
                    let format = "mono8; png compressed ".to_owned();
                    let png = CompressedImage { header, format, data: (&*packed).into() };
                    self.put(&topics::of_camera(&view.camera, "image/compressed"), &png, at)
                })
            }
        };
        (self.room.rows, self.room.packed) = (rows, packed);
        written
    }

    fn put<M: Message>(&mut self, topic: &str, message: &M, (made_ns, arrived_ns): (u64, u64)) -> Result<()> {
        let mut bytes = std::mem::take(&mut self.room.message);
        let encoded = cdr::encode_into(message, &mut bytes);
        let written = match encoded {
            Ok(()) => self.write(topic, M::NAME, &bytes, (made_ns, arrived_ns)),
            Err(error) => Err(Error::format(&self.path, format!("{topic}: {error}"))),
        };
        self.room.message = bytes;
        written
    }

    fn write(&mut self, topic: &str, kind: &'static str, bytes: &[u8], at: (u64, u64)) -> Result<()> {
        let fixed = self.fixed.clone();
        let Some(part) = &mut self.part else {
            return Err(Error::format(&self.path, "it was given up after an error of its disk"));
        };
        if part.begins(at.1)
            && let Some(fixed) = fixed.filter(|_| topic != topics::STATIC_TRANSFORMS)
        {
            let bytes = cdr::encode(&fixed)
                .map_err(|error| Error::format(&self.path, format!("tf_static: {error}")))?;
            part.write(topics::STATIC_TRANSFORMS, "tf2_msgs/TFMessage", &bytes, at)?;
        }
        part.write(topic, kind, bytes, at)
    }

    /// Goes on in another file where this one is full: between frames, so that none is torn.
    fn turn(&mut self, now_ns: u64) -> Result<()> {
        let is_full = self.part.as_ref().is_some_and(|part| part.is_full(&self.settings.split, now_ns));
        if is_full { self.next_part() } else { Ok(()) }
    }

    fn next_part(&mut self) -> Result<()> {
        let path = self.path.with_extension(format!("{}.mcap", self.parts));
        // The next file is there before this one ends: nothing is lost where there is no room for it.
        let next = Part::create(&path)?;
        let last = self.part.replace(next);
        self.parts += 1;
        last.map_or(Ok(()), Part::finish)
    }
}

/// A recording of nothing is not left behind.
impl Drop for Recorder {
    fn drop(&mut self) {
        if let Some(part) = self.part.take().filter(Part::is_empty) {
            part.remove();
        }
    }
}

/// The line of results of a frame.
fn line(record: &FrameRecord) -> Result<String> {
    let mut bytes = Vec::new();
    ResultsWriter::new(&mut bytes, "results").write(record)?;
    let text = String::from_utf8(bytes).map_err(|error| Error::format("results", error.to_string()))?;
    Ok(text.trim_end().to_owned())
}

/// Rows of the rotation, then its sigma.
fn turned(turned: &Turned) -> Vec<f64> {
    let rows = turned.now_from_before.matrix().transpose();
    rows.iter().copied().chain([turned.sigma_rad]).collect()
}

/// The velocity, then its sigma.
fn moving(moving: &Moving) -> Vec<f64> {
    moving.velocity_m_s.iter().copied().chain([moving.sigma_m_s]).collect()
}
