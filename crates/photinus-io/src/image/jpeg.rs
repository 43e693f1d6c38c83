//! JPEG, decoded strictly: the usual leniency paints the missing part of a cut file grey.

use zune_jpeg::JpegDecoder;
use zune_jpeg::errors::DecodeErrors;
use zune_jpeg::zune_core::bytestream::ZCursor;
use zune_jpeg::zune_core::colorspace::ColorSpace;
use zune_jpeg::zune_core::options::DecoderOptions;

use super::decode::{Refused, Samples, check_size};

/// Decodes a JPEG, or says why not.
pub(super) fn decode(bytes: &[u8]) -> Result<Samples<u8>, Refused> {
    if !has_end(bytes) {
        return Err(Refused::Cut);
    }
    let damaged = |error: DecodeErrors| Refused::Damaged(error.to_string().trim().to_owned());
    let options = DecoderOptions::default().set_strict_mode(true);
    let options = options.set_max_width(usize::MAX).set_max_height(usize::MAX);
    let mut decoder = JpegDecoder::new_with_options(ZCursor::new(bytes), options);
    decoder.decode_headers().map_err(damaged)?;
    let (width, height) = decoder.dimensions().unwrap_or_default();
    check_size(width, height).map_err(Refused::Unusable)?;
    let (channels, colours) = match decoder.input_colorspace() {
        Some(ColorSpace::Luma) => (1, ColorSpace::Luma),
        _ => (3, ColorSpace::RGB),
    };
    decoder.set_options(decoder.options().jpeg_set_out_colorspace(colours));
    let values = decoder.decode().map_err(damaged)?;
    Ok(Samples { values, channels, width, height, maximum: None })
}

/// Whether the image's data ends with an end marker. In it, 0xFF is followed by 0 or a restart, so both searches find
/// markers only; a thumbnail's end stands before the last start of scan.
fn has_end(bytes: &[u8]) -> bool {
    let scan = bytes.windows(2).rposition(|pair| pair == [0xff, 0xda]).unwrap_or(0);
    bytes[scan..].windows(2).any(|pair| pair == [0xff, 0xd9])
}
