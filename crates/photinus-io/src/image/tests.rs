use std::io::Cursor;

use image::{DynamicImage, ImageFormat};
use photinus_testing::real_data;

use super::*;
use crate::scratch::{Folder, files_in};

fn ramp(width: u32, height: u32) -> image::GrayImage {
    image::GrayImage::from_fn(width, height, |u, v| image::Luma([(u * 7 + v * 13) as u8]))
}

fn encode(image: &DynamicImage, format: ImageFormat) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    image.write_to(&mut bytes, format).unwrap();
    bytes.into_inner()
}

fn grey(bytes: &[u8]) -> Vec<u8> {
    decode_image(bytes, "test").unwrap().image.pixels().to_vec()
}

#[test]
fn every_lossless_format_gives_the_pixels_back_whatever_its_name() {
    let image = ramp(37, 19);
    for format in [ImageFormat::Png, ImageFormat::Bmp, ImageFormat::Tiff, ImageFormat::Pnm] {
        let bytes = encode(&DynamicImage::ImageLuma8(image.clone()), format);
        assert_eq!(&grey(&bytes), image.as_raw(), "{format:?}");
    }
}

#[test]
fn no_cut_file_gives_an_image() {
    let image = DynamicImage::ImageLuma8(ramp(37, 19));
    for format in [ImageFormat::Png, ImageFormat::Bmp, ImageFormat::Tiff, ImageFormat::Pnm] {
        let bytes = encode(&image, format);
        // The last bytes of PNG and TIFF are bookkeeping, not pixels.
        for length in 0..bytes.len() * 9 / 10 {
            assert!(decode_image(&bytes[..length], "cut").is_err(), "{format:?} cut to {length}");
        }
    }
}

#[test]
fn the_message_of_a_cut_png_names_file_reason_and_advice() {
    let bytes = encode(&DynamicImage::ImageLuma8(ramp(37, 19)), ImageFormat::Png);
    let message = |bytes: &[u8]| decode_image(bytes, "a/b.png").unwrap_err().to_string();
    let cut = "a/b.png: the file ends before the end of the image; copy or record it again";
    assert_eq!(message(&bytes[..bytes.len() / 2]), cut);
    assert_eq!(message(&bytes[..20]), cut);
    let mut flipped = bytes.clone();
    flipped[bytes.len() / 2] ^= 4;
    assert!(message(&flipped).starts_with("a/b.png: the image is damaged: "), "{}", message(&flipped));
}

#[test]
fn equal_channels_are_taken_as_one_and_different_ones_as_luma() {
    let equal = DynamicImage::ImageLuma8(ramp(9, 5)).to_rgb8();
    let file = decode_image(&encode(&DynamicImage::ImageRgb8(equal), ImageFormat::Bmp), "t").unwrap();
    assert_eq!(file.conversions, [Conversion::EqualChannels]);
    assert_eq!(file.image.pixels(), ramp(9, 5).as_raw());

    let violet = image::RgbaImage::from_pixel(2, 1, image::Rgba([100, 0, 200, 255]));
    let file = decode_image(&encode(&DynamicImage::ImageRgba8(violet), ImageFormat::Png), "t").unwrap();
    assert_eq!(file.conversions, [Conversion::Luma, Conversion::Opacity]);
    assert_eq!(file.image.pixels(), [53, 53], "(77 * 100 + 29 * 200 + 128) / 256");
}

#[test]
fn sixteen_bit_is_divided_by_257_and_says_so() {
    let image = image::ImageBuffer::from_raw(3, 1, vec![0_u16, 257 * 100, 65_535]).unwrap();
    let file = decode_image(&encode(&DynamicImage::ImageLuma16(image), ImageFormat::Png), "t").unwrap();
    assert_eq!(file.image.pixels(), [0, 100, 255]);
    assert_eq!(file.conversions, [Conversion::SixteenBit { largest: 65_535 }]);
    assert!(Conversion::SixteenBit { largest: 1023 }.to_string().contains("leaves it dark"));
}

