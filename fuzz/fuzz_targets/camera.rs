//! Any bytes as a camera file of any format: what is read sees, and is written and read back.
#![no_main]

use std::path::Path;

use photinus::camera::Pixel;
use photinus_io::camera::{parse_camera, write_camera_toml};

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let path = Path::new("fuzz");
    match parse_camera(bytes, path) {
        Err(error) => assert!(!error.to_string().is_empty()),
        Ok(file) => {
            let corner = Pixel::new(file.camera.width() as f64 - 1.0, file.camera.height() as f64 - 1.0);
            for pixel in [Pixel::new(0.0, 0.0), Pixel::new(corner.u / 2.0, corner.v / 2.0), corner] {
                if let Some(bearing) = file.camera.bearing(pixel) {
                    assert!((bearing.vector().norm() - 1.0).abs() < 1e-9, "{pixel:?}: {bearing:?}");
                }
            }
            let mut toml = Vec::new();
            write_camera_toml(&file.camera, &mut toml, path).expect("a vector takes it");
            let again = parse_camera(&toml, path).expect("what was written is read");
            assert_eq!(again.camera, file.camera);
        }
    }
});
