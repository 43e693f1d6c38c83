//! A camera that sends JPEG: encoded with the quantisation tables of the standard, scaled as libjpeg does, and decoded as a file.

use image::ExtendedColorType;
use image::codecs::jpeg::JpegEncoder;
use photinus_io::image::{GreyImage, decode_image};
use photinus_io::{Error, Place, Result};

use super::Shot;

pub(super) fn apply(mut shot: Shot, quality: u8) -> Result<Shot> {
    let file = &shot.frame.source;
    let in_frame = |error: Error| error.at(Place::Frame(shot.frame.index));
    let bytes = encode(&shot.frame.image, quality).map_err(|reason| in_frame(Error::format(file, reason)))?;
    shot.frame.image = decode_image(&bytes, file).map_err(in_frame)?.image;
    Ok(shot)
}

/// The bytes of a grey JPEG, or why it cannot be made: a side of more than 65 535 px.
fn encode(image: &GreyImage, quality: u8) -> std::result::Result<Vec<u8>, String> {
    let side = |px: usize| u32::try_from(px).unwrap_or(u32::MAX);
    let mut bytes = Vec::new();
    JpegEncoder::new_with_quality(&mut bytes, quality)
        .encode(image.pixels(), side(image.width()), side(image.height()), ExtendedColorType::L8)
        .map_err(|error| format!("it cannot be a JPEG: {error}"))?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Waves and a little texture, 120 x 90: no side is a whole number of blocks.
    fn picture() -> GreyImage {
        let level = |i: usize| {
            let (u, v) = ((i % 120) as f64, (i / 120) as f64);
            let texture = ((i * 7919) % 13) as f64;
            (120.0 + 60.0 * libm::sin(0.11 * u) * libm::cos(0.17 * v) + texture) as u8
        };
        GreyImage::new((0..120 * 90).map(level).collect(), 120, 90).unwrap()
    }

    fn rms(a: &GreyImage, b: &GreyImage) -> f64 {
        let squares = a.pixels().iter().zip(b.pixels()).map(|(&a, &b)| (f64::from(a) - f64::from(b)).powi(2));
        (squares.sum::<f64>() / a.pixels().len() as f64).sqrt()
    }

    #[test]
    fn less_quality_is_fewer_bytes_and_more_error() {
        let image = picture();
        let of = |quality| {
            let bytes = encode(&image, quality).unwrap();
            let decoded = decode_image(&bytes, "frame.jpg").unwrap().image;
            assert_eq!((decoded.width(), decoded.height()), (120, 90));
            (bytes.len(), rms(&image, &decoded))
        };
        let [fine, middle, coarse] = [100, 50, 10].map(of);
        assert!(fine.0 > 2 * middle.0 && middle.0 > coarse.0, "{fine:?} {middle:?} {coarse:?}");
        assert!(fine.1 < 0.6 && fine.1 < middle.1 && middle.1 < coarse.1, "{fine:?} {middle:?} {coarse:?}");
    }

    /// The error of one coefficient that is rounded to steps of q is q^2 / 12 on average: of what has texture in every coefficient
    /// the mean squared error is the mean over the table.
    #[test]
    fn the_error_of_noise_is_that_of_the_standards_table() {
        // ISO/IEC 10918-1, table K.1: what a quality of 50 uses as it stands
        #[rustfmt::skip]
        let table = [
            16, 11, 10, 16, 24, 40, 51, 61, 12, 12, 14, 19, 26, 58, 60, 55, 14, 13, 16, 24, 40, 57, 69, 56, 14, 17, 22, 29, 51, 87, 80, 62,
            18, 22, 37, 56, 68, 109, 103, 77, 24, 35, 55, 64, 81, 104, 113, 92, 49, 64, 78, 87, 103, 121, 120, 101, 72, 92, 95, 98, 112, 100, 103, 99,
        ];
        // a coefficient of sigma s, rounded to whole steps: its mean squared error, by integration
        let sigma = 20.0_f64;
        let error = |step: f64| {
            let cells = 4000;
            (0..cells)
                .map(|cell| {
                    let x = 8.0 * sigma * ((f64::from(cell) + 0.5) / f64::from(cells) - 0.5);
                    let off = x - step * (x / step).round();
                    off * off * libm::exp(-0.5 * x * x / (sigma * sigma))
                })
                .sum::<f64>()
                * (8.0 * sigma / f64::from(cells))
                / (sigma * core::f64::consts::TAU.sqrt())
        };
        let expected = table.iter().map(|&step| error(f64::from(step))).sum::<f64>() / 64.0;
        let flat = GreyImage::new(vec![128; 512 * 512], 512, 512).unwrap();
        let noisy = super::super::noise::apply(&flat, sigma, &super::super::chance::Chance::new(3, 0));
        let decoded = decode_image(&encode(&noisy, 50).unwrap(), "frame.jpg").unwrap().image;
        let squared = rms(&noisy, &decoded).powi(2);
        assert!((squared / expected - 1.0).abs() < 0.03, "{squared} not {expected}");
    }
}
