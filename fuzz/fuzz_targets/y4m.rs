//! Any bytes as a Y4M stream.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    if let Ok(frames) = photinus_io::video::Y4mFrames::new(bytes, "fuzz") {
        frames.for_each(drop);
    }
});
