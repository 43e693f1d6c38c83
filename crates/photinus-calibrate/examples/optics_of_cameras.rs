//! What is learned of the optics of rendered cameras against what they were rendered with (in brackets), a row each:
//!
//! ```text
//! cargo run --release -p photinus-calibrate --example optics_of_cameras [NAME...]
//! ```

#![allow(clippy::print_stdout, reason = "the table is what it is for")]

#[path = "../tests/calibrate/rendered_leds/mod.rs"]
mod rendered_leds;

use photinus::camera::Pixel;
use photinus_calibrate::optics::{Learned, learn};
use rendered_leds::{Eye, difference};

const FRAMES: u64 = 200;
const LEDS: usize = 6;
/// Places where the point spread is compared, in units of the image.
const PLACES: [[f64; 2]; 8] =
    [[0.5, 0.5], [0.25, 0.3], [0.75, 0.3], [0.3, 0.75], [0.7, 0.7], [0.1, 0.5], [0.9, 0.5], [0.5, 0.12]];
const WITHIN_PX: f64 = 3.0;

fn main() {
    let names: Vec<String> = std::env::args().skip(1).collect();
    println!(
        "| camera | spots | point spread: rms over summit (worst place), width | full pixels read, spread | read noise | shot noise | \
         error of shape | spill | unseen |\n|---|---|---|---|---|---|---|---|---|"
    );
    for world in photinus_sim::cameras::worlds() {
        if !names.is_empty() && !names.iter().any(|name| name == world.name) {
            continue;
        }
        let name = world.name;
        let eye = Eye::of(world);
        match learn(&eye.recorded(FRAMES, LEDS, 1)) {
            Ok(learned) => println!("| {name} | {} |", row(&eye, &learned)),
            Err(error) => println!("| {name} | {error} |"),
        }
    }
}

fn row(eye: &Eye, learned: &Learned) -> String {
    let (sensor, found) = (&eye.preset.sensor, &learned.optics.sensor);
    let per_dn = sensor.electrons_per_dn;
    let pattern = &sensor.pattern;
    let variances = [sensor.read_noise_e / per_dn, pattern.offset_dn, pattern.column_offset_dn];
    let read = variances.map(|sigma| sigma * sigma).iter().sum::<f64>().sqrt();
    let full = (sensor.full_well_e / per_dn + sensor.dark_offset_dn).min(255.0);
    let unseen: Vec<&str> = learned.unseen.iter().map(|unseen| unseen.name()).collect();
    let cells = [
        learned.spots.to_string(),
        spread(eye, learned),
        format!(
            "{:.2} ± {:.2} ({full:.1}), {:.2}",
            found.saturation.level_dn,
            learned.saturation_sigma_dn.unwrap_or(f64::NAN),
            found.saturation.spread_dn
        ),
        format!("{:.3} ± {:.3} ({read:.3})", found.read_noise_dn.value, found.read_noise_dn.sigma),
        format!("{:.4} ± {:.4} ({:.4})", found.shot.value, found.shot.sigma, 1.0 / per_dn),
        format!("{:.4} ± {:.4}", learned.optics.spread.shape_error(), learned.shape_error_sigma),
        format!("{:.2} ± {:.2} ({:.2})", found.spill.value, found.spill.sigma, sensor.overflow.spill),
        unseen.join(", "),
    ];
    cells.join(" | ")
}

/// The point spread against the true one.
fn spread(eye: &Eye, learned: &Learned) -> String {
    let (width, height) = (eye.camera.width() as f64, eye.camera.height() as f64);
    let places = PLACES.map(|[x, y]| [x * width, y * height]);
    let seen = places.into_iter().filter(|[u, v]| eye.camera.bearing(Pixel::new(*u, *v)).is_some());
    let of = |place: [f64; 2]| {
        let found = learned.optics.spread.at(Pixel::new(place[0], place[1]));
        difference(found, &eye.truth(place), WITHIN_PX)
    };
    let differences: Vec<(f64, f64)> = seen.map(of).collect();
    let count = differences.len() as f64;
    let rms = (differences.iter().map(|(rms, _)| rms * rms).sum::<f64>() / count).sqrt();
    let worst = differences.iter().map(|(rms, _)| *rms).fold(0.0, f64::max);
    let wide = differences.iter().map(|(_, wide)| wide.abs()).sum::<f64>() / count;
    format!("{:.2} % ({:.2} %), {:.2} %", 100.0 * rms, 100.0 * worst, 100.0 * wide)
}
