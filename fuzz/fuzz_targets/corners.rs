//! Any text as a table of corners: what is read has a photo, and numbers.
#![no_main]

use std::path::Path;

libfuzzer_sys::fuzz_target!(|text: &str| {
    match photinus_io::corners::parse_corners(text, Path::new("fuzz")) {
        Err(error) => assert!(!error.to_string().is_empty()),
        Ok(photos) => {
            assert!(!photos.is_empty());
            let mut corners = photos.iter().flat_map(|photo| &photo.corners);
            assert!(corners.all(|corner| corner.u.is_finite() && corner.v.is_finite()));
        }
    }
});
