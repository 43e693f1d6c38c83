//! Video as a stream: any `Read` (a file, standard input) enters, grey frames leave one after the other.
//!
//! Two forms that every tool can produce through a pipe: Y4M, which says its size and rate itself, and raw grey
//! frames, of which both must be told. A stream cut in the middle of a frame gives all the frames before, then one
//! error with the byte counts, then nothing.

mod colour;
mod raw;
mod writer;
mod y4m;
mod y4m_header;

use std::io::{ErrorKind, Read};
use std::path::Path;

use crate::image::GreyImage;
use crate::{Error, Place, Result};
pub use colour::ColourY4mWriter;
pub use raw::{RawFormat, RawFrames};
pub use writer::Y4mWriter;
pub use y4m::Y4mFrames;

/// A frame of a stream.
#[derive(Clone, Debug, PartialEq)]
pub struct VideoFrame {
    /// Its number, from 0.
    pub index: u64,
    /// Its time since the first frame, s, where the rate is known.
    pub time_s: Option<f64>,
    /// The pixels.
    pub image: GreyImage,
}

/// Reads the `need` bytes of frame `index`, growing with what arrives rather than with what was promised; `None`
/// where the stream ends before the first of them.
fn read_plane(source: &mut impl Read, need: usize, name: &Path, index: u64) -> Result<Option<Vec<u8>>> {
    let mut bytes = Vec::new();
    let read = source.take(need as u64).read_to_end(&mut bytes);
    read.map_err(|error| Error::io(name, error).at(Place::Frame(index)))?;
    match bytes.len() {
        0 => Ok(None),
        have if have < need => Err(cut(name, index, have, need)),
        _ => Ok(Some(bytes)),
    }
}

/// The error of a stream that ends inside a frame.
fn cut(name: &Path, index: u64, have: usize, need: usize) -> Error {
    let reason = format!("the stream ends after {have} of the frame's {need} bytes");
    let whole = match index {
        0 => "no frame is whole".to_owned(),
        _ => format!("the frames before it are whole ({index})"),
    };
    Error::new(name, std::io::Error::new(ErrorKind::UnexpectedEof, reason))
        .at(Place::Frame(index))
        .advise(format!("{whole}: check the frame size and that the recording was closed"))
}

#[cfg(test)]
mod tests;
