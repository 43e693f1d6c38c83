//! Any text as a spot curve; what is read is written and read back.
#![no_main]

use photinus_io::spot_curve::{parse_spot_curve, text};

libfuzzer_sys::fuzz_target!(|bytes: &str| {
    if let Ok(file) = parse_spot_curve(bytes, "fuzz") {
        assert_eq!(parse_spot_curve(&text(&file), "fuzz").expect("what was written is read"), file);
    }
});
