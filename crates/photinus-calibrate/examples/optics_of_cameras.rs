//! What is learned of the optics of rendered cameras against what they were rendered with, a row each:
//!
//! ```text
//! cargo run --release -p photinus-calibrate --example optics_of_cameras [NAME...]
//! ```

#[path = "../tests/rendered_leds/mod.rs"]
mod rendered_leds;

use photinus::camera::Pixel;
use photinus_calibrate::optics::learn;
use rendered_leds::{Eye, difference};

const FRAMES: u64 = 200;
const LEDS: usize = 6;

fn main() {
    let names: Vec<String> = std::env::args().skip(1).collect();
    println!(
        "| camera | spots | point spread, rms over summit (worst place) | width | full pixel reads | its spread | read noise | shot noise | error of shape | unseen |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|");
    for world in photinus_sim::cameras::worlds() {
        if !names.is_empty() && !names.iter().any(|chosen| chosen == world.name) {
            continue;
        }
        let name = world.name;
        let eye = Eye::of(world);
        let start = std::time::Instant::now();
        let collection = eye.recorded(FRAMES, LEDS, 1);
        let rendered_s = start.elapsed().as_secs_f64();
        let learned = match learn(&collection) {
            Ok(learned) => learned,
            Err(error) => {
                println!("| {} | {error} |", name);
                continue;
            }
        };
        let learned_s = start.elapsed().as_secs_f64() - rendered_s;
        let (width, height) = (eye.camera.width() as f64, eye.camera.height() as f64);
        let mut rows = Vec::new();
        for (x, y) in [
            (0.5, 0.5),
            (0.25, 0.3),
            (0.75, 0.3),
            (0.3, 0.75),
            (0.7, 0.7),
            (0.1, 0.5),
            (0.9, 0.5),
            (0.5, 0.12),
        ] {
            let place = [x * width, y * height];
            if eye.camera.bearing(Pixel::new(place[0], place[1])).is_none() {
                continue;
            }
            let found = learned.optics.spread.at(Pixel::new(place[0], place[1]));
            rows.push(difference(found, &eye.truth(place), 3.0));
        }
        let count = rows.len() as f64;
        let rms = (rows.iter().map(|row| row.0 * row.0).sum::<f64>() / count).sqrt();
        let worst = rows.iter().map(|row| row.0).fold(0.0, f64::max);
        let wide = rows.iter().map(|row| row.1.abs()).sum::<f64>() / count;
        let sensor = &eye.preset.sensor;
        let per = sensor.electrons_per_dn;
        let found = &learned.optics.sensor;
        let pattern = &sensor.pattern;
        let read = ((sensor.read_noise_e / per).powi(2)
            + pattern.offset_dn.powi(2)
            + pattern.column_offset_dn.powi(2))
        .sqrt();
        let full = sensor.full_well_e / per + sensor.dark_offset_dn;
        let unseen: Vec<&str> = learned.unseen.iter().map(|unseen| unseen.name()).collect();
        println!(
            "| {} | {} | {:.2} % ({:.2} %) | {:.2} % | {:.2} ± {:.2} ({:.1}) | {:.2} | {:.3} ± {:.3} ({read:.3}) | {:.4} ± {:.4} ({:.4}) | {:.4} ± {:.4} | {:.2} ± {:.2} ({:.2}){} | {} |",
            name,
            learned.spots,
            100.0 * rms,
            100.0 * worst,
            100.0 * wide,
            found.saturation.level_dn,
            learned.saturation_sigma_dn.unwrap_or(f64::NAN),
            full.min(255.0),
            found.saturation.spread_dn,
            found.read_noise_dn.value,
            found.read_noise_dn.sigma,
            found.shot.value,
            found.shot.sigma,
            1.0 / per,
            learned.optics.spread.shape_error(),
            learned.shape_error_sigma,
            found.spill.value,
            found.spill.sigma,
            sensor.overflow.spill,
            found.full_well_dn.map_or(String::new(), |well| format!(" well {:.0}", well.value)),
            unseen.join(", ")
        );
        eprintln!("{}: rendered in {rendered_s:.1} s, learned in {learned_s:.1} s", name);
    }
}
