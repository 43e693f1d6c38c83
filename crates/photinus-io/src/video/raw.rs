//! Raw grey frames: width x height bytes each, nothing between them.

use std::io::Read;
use std::path::{Path, PathBuf};

use super::{VideoFrame, read_plane};
use crate::image::{GreyImage, check_size};
use crate::{Error, Result};

/// What a raw stream does not say itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RawFormat {
    /// Columns, px.
    pub width: usize,
    /// Rows, px.
    pub height: usize,
    /// Frames per second, where known.
    pub rate_hz: Option<f64>,
}

/// Frames of a raw stream of 8-bit grey pixels.
#[derive(Debug)]
pub struct RawFrames<R> {
    source: R,
    name: PathBuf,
    format: RawFormat,
    next: u64,
    ended: bool,
}

impl<R: Read> RawFrames<R> {
    /// Frames of `source`; `name` is for the messages.
    ///
    /// # Errors
    /// [`Error`] when no frame has this size or the rate is not a positive number.
    pub fn new(source: R, name: impl AsRef<Path>, format: RawFormat) -> Result<Self> {
        let name = name.as_ref().to_owned();
        let RawFormat { width, height, rate_hz } = format;
        check_size(width, height)
            .map_err(|reason| Error::format(&name, reason).advise("give the camera's width and height"))?;
        if rate_hz.is_some_and(|rate_hz| !(rate_hz.is_finite() && rate_hz > 0.0)) {
            return Err(Error::format(&name, "the frame rate is not a positive number")
                .advise("give the frames per second, or leave them out"));
        }
        Ok(Self { source, name, format, next: 0, ended: false })
    }

    fn read(&mut self) -> Result<Option<VideoFrame>> {
        let RawFormat { width, height, rate_hz } = self.format;
        let Some(pixels) = read_plane(&mut self.source, width * height, &self.name, self.next)? else {
            return Ok(None);
        };
        let image = GreyImage::new(pixels, width, height).map_err(|error| Error::new(&self.name, error))?;
        let frame =
            VideoFrame { index: self.next, time_s: rate_hz.map(|rate_hz| self.next as f64 / rate_hz), image };
        self.next += 1;
        Ok(Some(frame))
    }
}

impl<R: Read> Iterator for RawFrames<R> {
    type Item = Result<VideoFrame>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.ended {
            return None;
        }
        let frame = self.read().transpose();
        self.ended = !matches!(frame, Some(Ok(_)));
        frame
    }
}
