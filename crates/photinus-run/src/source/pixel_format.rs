//! How cameras lay out their pixels -> grey frames. Pure: the bytes of a buffer come in, whoever filled it.

use std::path::Path;

use photinus_io::image::{Conversion, GreyImage, decode_image};
use photinus_io::{Error, Result};

/// A layout of pixels that has a grey frame in it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PixelFormat {
    /// A byte each.
    Grey,
    /// Two bytes each, little endian, of which the lower 10, 12, 14 or 16 bits count.
    Deep(u8),
    /// MIPI's packing: four pixels in five bytes, the upper eight bits of each first.
    Packed10,
    /// MIPI's packing: two pixels in three bytes, the upper eight bits of each first.
    Packed12,
    /// Y U Y V: every other byte is luma, from the first on.
    Yuyv,
    /// U Y V Y: every other byte is luma, from the second on.
    Uyvy,
    /// A JPEG file each.
    Jpeg,
}

/// The codes of V4L2 (`videodev2.h`), the best first: grey before colour, what is not compressed before what is, eight bits before more, since
/// frames are located in with eight.
const CODES: [(&[u8; 4], PixelFormat); 11] = [
    (b"GREY", PixelFormat::Grey),
    (b"Y10P", PixelFormat::Packed10),
    (b"Y12P", PixelFormat::Packed12),
    (b"Y10 ", PixelFormat::Deep(10)),
    (b"Y12 ", PixelFormat::Deep(12)),
    (b"Y14 ", PixelFormat::Deep(14)),
    (b"Y16 ", PixelFormat::Deep(16)),
    (b"YUYV", PixelFormat::Yuyv),
    (b"UYVY", PixelFormat::Uyvy),
    (b"MJPG", PixelFormat::Jpeg),
    (b"JPEG", PixelFormat::Jpeg),
];

impl PixelFormat {
    /// The format of a code such as `GREY`, `Y10` or `MJPG`; `Y8` is another name of `GREY`.
    pub fn of_code(code: &str) -> Option<Self> {
        let code = if code == "Y8" { "GREY" } else { code };
        CODES
            .iter()
            .find(|(known, _)| known.trim_ascii_end() == code.trim_end().as_bytes())
            .map(|(_, format)| *format)
    }

    /// Of these codes the one that is best located in.
    pub fn best(offered: impl IntoIterator<Item = [u8; 4]>) -> Option<([u8; 4], Self)> {
        let rank = |code: [u8; 4]| CODES.iter().position(|(known, _)| **known == code);
        let best = offered.into_iter().filter_map(rank).min()?;
        Some((*CODES[best].0, CODES[best].1))
    }

    /// The first code of the format.
    pub fn code(self) -> [u8; 4] {
        CODES.iter().find(|(_, format)| *format == self).map_or(*b"GREY", |(code, _)| **code)
    }

    /// Bytes of a row of pixels, of what is not compressed.
    fn row_bytes(self, width: usize) -> usize {
        match self {
            Self::Grey | Self::Jpeg => width,
            Self::Deep(_) | Self::Yuyv | Self::Uyvy => 2 * width,
            Self::Packed10 => (5 * width).div_ceil(4),
            Self::Packed12 => (3 * width).div_ceil(2),
        }
    }

    /// The grey frame in the bytes of a buffer whose rows begin `stride` bytes apart (0: without a gap), and what was done to get it. `name` is
    /// for the messages.
    ///
    /// # Errors
    /// [`Error`] when there are too few bytes, or they are no JPEG of that size.
    pub fn grey(
        self,
        bytes: &[u8],
        [width, height]: [usize; 2],
        stride: usize,
        name: &Path,
    ) -> Result<(GreyImage, Vec<Conversion>)> {
        if self == Self::Jpeg {
            return jpeg(bytes, [width, height], name);
        }
        let row_bytes = self.row_bytes(width);
        let stride = stride.max(row_bytes);
        let need = stride * height.saturating_sub(1) + row_bytes;
        if bytes.len() < need {
            let reason = format!("a buffer has {} bytes, {need} make {width} x {height} pixels", bytes.len());
            return Err(Error::format(name, reason)
                .advise("the frame was cut on its way: check the cable and the bandwidth"));
        }
        let mut pixels = Vec::with_capacity(width * height);
        for row in bytes.chunks(stride).take(height) {
            self.put_row(&row[..row_bytes], width, &mut pixels);
        }
        let image =
            GreyImage::new(pixels, width, height).map_err(|error| Error::format(name, error.to_string()))?;
        Ok((image, self.conversion().into_iter().collect()))
    }

