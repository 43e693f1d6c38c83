//! How fast frames are rendered on one core, and where the time goes.
//!
//! `cargo bench -p photinus-sim`: frames of 752x480 with twelve hexarotors; then the same without the targets' light (background,
//! noise and reading alone), and the reading of dark rows alone.

#![allow(clippy::print_stdout, reason = "a program that reports")]

use std::hint::black_box;
use std::path::Path;
use std::time::Instant;

use photinus_sim::sensor::{Background, Charge, Readout};
use photinus_sim::{Scene, Simulator};

const FRAMES: u64 = 300;

/// Milliseconds per frame: the least of five rounds, which other programs disturb least.
fn least_ms(mut round: impl FnMut()) -> f64 {
    let mut time = || {
        let start = Instant::now();
        round();
        start.elapsed().as_secs_f64() * 1e3 / FRAMES as f64
    };
    (0..5).map(|_| time()).fold(f64::INFINITY, f64::min)
}

fn main() {
    let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/swarm-12.toml"));
    let scene = Scene::read(path).unwrap_or_else(|error| panic!("{error}"));
    let mut empty = scene.clone();
    empty.targets.clear();
    let frames = |scene: &Scene| {
        let mut simulator = Simulator::new(scene, 0).expect("a scene has a camera");
        least_ms(|| (0..FRAMES).for_each(|number| drop(black_box(simulator.frame(number)))))
    };
    let (all_ms, empty_ms) = (frames(&scene), frames(&empty));
    let (background, charge) = (Background::new(752, 480), Charge::new(752, 480));
    let mut readout = Readout::new(&scene.preset.sensor);
    let mut pixels = vec![0; 752 * 480];
    let dark_ms = least_ms(|| {
        for key in 0..FRAMES {
            for (v, row) in pixels.chunks_exact_mut(752).enumerate() {
                readout.read_row(v, &background, &charge, key, row);
            }
            black_box(&mut pixels);
        }
    });
    println!("12 hexarotors, sky and sun  {all_ms:6.3} ms  {:7.0} frames/s", 1e3 / all_ms);
    println!("  markers                   {:6.3} ms", all_ms - empty_ms);
    println!("  sky, sun, poses           {:6.3} ms", empty_ms - dark_ms);
    println!("  noise and reading         {dark_ms:6.3} ms  {:7.3} ns/px", dark_ms * 1e6 / (752.0 * 480.0));
}
