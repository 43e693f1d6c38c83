//! Any text as blink sequences; what is read is written and read back.
#![no_main]

use photinus_io::blink::BlinkCodes;

libfuzzer_sys::fuzz_target!(|text: &str| {
    if let Ok(codes) = BlinkCodes::parse(text, "fuzz") {
        assert_eq!(BlinkCodes::parse(&codes.to_string(), "fuzz").expect("what was written is read"), codes);
    }
});
