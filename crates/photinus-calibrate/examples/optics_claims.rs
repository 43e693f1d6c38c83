//! Whether the sigmas of what is learned of a camera's optics are those of its errors: many recordings of each camera, a row for each number.
//!
//! ```text
//! cargo run --release -p photinus-calibrate --example optics_claims [SEEDS] [CAMERA...]
//! ```

#![allow(clippy::print_stdout, reason = "the table is what it is for")]

#[path = "../tests/calibrate/rendered_leds/mod.rs"]
mod rendered_leds;

use std::collections::BTreeMap;

use photinus::camera::Pixel;
use photinus::optics::Measured;
use photinus_calibrate::optics::{Learned, learn};
use photinus_sim::preset::{BLUEFOX_FIT, bluefox};
use photinus_sim::sensor::{ColumnSmear, Overflow, Pattern, Response};
use rendered_leds::Eye;

const SIZE: (usize, usize) = (320, 240);
const FRAMES: u64 = 150;
const LEDS: usize = 6;
const CEILING_DN: f64 = 400.0;

/// Claims of one number: what was found, of what was true.
type Claims = BTreeMap<&'static str, (f64, Vec<Measured>)>;

fn main() {
    let mut arguments = std::env::args().skip(1);
    let seeds: u64 = arguments.next().and_then(|text| text.parse().ok()).unwrap_or(20);
    let names: Vec<String> = arguments.collect();
    println!("| camera | number | true | mean | scatter | claimed sigma | squared error over claim | seen |");
    println!("|---|---|---|---|---|---|---|---|");
    for (name, eye) in eyes() {
        if !names.is_empty() && !names.iter().any(|wanted| wanted == name) {
            continue;
        }
        let mut claims = Claims::new();
        for seed in 0..seeds {
            let collection = if name == "turned" {
                eye.turned(2 * FRAMES, 20, 0.005, 100 + seed)
            } else {
                eye.recorded(FRAMES, LEDS, 100 + seed)
            };
            match learn(&collection) {
                Ok(learned) => take(&mut claims, &eye, &learned),
                Err(error) => println!("| {name} | {error} |"),
            }
        }
        claims.iter().for_each(|(number, (truth, found))| row(name, number, *truth, found, seeds));
    }
}

/// Cameras that excite what is to be learned.
fn eyes() -> Vec<(&'static str, Eye)> {
    let eye = |name: &str| Eye::named(name).cropped(SIZE.0, SIZE.1);
    let mut smeared = eye("gaussian-0.6");
    smeared.preset.sensor.smear = ColumnSmear { share: 2e-4 };
    smeared.preset.sensor.pattern = Pattern { offset_dn: 0.5, ..Pattern::NONE };
    smeared.hot = (0..12).map(|k| (20 + 23 * k, 15 + 17 * k, 6.0 * f64::from(1 + k as u32))).collect();
    let mut soft = eye("gaussian-0.6");
    soft.preset.sensor.response = Response::Soft { ceiling_dn: CEILING_DN };
    let mut spilling = eye("gaussian-0.4");
    spilling.preset.sensor.full_well_e = 240.0 * spilling.preset.sensor.electrons_per_dn;
    spilling.preset.sensor.overflow = Overflow { spill: 0.5 };
    let turned = Eye::named("vignette").small_and_wide();
    let dark_at_0 = Eye { preset: bluefox(&BLUEFOX_FIT), brightest_dn: 6000.0, ..eye("gaussian-0.6") };
    vec![
        ("dark_at_0", dark_at_0),
        ("plain", eye("gaussian-1.0")),
        ("sharp", eye("gaussian-0.4")),
        ("smeared", smeared),
        ("soft", soft),
        ("spilling", spilling),
        ("turned", turned),
    ]
}