#[test]
fn a_pgm_is_scaled_by_its_maximum() {
    let ten_bit = [b"P5 3 1 1023\n".as_slice(), &[0, 0, 0x02, 0x00, 0x03, 0xff]].concat();
    let file = decode_image(&ten_bit, "t").unwrap();
    assert_eq!(file.image.pixels(), [0, 128, 255]);
    assert_eq!(file.conversions, [Conversion::Maximum(1023)]);
    assert_eq!(grey(b"P2\n# plain\n2 1\n15\n15 5\n"), [255, 85]);
    assert_eq!(grey(b"P1\n2 1\n1 0\n"), [0, 255]);
}

#[test]
fn sizes_no_camera_has_are_refused_before_they_are_allocated() {
    for header in
        ["P5 40000 1 255\n", "P5 32767 32767 255\n", "P5 0 4 255\n", "P5 4294967295 4294967295 255\n"]
    {
        assert!(decode_image(header.as_bytes(), "bomb").is_err(), "{header}");
    }
}

#[test]
fn what_is_no_image_is_told_what_would_be_one() {
    let message = decode_image(b"hello, this is text", "notes.png").unwrap_err().to_string();
    assert!(message.contains("use PNG, JPEG, BMP, TIFF or PGM/PPM"), "{message}");
    let mut compressed = encode(&DynamicImage::ImageLuma8(ramp(4, 4)), ImageFormat::Bmp);
    compressed[30] = 1;
    assert!(decode_image(&compressed, "t").unwrap_err().to_string().contains("run-length compressed"));
}

#[test]
fn a_png_written_is_read_back() {
    let folder = Folder::new("png");
    let path = folder.path().join("frame.png");
    let image = GreyImage::new((0..200).collect(), 20, 10).unwrap();
    write_png(&path, &image.view()).unwrap();
    assert_eq!(read_image(&path).unwrap(), ImageFile { image, conversions: vec![] });
    assert!(write_png(folder.path(), &GreyImage::new(vec![0], 1, 1).unwrap().view()).is_err());
}

#[test]
fn real_photographs_are_read_and_cut_ones_are_not() {
    let Some(data) = real_data("") else { return };
    let mut read = 0;
    for folder in ["grid-960x600", "grid-752x480", "masks"] {
        for path in files_in(&data.join(folder)) {
            let file = read_image(&path).unwrap();
            let size = (file.image.width(), file.image.height());
            assert!(matches!(size, (960, 600) | (752, 480)), "{path:?} {size:?}");
            // The channels of the BMP differ by one grey value: its converter rounded them apart.
            let is_bmp = path.extension().is_some_and(|extension| extension == "bmp");
            assert_eq!(file.conversions.contains(&Conversion::Luma), is_bmp, "{path:?}");
            read += 1;
        }
    }
    assert!(read > 0);
    let (png, bmp) = (data.join("grid-960x600/grid_02.png"), data.join("grid-960x600/grid_02_original.bmp"));
    assert_eq!(read_image(png).unwrap().image, read_image(bmp).unwrap().image);

    let jpeg = std::fs::read(data.join("grid-752x480/image_01.jpg")).unwrap();
    for cut in [1, 2, 3, 10, 100, 1000, jpeg.len() / 2, jpeg.len() - 10] {
        let message = decode_image(&jpeg[..jpeg.len() - cut], "t").unwrap_err().to_string();
        assert_eq!(message, "t: the file ends before the end of the image; copy or record it again");
    }
}

#[test]
fn no_damaged_jpeg_panics() {
    let Some(photo) = real_data("grid-752x480/image_01.jpg") else { return };
    let jpeg = std::fs::read(photo).unwrap();
    let mut state = 1_u64;
    let mut random = |below: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % below
    };
    for round in 0..200 {
        let mut damaged = jpeg.clone();
        // Every other time in the headers, which steer the decoder.
        let reach = if round % 2 == 0 { 700 } else { jpeg.len() };
        (0..3).for_each(|_| damaged[random(reach)] = random(256) as u8);
        let _ = decode_image(&damaged, "damaged");
    }
}
