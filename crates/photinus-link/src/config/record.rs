//! `[record]`: a recording in MCAP.

use std::path::PathBuf;

use photinus_io::{Error, Result};
use photinus_run::sink::Sink;
use serde::Deserialize;

use super::{BASE, Camera, mountings};
use crate::messages::Viewpoint;
use crate::sink_clock::SinkClock;

/// `[record]`.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Record {
    /// The MCAP file; `{time}` in its name becomes the seconds of the epoch, so that a robot that starts again begins another one.
    pub file: PathBuf,
    /// `png` (default), `raw` or `none`.
    #[serde(default)]
    pub pixels: crate::recording::Pixels,
    /// Goes on in another file past this many MB.
    pub split_mb: Option<f64>,
    /// Goes on in another file past this many seconds.
    pub split_s: Option<f64>,
}

impl Record {
    /// Begins the recording.
    ///
    /// # Errors
    /// As [`Recorder::create`](crate::recording::Recorder::create), and when a split is none.
    pub fn open(&self, cameras: &[Camera]) -> Result<Box<dyn Sink>> {
        use crate::recording::{RecordSink, Recorder, Settings, Split};
        let wrong = |split: Option<f64>| split.is_some_and(|split| !(split > 0.0 && split.is_finite()));
        if wrong(self.split_mb) || wrong(self.split_s) {
            return Err(Error::format(&self.file, "a recording is split past a size and a time above 0"));
        }
        let bytes = self.split_mb.map(|megabytes| (megabytes * 1e6) as u64);
        let split = Split { bytes, seconds: self.split_s };
        let fixed =
            (cameras.iter().any(|camera| camera.mounting.is_some())).then(|| mountings(BASE, cameras));
        let now_s = SinkClock::new().now_ns() / 1_000_000_000;
        let file = self.file.to_string_lossy().replace("{time}", &now_s.to_string());
        let recorder = Recorder::create(file, Settings { pixels: self.pixels, split }, fixed)?;
        Ok(Box::new(RecordSink::new(recorder, views(cameras))))
    }
}

fn views(cameras: &[Camera]) -> Vec<Viewpoint> {
    cameras.iter().map(|camera| camera.view.clone()).collect()
}
