//! Any bytes as a raw stream of any small size: so many whole frames as there are, and an error for a rest.
#![no_main]

use photinus_io::video::{RawFormat, RawFrames};

libfuzzer_sys::fuzz_target!(|input: (u8, u8, &[u8])| {
    let (width, height, bytes) = (usize::from(input.0) + 1, usize::from(input.1) + 1, input.2);
    let format = RawFormat { width, height, rate_hz: Some(60.0) };
    let frames = RawFrames::new(bytes, "fuzz", format).expect("a size of frames");
    let whole = frames.filter(|frame| frame.is_ok()).count();
    assert_eq!(whole, bytes.len() / (width * height));
});
