//! From the bytes of an image file to 8-bit grey.

use std::io::{Cursor, ErrorKind};
use std::path::Path;

use image::codecs::pnm::{PnmDecoder, PnmSubtype, SampleEncoding};
use image::{ImageDecoder, ImageFormat, ImageReader, Limits};
use photinus::frame::FrameView;

use super::{Conversion, GreyImage, ImageFile, MAX_PIXELS, jpeg};
use crate::kind::Kind;
use crate::{Error, Result};

/// Decoded samples, interleaved: 1 grey, 2 grey and opacity, 3 colours, 4 colours and opacity.
pub(super) struct Samples<S> {
    pub(super) values: Vec<S>,
    pub(super) channels: usize,
    pub(super) width: usize,
    pub(super) height: usize,
    /// What the file says is the largest value, where it says so and the decoder has scaled by it.
    pub(super) maximum: Option<u32>,
}

/// Decodes the bytes of a still image; `path` is for the messages.
///
/// # Errors
/// As [`super::read_image`].
pub fn decode_image(bytes: &[u8], path: impl AsRef<Path>) -> Result<ImageFile> {
    let path = path.as_ref();
    // Decoders are other people's code, and bytes come from anybody: a panic of a decoder is treated as a bad file.
    std::panic::catch_unwind(|| decode(bytes, path)).unwrap_or_else(|payload| {
        let reason = format!("its decoder failed: {}", panic_reason(payload.as_ref()));
        Err(Error::format(path, reason).advise(RENEW))
    })
}

fn decode(bytes: &[u8], path: &Path) -> Result<ImageFile> {
    let refuse = |refused: Refused| match refused {
        Refused::Cut => Error::format(path, "the file ends before the end of the image").advise(RENEW),
        Refused::Damaged(reason) => {
            Error::format(path, format!("the image is damaged: {reason}")).advise(RENEW)
        }
        Refused::Unusable(reason) => {
            Error::format(path, reason).advise("use a frame as the camera gives it: see docs/file-formats.md")
        }
    };
    match image::guess_format(bytes) {
        Ok(ImageFormat::Jpeg) => jpeg::decode(bytes).and_then(to_grey).map_err(refuse),
        Ok(ImageFormat::Bmp) if run_length_coded(bytes) => {
            // Its decoder fills what is missing from a cut file with black.
            Err(refuse(Refused::Unusable("the BMP is run-length compressed".to_owned())))
        }
        Ok(format @ (ImageFormat::Png | ImageFormat::Bmp | ImageFormat::Tiff | ImageFormat::Pnm)) => {
            decode_as(bytes, format).map_err(refuse)
        }
        _ => Err(Kind::of_content(bytes).refuse(
            path,
            "an image",
            "use PNG, JPEG, BMP, TIFF or PGM/PPM; for video, Y4M",
        )),
    }
}

/// The message of a panic.
fn panic_reason(payload: &(dyn std::any::Any + Send)) -> &str {
    let text = payload.downcast_ref::<&str>().copied();
    text.or_else(|| payload.downcast_ref::<String>().map(String::as_str)).unwrap_or("it does not say why")
}

/// What to do about a file that is not what was written.
const RENEW: &str = "copy or record it again";

/// Why bytes give no image.
pub(super) enum Refused {
    Cut,
    Damaged(String),
    Unusable(String),
}

impl From<image::ImageError> for Refused {
    fn from(error: image::ImageError) -> Self {
        use image::ImageError as E;
        match error {
            E::IoError(error) if error.kind() == ErrorKind::UnexpectedEof => Self::Cut,
            E::Limits(_) => Self::Unusable(format!("it is larger than an image may be, {MAX_PIXELS} pixels")),
            E::Unsupported(error) => Self::Unusable(error.to_string()),
            error => Self::Damaged(error.to_string()),
        }
    }
}

fn run_length_coded(bmp: &[u8]) -> bool {
    matches!(bmp.get(30), Some(1 | 2))
}

fn decode_as(bytes: &[u8], format: ImageFormat) -> std::result::Result<ImageFile, Refused> {
    let maximum = match format {
        ImageFormat::Pnm => Some(pnm_maximum(bytes)?),
        _ => None,
    };
    let mut limits = Limits::default();
    let side = u32::try_from(FrameView::MAX_SIDE_PX).unwrap_or(u32::MAX);
    (limits.max_image_width, limits.max_image_height) = (Some(side), Some(side));
    limits.max_alloc = Some(4 * MAX_PIXELS as u64);
    let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
    reader.limits(limits);
    let image = reader.decode()?;
    let (width, height) = (image.width() as usize, image.height() as usize);
    let channels = usize::from(image.color().channel_count());
    check_size(width, height).map_err(Refused::Unusable)?;
    use image::ColorType::{L8, L16, La8, La16, Rgb8, Rgb16, Rgba8, Rgba16};
    match image.color() {
        L8 | La8 | Rgb8 | Rgba8 => {
            to_grey(Samples { values: image.into_bytes(), channels, width, height, maximum })
        }
        L16 | La16 | Rgb16 | Rgba16 => {
            let words = image.as_bytes().chunks_exact(2);
            let values = words.map(|word| u16::from_ne_bytes([word[0], word[1]])).collect();
            to_grey(Samples { values, channels, width, height, maximum })
        }
        _ => Err(Refused::Unusable("its samples are not integers of 8 or 16 bit".to_owned())),
    }
}

