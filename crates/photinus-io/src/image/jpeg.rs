//! JPEG, decoded strictly: the usual leniency paints the missing part of a cut file grey.

use zune_jpeg::JpegDecoder;
use zune_jpeg::zune_core::bytestream::ZCursor;
use zune_jpeg::zune_core::colorspace::ColorSpace;
use zune_jpeg::zune_core::options::DecoderOptions;

use super::decode::Samples;

/// Decodes a JPEG, or says why not.
pub(super) fn decode(bytes: &[u8], max_side: usize) -> Result<Samples<u8>, String> {
    let options =
        DecoderOptions::default().set_strict_mode(true).set_max_width(max_side).set_max_height(max_side);
    let mut decoder = JpegDecoder::new_with_options(ZCursor::new(bytes), options);
    decoder.decode_headers().map_err(|error| error.to_string())?;
    let channels = match decoder.input_colorspace() {
        Some(ColorSpace::Luma) => 1,
        _ => 3,
    };
    let colours = if channels == 1 { ColorSpace::Luma } else { ColorSpace::RGB };
    decoder.set_options(decoder.options().jpeg_set_out_colorspace(colours));
    let (width, height) = decoder.dimensions().ok_or("the header gives no size")?;
    super::decode::check_size(width, height)?;
    let values = decoder.decode().map_err(|error| error.to_string())?;
    if !has_end(bytes) {
        return Err("the file ends before the end of the image".to_owned());
    }
    Ok(Samples { values, channels, width, height, maximum: None })
}

/// Whether the image's data ends with an end marker. In it, 0xFF is followed by 0 or a restart, so both searches find
/// markers only; a thumbnail's end stands before the last start of scan.
fn has_end(bytes: &[u8]) -> bool {
    let scan = bytes.windows(2).rposition(|pair| pair == [0xff, 0xda]).unwrap_or(0);
    bytes[scan..].windows(2).any(|pair| pair == [0xff, 0xd9])
}
