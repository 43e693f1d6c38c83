//! Any text as frames.csv.
#![no_main]

libfuzzer_sys::fuzz_target!(|text: &str| {
    let _ = photinus_io::dataset::parse_frames_csv(text, "fuzz");
});