/// The largest sample that the header announces. The decoder clamps to it in silence; larger ones mean that the bytes are not
/// what the header says.
fn pnm_maximum(bytes: &[u8]) -> std::result::Result<u32, Refused> {
    let decoder = PnmDecoder::new(bytes)?;
    let (width, height) = decoder.dimensions();
    // Before the pixels: the decoder allocates by the header.
    check_size(width as usize, height as usize).map_err(Refused::Unusable)?;
    let (samples, header) = decoder.into_inner();
    let maximum = header.maximal_sample();
    let text = match header.subtype() {
        PnmSubtype::Bitmap(_) => return Ok(maximum),
        PnmSubtype::Graymap(encoding) | PnmSubtype::Pixmap(encoding) => encoding == SampleEncoding::Ascii,
        PnmSubtype::ArbitraryMap => false,
    };
    let largest = match (text, maximum) {
        (true, _) => samples
            .split(u8::is_ascii_whitespace)
            .filter_map(|word| std::str::from_utf8(word).ok()?.parse().ok())
            .max(),
        (false, ..=255) => samples.iter().copied().max().map(u32::from),
        (false, _) => {
            samples.chunks_exact(2).map(|word| u32::from(u16::from_be_bytes([word[0], word[1]]))).max()
        }
    };
    check_maximum(largest.unwrap_or(0), maximum, "the byte with the higher bits first")
        .map_err(Refused::Damaged)?;
    Ok(maximum)
}

/// Refuses samples above the maximum that their file announces; `order` is that of the bytes of a sample.
pub(crate) fn check_maximum(largest: u32, maximum: u32, order: &str) -> std::result::Result<(), String> {
    match largest <= maximum {
        true => Ok(()),
        false => {
            let hint =
                if maximum > 255 { format!("; samples of two bytes have {order}") } else { String::new() };
            Err(format!("a sample is {largest}, above the maximum of {maximum} that the file gives{hint}"))
        }
    }
}

/// Refuses what no frame may be.
pub(crate) fn check_size(width: usize, height: usize) -> std::result::Result<(), String> {
    let max = FrameView::MAX_SIDE_PX;
    if (1..=max).contains(&width) && (1..=max).contains(&height) && width * height <= MAX_PIXELS {
        return Ok(());
    }
    Err(format!("{width}x{height} pixels: each side must be 1 to {max}, {MAX_PIXELS} pixels in all"))
}

/// An unsigned sample of 8 or 16 bit.
trait Sample: Copy + Into<u32> {
    const LARGEST: u32;

    /// A number that is no larger than [`Self::LARGEST`].
    fn of(number: u32) -> Self;

    /// Samples scaled to 8 bit: those of 8 bit as they are.
    fn bytes(samples: Vec<Self>) -> Vec<u8>;
}

impl Sample for u8 {
    const LARGEST: u32 = 255;

    fn of(number: u32) -> Self {
        number as Self
    }

    fn bytes(samples: Vec<Self>) -> Vec<u8> {
        samples
    }
}

impl Sample for u16 {
    const LARGEST: u32 = 65_535;

    fn of(number: u32) -> Self {
        number as Self
    }

    fn bytes(samples: Vec<Self>) -> Vec<u8> {
        let byte = |sample| ((u32::from(sample) * 255 + Self::LARGEST / 2) / Self::LARGEST) as u8;
        samples.into_iter().map(byte).collect()
    }
}

fn to_grey<S: Sample>(samples: Samples<S>) -> std::result::Result<ImageFile, Refused> {
    let Samples { values, channels, width, height, maximum } = samples;
    let mut conversions = Vec::new();
    let grey: Vec<S> = match channels {
        1 => values,
        2 => values.chunks_exact(2).map(|pixel| pixel[0]).collect(),
        _ => {
            let colours =
                values.chunks_exact(channels).map(|pixel| [pixel[0], pixel[1], pixel[2]].map(Into::into));
            let equal = colours.clone().all(|[r, g, b]: [u32; 3]| r == g && g == b);
            conversions.push(if equal { Conversion::EqualChannels } else { Conversion::Luma });
            let luma = |[r, g, b]: [u32; 3]| if equal { r } else { (77 * r + 150 * g + 29 * b + 128) / 256 };
            colours.map(|colour| S::of(luma(colour))).collect()
        }
    };
    if channels % 2 == 0 {
        conversions.push(Conversion::Opacity);
    }
    match maximum {
        Some(maximum) if maximum != S::LARGEST => conversions.push(Conversion::Maximum(maximum)),
        _ if S::LARGEST > 255 => {
            let largest = grey.iter().map(|&sample| sample.into()).max().unwrap_or(0);
            conversions.push(Conversion::SixteenBit { largest: u16::try_from(largest).unwrap_or(u16::MAX) });
        }
        _ => {}
    }
    let pixels = S::bytes(grey);
    let image = GreyImage::new(pixels, width, height).map_err(|error| Refused::Damaged(error.to_string()))?;
    Ok(ImageFile { image, conversions })
}
