//! Any text as dataset.toml.
#![no_main]

libfuzzer_sys::fuzz_target!(|text: &str| {
    let _ = photinus_io::dataset::DatasetInfo::parse(text, "fuzz");
});