    fn put_row(self, row: &[u8], width: usize, pixels: &mut Vec<u8>) {
        match self {
            Self::Grey | Self::Jpeg => pixels.extend_from_slice(row),
            Self::Deep(bits) => {
                // As a file of that depth is read: nearest of 255, and what is above the depth is its maximum.
                let maximum = (1_u32 << bits) - 1;
                let scaled = |sample: u32| ((sample.min(maximum) * 255 + maximum / 2) / maximum) as u8;
                pixels.extend(
                    row.chunks_exact(2).map(|pair| scaled(u32::from(u16::from_le_bytes([pair[0], pair[1]])))),
                );
            }
            Self::Packed10 => pixels.extend(upper(row, 5).take(width)),
            Self::Packed12 => pixels.extend(upper(row, 3).take(width)),
            Self::Yuyv => pixels.extend(row.iter().step_by(2)),
            Self::Uyvy => pixels.extend(row.iter().skip(1).step_by(2)),
        }
    }

    fn conversion(self) -> Option<Conversion> {
        match self {
            Self::Grey | Self::Jpeg => None,
            Self::Deep(bits) => Some(Conversion::Maximum((1 << bits) - 1)),
            Self::Packed10 => Some(Conversion::Maximum(1023)),
            Self::Packed12 => Some(Conversion::Maximum(4095)),
            Self::Yuyv | Self::Uyvy => Some(Conversion::LumaPlane),
        }
    }
}

/// The bytes with the upper bits: all but the last of each group, which holds the lower ones.
fn upper(row: &[u8], group: usize) -> impl Iterator<Item = u8> + '_ {
    row.chunks(group).flat_map(move |bytes| bytes.iter().copied().take(group - 1))
}