fn take(claims: &mut Claims, eye: &Eye, learned: &Learned) {
    let (true_sensor, found) = (&eye.preset.sensor, &learned.optics.sensor);
    let per_dn = true_sensor.electrons_per_dn;
    let pattern = &true_sensor.pattern;
    let read = [true_sensor.read_noise_e / per_dn, pattern.offset_dn, pattern.column_offset_dn];
    let read = read.iter().map(|sigma| sigma * sigma).sum::<f64>().sqrt();
    let mut claim = |number, truth: f64, found: Option<Measured>| {
        let entry = claims.entry(number).or_insert((truth, Vec::new()));
        entry.1.extend(found);
    };
    let middle = [0.5 * SIZE.0 as f64, 0.5 * SIZE.1 as f64];
    let spread = &learned.optics.spread;
    let in_middle = spread.at(Pixel::new(middle[0], middle[1])).share(0.0, 0.0);
    let in_middle = Measured { value: in_middle, sigma: spread.shape_error() * in_middle };
    claim("light in the middle pixel", eye.truth(middle).share(0.0, 0.0), Some(in_middle));
    if found.full_well_dn.is_some() || true_sensor.full_well_e > 256.0 * per_dn {
        claim("full well", true_sensor.full_well_e / per_dn, found.full_well_dn);
    }
    claim("read noise", read, Some(found.read_noise_dn));
    claim("shot noise", 1.0 / per_dn, Some(found.shot));
    let full = (true_sensor.full_well_e / per_dn + true_sensor.dark_offset_dn).min(255.0);
    let level = |sigma| Measured { value: found.saturation.level_dn, sigma };
    claim("full pixels read", full, learned.saturation_sigma_dn.map(level));
    claim("spill", true_sensor.overflow.spill, learned.saturation_sigma_dn.map(|_| found.spill));
    claim("column smear", true_sensor.smear.share, found.column_smear);
    let bend = match true_sensor.response {
        Response::Linear => 0.0,
        Response::Soft { ceiling_dn } => 1.0 / ceiling_dn,
    };
    claim("bend of response", bend, found.response.map(|response| response.bend_per_dn));
    for (column, row, level_dn) in &eye.hot {
        let found = learned.optics.hot_pixels.at(*column as u32, *row as u32);
        // how far it is from its true level, over all of them
        let off = found.map(|hot| Measured { value: hot.level_dn.value - level_dn, ..hot.level_dn });
        claim("level of hot pixels", 0.0, off);
    }
    let false_alarms = learned.optics.hot_pixels.iter().filter(|hot| {
        !eye.hot.iter().any(|(column, row, _)| (hot.column, hot.row) == (*column as u32, *row as u32))
    });
    false_alarms.for_each(|hot| claim("hot pixels that are none", 0.0, Some(hot.level_dn)));
    let Some(vignetting) = &learned.optics.vignetting else { return };
    for (name, deg) in
        [("passes at 20 deg", 20.0_f64), ("passes at 40 deg", 40.0), ("passes at 60 deg", 60.0)]
    {
        let rad = deg.to_radians();
        if vignetting.table().0.last().is_some_and(|last| *last >= rad) {
            let (value, sigma) = vignetting.share(rad);
            claim(name, eye.preset.lens.illumination(rad), Some(Measured { value, sigma }));
        }
    }
}

fn row(camera: &str, number: &str, truth: f64, found: &[Measured], seeds: u64) {
    let count = found.len() as f64;
    if found.is_empty() {
        println!("| {camera} | {number} | {truth:.4} | | | | | 0 of {seeds} |");
        return;
    }
    let mean = found.iter().map(|found| found.value).sum::<f64>() / count;
    let scatter =
        found.iter().map(|found| (found.value - mean).powi(2)).sum::<f64>() / (count - 1.0).max(1.0);
    let claimed = found.iter().map(|found| found.sigma).sum::<f64>() / count;
    let squares = found.iter().map(|found| ((found.value - truth) / found.sigma.max(1e-12)).powi(2));
    let squares = squares.sum::<f64>() / count;
    let seen = found.len();
    println!(
        "| {camera} | {number} | {truth:.5} | {mean:.5} | {:.5} | {claimed:.5} | {squares:.2} | {seen} of {seeds} |",
        scatter.sqrt()
    );
}
