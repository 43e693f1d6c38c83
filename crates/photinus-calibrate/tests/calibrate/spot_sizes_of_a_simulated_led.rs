//! A simulated LED that recedes: the curve of one recording bounds the spots of others, of other LEDs and other noise.

#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a test that cannot go on has failed; it shows its numbers"
)]

use std::path::Path;

use photinus::spots::{Brightness, Detector, Settings};
use photinus_calibrate::spot_size::{Sample, calibrate};
use photinus_sim::{Scene, Simulator};

/// Every n-th frame of the first half of the scene, in which the LED goes out.
const STEP: usize = 6;

fn recording(seed: u64) -> Vec<Sample> {
    let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/receding-led.toml"));
    let mut scene = Scene::read(path).unwrap();
    scene.set_seed(seed);
    let mut simulator = Simulator::new(&scene, 0).unwrap();
    let mut settings = Settings::default();
    settings.brightness = Brightness::Threshold(200);
    let mut detector = Detector::new(settings).unwrap();
    let frames = (0..scene.frames / 4).step_by(STEP);
    frames
        .map(|number| {
            let rendered = simulator.frame(number);
            let spots = &detector.detect(&rendered.image.view(), None).unwrap().spots;
            let largest = spots.iter().map(|spot| spot.area_px).max();
            Sample { distance_m: rendered.truth.neighbours[0].distance_m, area_px: largest.unwrap_or(0) }
        })
        .collect()
}

#[test]
fn the_curve_of_one_recording_bounds_another() {
    let found = calibrate(&recording(1), 0.2).unwrap();
    println!("{found:#?}");
    let upper = found.envelope.envelope;
    assert!((20.0..40.0).contains(&upper.scale_px_m2), "the paper's LED has 31.5: {upper:?}");
    for seed in [2, 3] {
        let other: Vec<Sample> = recording(seed).into_iter().filter(|sample| sample.area_px > 0).collect();
        assert!(other.len() > 100);
        for sample in &other {
            let range = found.curve.distances(sample.area_px).unwrap();
            assert!(sample.distance_m <= range.max_m(), "seed {seed}: {sample:?} {range:?}");
        }
        let worth = other
            .iter()
            .filter(|sample| sample.area_px > 20)
            .map(|sample| found.curve.distances(sample.area_px).unwrap().max_m() / sample.distance_m);
        assert!(worth.fold(1.0, f64::max) < 1.4, "a bound that is worth something");
    }
}
