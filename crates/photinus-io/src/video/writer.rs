//! Grey frames to a Y4M stream.

use std::io::Write;
use std::path::{Path, PathBuf};

use photinus::frame::FrameView;

use crate::{Error, Place, Result};

/// Writes 8-bit grey frames of one size as Y4M (colour space `mono`).
#[derive(Debug)]
pub struct Y4mWriter<W> {
    sink: W,
    name: PathBuf,
    width: usize,
    height: usize,
    next: u64,
}

impl<W: Write> Y4mWriter<W> {
    /// Writes the first line: frames of `width` x `height` at `rate.0 / rate.1` per second, (0, 0) where that is
    /// unknown; `name` is for the messages.
    ///
    /// # Errors
    /// [`Error`] when the sink refuses.
    pub fn new(
        mut sink: W,
        name: impl AsRef<Path>,
        (width, height): (usize, usize),
        rate: (u32, u32),
    ) -> Result<Self> {
        let name = name.as_ref().to_owned();
        writeln!(sink, "YUV4MPEG2 W{width} H{height} F{}:{} Ip A1:1 Cmono XCOLORRANGE=FULL", rate.0, rate.1)
            .map_err(|error| Error::io(&name, error))?;
        Ok(Self { sink, name, width, height, next: 0 })
    }

    /// Writes a frame.
    ///
    /// # Errors
    /// [`Error`] when it has another size than the first line says, or the sink refuses.
    pub fn write(&mut self, frame: &FrameView<'_>) -> Result<()> {
        let place = Place::Frame(self.next);
        if (frame.width(), frame.height()) != (self.width, self.height) {
            let (have, need) = ((frame.width(), frame.height()), (self.width, self.height));
            let reason = format!("the frame is {}x{}, the stream {}x{}", have.0, have.1, need.0, need.1);
            return Err(Error::format(&self.name, reason).at(place).advise("write one size to one stream"));
        }
        let mut bytes = b"FRAME\n".to_vec();
        (0..frame.height()).for_each(|v| bytes.extend(frame.row(v)));
        self.sink.write_all(&bytes).map_err(|error| Error::io(&self.name, error).at(place))?;
        self.next += 1;
        Ok(())
    }

    /// Hands everything to the operating system and gives the sink back.
    ///
    /// # Errors
    /// [`Error`] when the sink refuses.
    pub fn finish(mut self) -> Result<W> {
        self.sink.flush().map_err(|error| Error::io(&self.name, error))?;
        Ok(self.sink)
    }
}
