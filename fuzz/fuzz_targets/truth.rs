//! Any text as truth.jsonl.
#![no_main]

libfuzzer_sys::fuzz_target!(|text: &str| {
    let _ = photinus_io::dataset::parse_truth(text, "fuzz");
});
