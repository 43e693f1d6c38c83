//! Flights of neighbours whose LEDs shine as a power of the cosine, each with a power of its own, while their airframe files say
//! otherwise: distances in other frames before and after learning, and what was learned against what was rendered.
//!
//! ```text
//! cargo run --release -p photinus-calibrate --example airframe_light -- 500 1500 6 1001
//! ```
//! Numbers: frames to learn from, frames to try it on, flights, first seed.

#![allow(clippy::print_stdout, reason = "a program that reports")]

#[path = "../tests/calibrate/flight/mod.rs"]
mod flight;

use flight::{Built, Distances, distances, known, learn, powers_off};
use photinus::locator::Settings;

fn main() {
    let given: Vec<u64> = std::env::args().skip(1).filter_map(|word| word.parse().ok()).collect();
    let number = |place: usize, default: u64| given.get(place).copied().unwrap_or(default);
    let frames = [number(0, 500), number(1, 1500)];
    for airframe in ["hexarotor-0.4", "quadrotor-0.245"] {
        println!("{airframe}: lobes cos^3 and powers that spread by 20 %, told as equal cosines");
        println!(
            "seed    cosine power    powers off, claimed (%)   bias of distance (%), NEES: as told, learned, as built"
        );
        let mut all = [[0.0; 2]; 3];
        for seed in number(3, 1001)..number(3, 1001) + number(2, 6) {
            let built = Built { airframe, cosine_power: 3.0, spread: 0.2, misplaced_m: 0.0, seed };
            for (sums, row) in all.iter_mut().zip(row(&built, frames)) {
                *sums = [sums[0] + row.bias * row.frames as f64, sums[1] + row.frames as f64];
            }
        }
        let mean = all.map(|[sum, count]| format!("{:+.3}", 100.0 * sum / count));
        println!(
            "all     bias of distance (%): as told {}, learned {}, as built {}",
            mean[0], mean[1], mean[2]
        );
    }
}

fn row(built: &Built, [to_learn, to_try]: [u64; 2]) -> [Distances; 3] {
    let scene = built.flight(to_learn);
    let (light, others) = (learn(&scene), built.other_frames(to_try));
    let told = &scene.targets[0].airframe;
    let rows = [
        distances(&others, told, Settings::default()),
        distances(&others, &light.airframe, known(&light)),
        distances(&others, &built.as_built(told), known(&light)),
    ];
    let cosine = light.lobes[0].cosine_power.expect("a lobe that was seen");
    let (off, claimed) = powers_off(&light, built);
    let biases =
        rows.map(|of| format!("{:+.3} ± {:.3}, {:.1}", 100.0 * of.bias, 100.0 * of.bias_sigma, of.nees));
    println!(
        "{:<7} {:.3} ± {:.3}   {:.2}, {:.2}                {}",
        built.seed,
        cosine.value,
        cosine.sigma,
        100.0 * off,
        100.0 * claimed,
        biases.join("   ")
    );
    rows
}
