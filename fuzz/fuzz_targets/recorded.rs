//! Any text as a recorded motion: what is read has a pose at every time.
#![no_main]

use std::path::Path;

use photinus_sim::motion::Recorded;

libfuzzer_sys::fuzz_target!(|text: &str| {
    match Recorded::parse(text, Path::new("fuzz")) {
        Err(error) => assert!(!error.to_string().is_empty()),
        Ok(recorded) => {
            let first = recorded.pose(-1e9);
            assert!(first.translation.vector.iter().all(|number| number.is_finite()), "{first:?}");
            let _ = [0.0, 0.25, 1e9].map(|time_s| recorded.pose(time_s));
        }
    }
});
