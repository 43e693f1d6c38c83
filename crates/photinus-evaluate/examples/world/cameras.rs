//! The camera table: lenses and sensors that differ from the paper's in one thing or in many.

use std::path::Path;

use photinus_sim::optics::{Gaussian, PointSpread};
use photinus_sim::preset::{BLUEFOX_FIT, Preset, SMALL_FISHEYE_FIT, bluefox, small_fisheye};

use crate::row::{Eye, Row};

/// The paper's camera.
pub(crate) fn paper() -> Eye {
    Eye { camera: camera("bluefox-dsl215"), preset: bluefox(&BLUEFOX_FIT), exposure_us: 1000.0 }
}

fn camera(name: &str) -> photinus::camera::Camera {
    let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/cameras"));
    photinus_io::read_camera(&folder.join(format!("{name}.toml"))).expect("a camera of the library").camera
}

/// The rows.
pub(crate) fn rows() -> Vec<Row> {
    let of_paper = |name: &'static str, exposure_us: f64, change: fn(&mut Preset)| {
        let mut eye = Eye { exposure_us, ..paper() };
        change(&mut eye.preset);
        (name, eye)
    };
    let fisheye = Eye {
        camera: camera("small-fisheye-960x600"),
        preset: small_fisheye(&SMALL_FISHEYE_FIT),
        exposure_us: 5000.0,
    };
    let eyes = [
        of_paper("the paper's", 1000.0, |_| ()),
        of_paper("three times the exposure", 3000.0, |_| ()),
        of_paper("core of 0.5 px", 1000.0, |preset| {
            preset.lens.spread = spread([(0.5085, 0.5), (0.4915, 2.239)])
        }),
        of_paper("a fifth in a skirt of 3 px", 1000.0, |preset| {
            preset.lens.spread = spread([(0.8, 0.35), (0.2, 3.0)])
        }),
        of_paper("well that reads 240", 1000.0, |preset| {
            preset.sensor.full_well_e = 240.0 * preset.sensor.electrons_per_dn;
        }),
        of_paper("five times the gain", 200.0, |preset| {
            preset.sensor.electrons_per_dn /= 5.0;
            preset.sensor.full_well_e /= 5.0;
        }),
        of_paper("read noise of 2 levels", 1000.0, |preset| preset.sensor.read_noise_e *= 4.0),
        ("small fisheye", fisheye),
    ];
    let rows = eyes.iter().flat_map(|(name, eye)| [6, 4].map(|arms| Row::plain(*name, eye, arms)));
    rows.collect()
}

fn spread(parts: [(f64, f64); 2]) -> PointSpread {
    let part = |(share, sigma_px)| Gaussian { share, sigma_px };
    PointSpread::new(parts.map(part).to_vec(), 0.1).expect("shares that sum to 1")
}
