//! Still images: enters a PNG, JPEG, BMP, TIFF or PNM file, leaves an owned 8-bit grey frame and a list of what was
//! done to get it.
//!
//! The format is told by the content, never by the name. A truncated or corrupt file is an error, never a partial
//! image: a frame whose lower half is missing would look like a sky without neighbours. Pixels are taken as stored;
//! an orientation in EXIF is not applied, because a camera model belongs to the stored pixels.

mod decode;
mod grey;
mod jpeg;

use std::fmt;
use std::path::Path;

use photinus::frame::FrameView;

use crate::{Error, Result, whole};
pub use decode::decode_image;
pub(crate) use decode::{check_maximum, check_size};
pub use grey::GreyImage;

/// Most pixels of an image or video frame: a file of a few bytes cannot ask for all the memory.
pub const MAX_PIXELS: usize = 1 << 27;

/// A still image as read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ImageFile {
    /// The grey frame.
    pub image: GreyImage,
    /// What was done to the stored samples to get it; empty for 8-bit grey.
    pub conversions: Vec<Conversion>,
}

/// What was done to stored samples to get 8-bit grey.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Conversion {
    /// Three equal channels, as UV cameras behind a colour driver give: one was taken.
    EqualChannels,
    /// Channels that differ: replaced by their luma, (77 R + 150 G + 29 B) / 256 (ITU-R BT.601).
    Luma,
    /// The luma plane of a video in colour was taken, its chroma ignored.
    LumaPlane,
    /// Luma of 16 to 235 stretched to 0 to 255.
    LimitedRange,
    /// An opacity channel was ignored.
    Opacity,
    /// 16-bit samples that name no maximum, divided by 257.
    SixteenBit {
        /// The largest sample of the image.
        largest: u16,
    },
    /// Samples with a maximum of their own, scaled so that it becomes 255.
    Maximum(u32),
}

impl fmt::Display for Conversion {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::EqualChannels => write!(f, "colour with three equal channels: one was taken"),
            Self::Luma => write!(f, "colour with different channels: their luma was taken"),
            Self::LumaPlane => write!(f, "colour video: its luma was taken"),
            Self::LimitedRange => write!(f, "luma of 16 to 235, stretched to 0 to 255"),
            Self::Opacity => write!(f, "the opacity channel was ignored"),
            Self::SixteenBit { largest: largest @ ..4096 } => write!(
                f,
                "16 bit, divided by 257, which leaves it dark: no sample is above {largest}; \
                 save frames of a 10- or 12-bit camera as PGM with that maximum"
            ),
            Self::SixteenBit { .. } => write!(f, "16 bit, divided by 257"),
            Self::Maximum(maximum) => write!(f, "samples of 0 to {maximum}, scaled to 0 to 255"),
        }
    }
}

/// Reads a still image; `-` is standard input.
///
/// # Errors
/// [`Error`] when the file cannot be read, is in none of the formats, is cut or corrupt, or is larger than
/// [`FrameView::MAX_SIDE_PX`] on a side or [`MAX_PIXELS`] in all.
pub fn read_image(path: impl AsRef<Path>) -> Result<ImageFile> {
    let path = path.as_ref();
    decode_image(&whole::read_bytes(path)?, path)
}

/// Writes a frame as an 8-bit grey PNG.
///
/// # Errors
/// [`Error`] when the file cannot be written.
pub fn write_png(path: impl AsRef<Path>, frame: &FrameView<'_>) -> Result<()> {
    let path = path.as_ref();
    whole::write_whole(path, &png_bytes(path, frame)?, whole::Existing::Replace)
}

/// The bytes of a grey PNG; `path` is for the messages.
///
/// # Errors
/// [`Error`] for a frame that is too large for PNG.
pub fn png_bytes(path: impl AsRef<Path>, frame: &FrameView<'_>) -> Result<Vec<u8>> {
    let image = GreyImage::from_view(frame);
    let mut bytes = Vec::new();
    let side = |px: usize| u32::try_from(px).unwrap_or(u32::MAX);
    ::image::ImageEncoder::write_image(
        ::image::codecs::png::PngEncoder::new(&mut bytes),
        image.pixels(),
        side(image.width()),
        side(image.height()),
        ::image::ExtendedColorType::L8,
    )
    .map_err(|error| Error::format(path, error.to_string()))?;
    Ok(bytes)
}

#[cfg(test)]
mod tests;
