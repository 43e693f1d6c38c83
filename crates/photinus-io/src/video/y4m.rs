//! Frames of a Y4M stream.

use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};

use super::y4m_header::Header;
use super::{VideoFrame, cut, read_plane, y4m_header};
use crate::image::{Conversion, GreyImage, check_maximum};
use crate::{Error, Place, Result, kind};

/// Longest line that a stream may have before its pixels.
const MAX_LINE_BYTES: u64 = 4096;

/// Frames of a Y4M stream: its luma, scaled to 8 bit. Grey and the common colour layouts are read, 8 to 16 bit.
///
/// Luma is taken as full range unless the stream is in colour and says XCOLORRANGE=LIMITED: then 16 to 235 is
/// stretched to 0 to 255, so that a saturated pixel is 255 again.
#[derive(Debug)]
pub struct Y4mFrames<R> {
    source: BufReader<R>,
    name: PathBuf,
    header: Header,
    next: u64,
    ended: bool,
}

impl<R: Read> Y4mFrames<R> {
    /// Reads the first line of `source`; `name` is for the messages.
    ///
    /// # Errors
    /// [`Error`] when it is no Y4M stream, or one of a kind that is not read.
    pub fn new(source: R, name: impl AsRef<Path>) -> Result<Self> {
        let name = name.as_ref().to_owned();
        let mut source = BufReader::new(source);
        let line = read_line(&mut source).map_err(|error| Error::io(&name, error))?;
        let header = match line.strip_suffix('\n') {
            None if line.starts_with(y4m_header::MAGIC) => Err("its first line never ends".to_owned()),
            ended => Header::parse(ended.unwrap_or(&line)),
        }
        .map_err(|reason| {
            Error::format(&name, format!("no Y4M stream that Photinus reads: {reason}"))
                .advise(kind::decoding(Path::new("video.mp4")))
        })?;
        Ok(Self { source, name, header, next: 0, ended: false })
    }

    /// Columns.
    pub fn width(&self) -> usize {
        self.header.width
    }

    /// Rows.
    pub fn height(&self) -> usize {
        self.header.height
    }

    /// Frames per second, where the stream says it.
    pub fn rate_hz(&self) -> Option<f64> {
        self.header.rate_hz
    }

    /// What is done to every frame to get 8-bit grey; empty for 8-bit grey.
    pub fn conversions(&self) -> Vec<Conversion> {
        self.header.conversions()
    }

    fn read(&mut self) -> Result<Option<VideoFrame>> {
        let (luma_bytes, chroma_bytes) = self.header.plane_bytes();
        let line = read_line(&mut self.source)
            .map_err(|error| Error::io(&self.name, error).at(Place::Frame(self.next)))?;
        match line.trim_end_matches('\n') {
            _ if line.is_empty() => return Ok(None),
            line if line == "FRAME" || line.starts_with("FRAME ") => {}
            _ => {
                return Err(Error::format(&self.name, "no FRAME line where one must stand")
                    .at(Place::Frame(self.next))
                    .advise("the recording is damaged here: cut it before this frame"));
            }
        }
        let luma = read_plane(&mut self.source, luma_bytes, &self.name, self.next)?
            .ok_or_else(|| cut(&self.name, self.next, 0, luma_bytes + chroma_bytes))?;
        let skipped = std::io::copy(&mut (&mut self.source).take(chroma_bytes as u64), &mut std::io::sink())
            .map_err(|error| Error::io(&self.name, error).at(Place::Frame(self.next)))?;
        if skipped < chroma_bytes as u64 {
            let have = luma_bytes + usize::try_from(skipped).unwrap_or(0);
            return Err(cut(&self.name, self.next, have, luma_bytes + chroma_bytes));
        }
        let luma = self.to_eight_bit(luma).map_err(|reason| {
            Error::format(&self.name, reason).at(Place::Frame(self.next)).advise("record or convert it again")
        })?;
        let image = GreyImage::new(luma, self.header.width, self.header.height)
            .map_err(|error| Error::new(&self.name, error).at(Place::Frame(self.next)))?;
        let time_s = self.header.rate_hz.map(|rate_hz| self.next as f64 / rate_hz);
        let frame = VideoFrame { index: self.next, time_s, image };
        self.next += 1;
        Ok(Some(frame))
    }

    fn to_eight_bit(&self, mut luma: Vec<u8>) -> std::result::Result<Vec<u8>, String> {
        if self.header.layout.bits > 8 {
            let maximum = self.header.layout.maximum();
            let samples = luma.chunks_exact(2).map(|word| u32::from(u16::from_le_bytes([word[0], word[1]])));
            check_maximum(samples.clone().max().unwrap_or(0), maximum, "the byte with the lower bits first")?;
            luma = samples.map(|sample| ((sample * 255 + maximum / 2) / maximum) as u8).collect();
        }
        if self.header.limited_range {
            for pixel in &mut luma {
                *pixel = (((u32::from((*pixel).clamp(16, 235)) - 16) * 255 + 109) / 219) as u8;
            }
        }
        Ok(luma)
    }
}

impl<R: Read> Iterator for Y4mFrames<R> {
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

/// A line with its end, which a cut or endless one lacks; empty at the end of the stream.
fn read_line(source: &mut impl BufRead) -> std::io::Result<String> {
    let mut line = Vec::new();
    source.take(MAX_LINE_BYTES).read_until(b'\n', &mut line)?;
    Ok(String::from_utf8_lossy(&line).into_owned())
}
