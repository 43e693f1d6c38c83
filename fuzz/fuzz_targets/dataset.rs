//! Any text as dataset.toml and vehicles.toml; vehicles that are read are written and read back.
#![no_main]

use photinus_io::dataset::{DatasetToml, parse_vehicles, vehicles_text};

libfuzzer_sys::fuzz_target!(|text: &str| {
    let _ = DatasetToml::parse(text, "fuzz");
    if let Ok(vehicles) = parse_vehicles(text, "fuzz") {
        assert_eq!(
            parse_vehicles(&vehicles_text(&vehicles), "fuzz").expect("what was written is read"),
            vehicles
        );
    }
});