fn jpeg(bytes: &[u8], [width, height]: [usize; 2], name: &Path) -> Result<(GreyImage, Vec<Conversion>)> {
    // Drivers hand over the whole buffer: what comes after the end of the file is not of it.
    let end = bytes.windows(2).rposition(|pair| pair == [0xFF, 0xD9]).map_or(bytes.len(), |at| at + 2);
    let file = decode_image(&bytes[..end], name)?;
    let got = [file.image.width(), file.image.height()];
    if got != [width, height] {
        let reason = format!("a JPEG of {} x {} pixels came in place of {width} x {height}", got[0], got[1]);
        return Err(Error::format(name, reason));
    }
    Ok((file.image, file.conversions))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grey(format: PixelFormat, bytes: &[u8], size: [usize; 2], stride: usize) -> Vec<u8> {
        format.grey(bytes, size, stride, Path::new("t")).unwrap().0.pixels().to_vec()
    }

    #[test]
    fn codes_name_formats_and_the_best_is_taken_of_those_that_are_offered() {
        for (code, format) in CODES {
            assert_eq!(PixelFormat::of_code(std::str::from_utf8(code).unwrap()), Some(format));
        }
        assert_eq!(PixelFormat::of_code("Y8"), Some(PixelFormat::Grey));
        assert_eq!(PixelFormat::of_code("Y10"), Some(PixelFormat::Deep(10)));
        assert_eq!(PixelFormat::of_code("H264"), None);
        assert_eq!(PixelFormat::best([*b"MJPG", *b"H264", *b"YUYV"]), Some((*b"YUYV", PixelFormat::Yuyv)));
        assert_eq!(PixelFormat::best([*b"BA81"]), None);
        assert!(CODES.iter().all(|(_, format)| PixelFormat::best([format.code()]).unwrap().1 == *format));
    }

    #[test]
    fn gaps_between_rows_are_no_pixels() {
        let bytes = [1, 2, 3, 9, 9, 4, 5, 6];
        assert_eq!(grey(PixelFormat::Grey, &bytes, [3, 2], 5), [1, 2, 3, 4, 5, 6]);
        let luma = [10, 0, 20, 0, 9, 9, 30, 0, 40, 0];
        assert_eq!(grey(PixelFormat::Yuyv, &luma, [2, 2], 6), [10, 20, 30, 40]);
        assert_eq!(grey(PixelFormat::Uyvy, &[7, 10, 8, 20], [2, 1], 0), [10, 20]);
    }

    /// Samples of a depth, packed as MIPI says: upper bytes first, then the lower bits of the group, the first pixel's lowest.
    fn packed(samples: &[u32], bits: u32) -> Vec<u8> {
        let lower = bits - 8;
        let group = (8 / lower) as usize;
        samples
            .chunks(group)
            .flat_map(|four| {
                let upper =
                    four.iter().map(|sample| (sample >> lower) as u8).chain(std::iter::repeat(0)).take(group);
                let rest = four
                    .iter()
                    .enumerate()
                    .map(|(at, sample)| (sample & ((1 << lower) - 1)) << (at as u32 * lower));
                upper.chain([rest.sum::<u32>() as u8]).collect::<Vec<_>>()
            })
            .collect()
    }

    #[test]
    fn every_layout_of_a_depth_gives_the_same_grey_to_one_level() {
        for bits in [10_u32, 12, 14, 16] {
            let maximum = (1_u32 << bits) - 1;
            let samples: Vec<u32> = (0..64).map(|step| step * maximum / 63).collect();
            let nearest: Vec<f64> =
                samples.iter().map(|sample| f64::from(*sample) * 255.0 / f64::from(maximum)).collect();
            let loose: Vec<u8> = samples.iter().flat_map(|sample| (*sample as u16).to_le_bytes()).collect();
            let got = grey(PixelFormat::Deep(bits as u8), &loose, [8, 8], 0);
            assert!(
                got.iter().zip(&nearest).all(|(got, wanted)| (f64::from(*got) - wanted).abs() <= 0.5),
                "{bits}: {got:?}"
            );
            let packing = match bits {
                10 => PixelFormat::Packed10,
                12 => PixelFormat::Packed12,
                _ => continue,
            };
            // The lower bits are cut off: less than a level below, and a shift has 256 levels where a scale has 255.
            let got = grey(packing, &packed(&samples, bits), [8, 8], 0);
            assert!(
                got.iter().zip(&nearest).all(|(got, wanted)| (f64::from(*got) - wanted).abs() < 1.0),
                "{bits}: {got:?}"
            );
            assert_eq!((got[0], got[63]), (0, 255));
        }
    }

    #[test]
    fn a_packed_row_may_end_within_a_group() {
        let row = packed(&[4 * 11, 4 * 22, 4 * 33, 4 * 44, 4 * 55, 4 * 66], 10);
        assert_eq!(grey(PixelFormat::Packed10, &row, [6, 1], 0), [11, 22, 33, 44, 55, 66]);
    }

    #[test]
    fn samples_above_their_depth_are_its_maximum() {
        assert_eq!(grey(PixelFormat::Deep(10), &[0xFF, 0xFF, 0xFF, 0x03], [2, 1], 0), [255, 255]);
    }

    #[test]
    fn bytes_that_are_missing_are_an_error_and_no_layout_reads_past_them() {
        for (_, format) in CODES {
            for have in 0..40 {
                let read = format.grey(&vec![1; have], [7, 3], 0, Path::new("t"));
                let need = if format == PixelFormat::Jpeg { usize::MAX } else { 3 * format.row_bytes(7) };
                assert_eq!(read.is_ok(), have >= need, "{format:?}, {have} bytes");
            }
        }
    }

    #[test]
    fn a_jpeg_is_read_to_its_end_and_must_be_of_the_size() {
        // A grey JPEG of 8 x 8 pixels, all 128, with the shortest tables that a decoder takes.
        let mut file = vec![0xFF, 0xD8, 0xFF, 0xDB, 0, 67, 0];
        file.extend([1; 64]);
        file.extend([0xFF, 0xC0, 0, 11, 8, 0, 8, 0, 8, 1, 1, 0x11, 0]);
        for class in [0x00, 0x10] {
            file.extend([0xFF, 0xC4, 0, 20, class, 1]);
            file.extend([0; 15]);
            file.push(0);
        }
        file.extend([0xFF, 0xDA, 0, 8, 1, 1, 0, 0, 63, 0, 0x3F, 0xFF, 0xD9]);
        file.extend([0; 100]);
        assert_eq!(grey(PixelFormat::Jpeg, &file, [8, 8], 0), [128; 64]);
        assert!(PixelFormat::Jpeg.grey(&file, [16, 8], 0, Path::new("t")).is_err());
        assert!(PixelFormat::Jpeg.grey(&file[..60], [8, 8], 0, Path::new("t")).is_err());
    }
}
