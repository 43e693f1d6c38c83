//! Pictures in colour to a Y4M stream.

use std::io::Write;
use std::path::{Path, PathBuf};

use crate::{Error, Place, Result};

/// Frames per second that a video of pictures is played with.
const RATE: u32 = 25;

/// Writes RGB pictures of one size as Y4M: colour space 444, full range, ITU-R BT.601.
#[derive(Debug)]
pub struct ColourY4mWriter<W> {
    sink: W,
    name: PathBuf,
    size: (usize, usize),
    next: u64,
    planes: Vec<u8>,
}

impl<W: Write> ColourY4mWriter<W> {
    /// Writes the first line, for pictures of `size`, columns and rows; `name` is for the messages.
    ///
    /// # Errors
    /// [`Error`] when the sink refuses.
    pub fn new(mut sink: W, name: impl AsRef<Path>, size: (usize, usize)) -> Result<Self> {
        let name = name.as_ref().to_owned();
        let (width, height) = size;
        writeln!(sink, "YUV4MPEG2 W{width} H{height} F{RATE}:1 Ip A1:1 C444 XCOLORRANGE=FULL")
            .map_err(|error| Error::io(&name, error))?;
        Ok(Self { sink, name, size, next: 0, planes: Vec::new() })
    }

    /// Writes a picture of `size`: red, green and blue of every pixel, row by row.
    ///
    /// # Errors
    /// [`Error`] when it has another size than the first line says, or the sink refuses.
    pub fn write(&mut self, rgb: &[u8], size: (usize, usize)) -> Result<()> {
        let place = Place::Frame(self.next);
        if size != self.size || rgb.len() != 3 * size.0 * size.1 {
            let ((have, high), (need, tall)) = (size, self.size);
            let reason = format!("the picture is {have}x{high}, the video {need}x{tall}");
            return Err(Error::format(&self.name, reason)
                .at(place)
                .advise("write frames of one size to one video"));
        }
        let header = b"FRAME\n";
        let count = size.0 * size.1;
        self.planes.clear();
        self.planes.extend(header);
        self.planes.resize(header.len() + 3 * count, 0);
        let (luma, chroma) = self.planes[header.len()..].split_at_mut(count);
        let (blue, red) = chroma.split_at_mut(count);
        let places = luma.iter_mut().zip(blue).zip(red);
        for (((y, cb), cr), pixel) in places.zip(rgb.chunks_exact(3)) {
            [*y, *cb, *cr] = luma_and_chroma([pixel[0], pixel[1], pixel[2]]);
        }
        self.sink
            .write_all(&self.planes)
            .and_then(|()| self.sink.flush())
            .map_err(|error| Error::io(&self.name, error).at(place))?;
        self.next += 1;
        Ok(())
    }
}

/// Y, Cb, Cr of a colour, full range (ITU-R BT.601 in 16-bit fixed point, as JFIF has it).
fn luma_and_chroma([red, green, blue]: [u8; 3]) -> [u8; 3] {
    let [r, g, b] = [red, green, blue].map(i32::from);
    let level = |weighted: i32| ((weighted + (1 << 15)) >> 16).clamp(0, 255) as u8;
    [
        level(19_595 * r + 38_470 * g + 7_471 * b),
        level(-11_059 * r - 21_709 * g + 32_768 * b + (128 << 16)),
        level(32_768 * r - 27_439 * g - 5_329 * b + (128 << 16)),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::video::Y4mFrames;

    #[test]
    fn colours_are_those_of_bt_601() {
        for ([r, g, b], expected) in [
            ([0, 0, 0], [0, 128, 128]),
            ([255, 255, 255], [255, 128, 128]),
            ([77, 77, 77], [77, 128, 128]),
            ([255, 0, 0], [76, 85, 255]),
            ([0, 255, 0], [150, 44, 21]),
            ([0, 0, 255], [29, 255, 107]),
        ] {
            assert_eq!(luma_and_chroma([r, g, b]), expected);
        }
    }

    #[test]
    fn the_luma_reads_back_and_another_size_is_refused() {
        let mut bytes = Vec::new();
        let mut writer = ColourY4mWriter::new(&mut bytes, "v.y4m", (2, 1)).unwrap();
        writer.write(&[9, 9, 9, 200, 200, 200], (2, 1)).unwrap();
        assert!(
            writer
                .write(&[0; 3], (1, 1))
                .unwrap_err()
                .to_string()
                .contains("frame 1: the picture is 1x1, the video 2x1")
        );
        let frames: Vec<_> = Y4mFrames::new(bytes.as_slice(), "v.y4m").unwrap().collect();
        assert_eq!(frames.len(), 1);
        assert_eq!(frames[0].as_ref().unwrap().image.pixels(), [9, 200]);
    }
}
