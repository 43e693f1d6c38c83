//! Any bytes as a still image.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let _ = photinus_io::image::decode_image(bytes, "fuzz");
});
