//! A frame on its way to a record of results.

use std::time::Instant;

use nalgebra::{Unit, Vector3};
use photinus::locator::Sun;
use photinus_io::frames::{Frame, Moved};
use photinus_io::image::{Conversion, GreyImage};
use photinus_io::results::{FrameRecord, SpotRecord};

/// A frame on its way to a record of results.
#[derive(Clone, Debug)]
pub struct Entry {
    /// Number, time and source; the rest is filled in. Spots stand in it already when they came in place of pixels.
    pub record: FrameRecord,
    /// The pixels, unless spots came in their place.
    pub image: Option<GreyImage>,
    /// Which of the input's cameras took it.
    pub camera: usize,
    /// Direction of gravity (down) in the camera frame, where the source knows.
    pub gravity: Option<Unit<Vector3<f64>>>,
    /// How the camera moved, where the source knows, or what was told of it meanwhile.
    pub moved: Moved,
    /// Where the sun is in the camera frame, where place, time and gravity tell.
    pub sun: Option<Sun>,
    /// What was done to the stored samples.
    pub conversions: Vec<Conversion>,
    /// When its exposure ended, or where nobody knows that, when it arrived, by the clock of this machine; `None` of what was recorded before. Its
    /// `time_s` stays the camera's own.
    pub taken: Option<Instant>,
    /// How long it was exposed, s, where the source knows.
    pub exposure_s: Option<f64>,
    /// Frames of its camera that were taken and dropped since the one before.
    pub dropped: u64,
}

impl Entry {
    /// A frame of a file or a stream.
    pub fn from_frame(frame: Frame) -> Self {
        let record = record(frame.index, frame.time_s, frame.source, Vec::new());
        Self {
            gravity: frame.gravity,
            exposure_s: frame.exposure_s,
            moved: frame.moved,
            conversions: frame.conversions,
            ..Self::new(record, Some(frame.image))
        }
    }

    /// Spots of another detector that numbers its frames and says their times, s.
    pub fn of_spots(index: u64, time_s: f64, source: &str, spots: Vec<SpotRecord>) -> Self {
        Self::new(record(index, Some(time_s), source.to_owned(), spots), None)
    }

    /// Spots of another detector in place of a frame.
    pub fn from_spots(record: FrameRecord) -> Self {
        Self::new(FrameRecord { neighbours: Vec::new(), ..record }, None)
    }

    fn new(record: FrameRecord, image: Option<GreyImage>) -> Self {
        Self {
            record,
            image,
            camera: 0,
            gravity: None,
            moved: Moved::default(),
            sun: None,
            conversions: Vec::new(),
            taken: None,
            exposure_s: None,
            dropped: 0,
        }
    }

    /// Its number, 0 where it has none.
    pub fn number(&self) -> u64 {
        self.record.frame.unwrap_or_default()
    }
}

/// A frame of which nothing is known yet but this.
fn record(index: u64, time_s: Option<f64>, source: String, spots: Vec<SpotRecord>) -> FrameRecord {
    FrameRecord {
        frame: Some(index),
        camera: None,
        time_s,
        latency_s: None,
        tracks: Vec::new(),
        source,
        incomplete: false,
        spots,
        rejected: Vec::new(),
        neighbours: Vec::new(),
    }
}
