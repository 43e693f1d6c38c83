//! Pictures in colour to a Y4M stream.

use std::io::Write;
use std::path::{Path, PathBuf};

use crate::{Error, Place, Result};

/// Frames per second that a video of pictures is played with.
const RATE: u32 = 25;
/// What begins a picture.
const HEADER: &[u8] = b"FRAME\n";
/// Pixels that are looked at together: most are grey, or of one colour, and those need no sums.
const SIDE_BY_SIDE: usize = 32;
/// Cb and Cr of every grey, whose Y is its level.
const GREY: u8 = 128;

/// Writes opaque RGBA pictures of one size as Y4M: colour space 444, full range, ITU-R BT.601.
#[derive(Debug)]
pub struct ColourY4mWriter<W> {
    sink: W,
    name: PathBuf,
    size: (usize, usize),
    next: u64,
    /// The bytes of a picture: its header and three planes.
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
        Ok(Self { sink, name, size, next: 0, planes: HEADER.to_vec() })
    }

    /// Writes a picture of `size`: red, green, blue of every pixel and a byte that is not looked at, row by row.
    ///
    /// # Errors
    /// [`Error`] when it has another size than the first line says, or the sink refuses.
    pub fn write(&mut self, rgba: &[u8], size: (usize, usize)) -> Result<()> {
        let place = Place::Frame(self.next);
        if size != self.size || rgba.len() != 4 * size.0 * size.1 {
            let ((have, high), (need, tall)) = (size, self.size);
            let reason = format!("the picture is {have}x{high}, the video {need}x{tall}");
            return Err(Error::format(&self.name, reason)
                .at(place)
                .advise("write frames of one size to one video"));
        }
        let count = size.0 * size.1;
        self.planes.resize(HEADER.len() + 3 * count, 0);
        let (luma, chroma) = self.planes[HEADER.len()..].split_at_mut(count);
        let (blue, red) = chroma.split_at_mut(count);
        let planes = luma
            .chunks_mut(SIDE_BY_SIDE)
            .zip(blue.chunks_mut(SIDE_BY_SIDE))
            .zip(red.chunks_mut(SIDE_BY_SIDE));
        let (pixels, _) = rgba.as_chunks::<4>();
        for (((luma, blue), red), pixels) in planes.zip(pixels.chunks(SIDE_BY_SIDE)) {
            convert(pixels, luma, blue, red);
        }
        self.sink
            .write_all(&self.planes)
            .and_then(|()| self.sink.flush())
            .map_err(|error| Error::io(&self.name, error).at(place))?;
        self.next += 1;
        Ok(())
    }
}

/// Pixels side by side, into their places in the three planes.
fn convert(pixels: &[[u8; 4]], luma: &mut [u8], blue: &mut [u8], red: &mut [u8]) {
    let first = pixels.first().copied().unwrap_or_default();
    let coloured = pixels.iter().fold(0, |sum, [r, g, b, _]| sum | (r ^ g) | (g ^ b));
    let differs = |pixel: &[u8; 4]| u32::from_ne_bytes(*pixel) ^ u32::from_ne_bytes(first);
    if coloured == 0 {
        luma.iter_mut().zip(pixels).for_each(|(y, pixel)| *y = pixel[0]);
        blue.fill(GREY);
        red.fill(GREY);
    } else if pixels.iter().fold(0, |sum, pixel| sum | differs(pixel)) == 0 {
        let [y, cb, cr] = luma_and_chroma([first[0], first[1], first[2]]);
        luma.fill(y);
        blue.fill(cb);
        red.fill(cr);
    } else {
        for (((y, cb), cr), &[r, g, b, _]) in luma.iter_mut().zip(blue).zip(red).zip(pixels) {
            [*y, *cb, *cr] = luma_and_chroma([r, g, b]);
        }
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
    fn grey_pixels_side_by_side_are_what_each_is_alone() {
        let width = 5 * SIDE_BY_SIDE / 2;
        let picture: Vec<[u8; 4]> = (0..3 * width)
            .map(|at| match at % width {
                // One colour among greys, in one row only; a row of one colour.
                40 if at / width == 1 => [at as u8, 200, 7, 255],
                _ if at / width == 2 => [9, 90, 200, 255],
                grey => [grey as u8 * 3; 4],
            })
            .collect();
        let mut bytes = Vec::new();
        let mut writer = ColourY4mWriter::new(&mut bytes, "v.y4m", (width, 3)).unwrap();
        (0..2).for_each(|_| writer.write(picture.as_flattened(), (width, 3)).unwrap());
        let expected: Vec<[u8; 3]> = picture.iter().map(|&[r, g, b, _]| luma_and_chroma([r, g, b])).collect();
        let planes: Vec<u8> =
            (0..3).flat_map(|plane| expected.iter().map(move |pixel| pixel[plane])).collect();
        let (_, pictures) = bytes.split_at(bytes.iter().position(|&byte| byte == b'\n').unwrap() + 1);
        let one = [HEADER, planes.as_slice()].concat();
        assert!(pictures == [one.as_slice(), one.as_slice()].concat());
    }

    #[test]
    fn the_luma_reads_back_and_another_size_is_refused() {
        let mut bytes = Vec::new();
        let mut writer = ColourY4mWriter::new(&mut bytes, "v.y4m", (2, 1)).unwrap();
        writer.write(&[9, 9, 9, 255, 200, 200, 200, 255], (2, 1)).unwrap();
        assert!(
            writer
                .write(&[0; 4], (1, 1))
                .unwrap_err()
                .to_string()
                .contains("frame 1: the picture is 1x1, the video 2x1")
        );
        let frames: Vec<_> = Y4mFrames::new(bytes.as_slice(), "v.y4m").unwrap().collect();
        assert_eq!(frames.len(), 1);
        assert_eq!(frames[0].as_ref().unwrap().image.pixels(), [9, 200]);
    }
}
