//! Any text as an airframe of either form; what is read is written and read back.
#![no_main]

use photinus_io::airframe::{parse_airframe, toml_text};

libfuzzer_sys::fuzz_target!(|text: &str| {
    if let Ok(file) = parse_airframe(text, "fuzz") {
        let again = parse_airframe(&toml_text(&file.airframe, &file.tolerances), "fuzz")
            .expect("what was written is read");
        assert_eq!(again.airframe, file.airframe);
    }
});
