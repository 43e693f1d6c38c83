//! Any text as a table of a calibration or as a mounting; a mounting that is read is written and read back.
#![no_main]

use photinus_io::calibration::{
    mounting_text, parse_known_sightings, parse_led_sightings, parse_mounting, parse_spot_sizes,
};

libfuzzer_sys::fuzz_target!(|bytes: &str| {
    let _ = parse_spot_sizes(bytes, "fuzz");
    let _ = parse_known_sightings(bytes, "fuzz");
    let _ = parse_led_sightings(bytes, "fuzz");
    if let Ok(file) = parse_mounting(bytes, "fuzz") {
        assert_eq!(parse_mounting(&mounting_text(&file), "fuzz").expect("what was written is read"), file);
    }
});
