//! A small camera on a single-board computer: photos of a board of 35 UV LEDs, 960x600.
//!
//! What is fitted is a count: pixels per LED at or above a level, for photos from several distances. Exposure and LED current are
//! not known, so that the light that passes stands for them, too.

use photinus_sim::preset::{SMALL_FISHEYE_FIT, SmallFisheyeFit, small_fisheye};
use photinus_sim::receding::RecedingLed;

use crate::search::{between, least};

const LEVELS_DN: [u8; 8] = [60, 90, 125, 160, 190, 205, 220, 240];
/// Distance of the board, angle off the axis, pixels per LED at or above each level.
const PHOTOS: [(f64, f64, [f64; 8]); 4] = [
    (1.68, 6.0, [21.9, 17.5, 13.9, 10.5, 5.7, 1.5, 0.1, 0.0]),
    (1.17, 23.0, [28.8, 23.7, 19.5, 16.4, 13.7, 11.4, 9.5, 6.0]),
    (0.92, 21.0, [27.9, 23.7, 19.4, 16.3, 13.4, 12.2, 11.0, 8.1]),
    (0.52, 41.0, [42.7, 32.5, 27.6, 22.9, 19.0, 17.2, 15.9, 13.3]),
];

fn fitted(x: &[f64; 5]) -> SmallFisheyeFit {
    SmallFisheyeFit {
        core_px: between(x[0], 0.4, 2.0),
        skirt_share: between(x[1], 0.003, 0.3),
        skirt_px: between(x[2], 1.5, 8.0),
        ceiling_dn: between(x[3], 190.0, 400.0),
        transmission: between(x[4], 1e-4, 1.0),
    }
}

/// Pixels at or above a level, mean over places in a pixel.
fn area_px(fit: &SmallFisheyeFit, distance_m: f64, off_axis_deg: f64, threshold_dn: u8) -> f64 {
    let preset = small_fisheye(fit);
    let illumination = preset.lens.illumination(off_axis_deg.to_radians());
    let led = RecedingLed {
        emitter: preset.emitter,
        lens: preset.lens,
        sensor: preset.sensor,
        rad_per_px: 2.15e-3,
        threshold_dn,
    };
    let places = [[0.0, 0.0], [0.5, 0.0], [0.25, 0.25], [0.5, 0.5], [0.25, 0.0], [0.5, 0.25]];
    let sum: u32 = places.iter().map(|&place| led.area_px(distance_m, 1000.0 * illumination, place)).sum();
    f64::from(sum) / places.len() as f64
}

fn cost(fit: &SmallFisheyeFit) -> f64 {
    let mut sum = 0.0;
    for (distance_m, off_axis_deg, counts) in PHOTOS {
        for (level_dn, count) in LEVELS_DN.into_iter().zip(counts) {
            let error = (area_px(fit, distance_m, off_axis_deg, level_dn) - count) / (1.0 + 0.1 * count);
            sum += error * error;
        }
    }
    sum
}

/// Searches, and prints what was found and what the preset as it stands gives.
pub(crate) fn fit() {
    let (least_cost, x) = least(|x| cost(&fitted(x)));
    println!("\nthe camera of the photos, found with a cost of {least_cost:.2}: {:#?}", fitted(&x));
    println!("\nthe preset as it stands, {SMALL_FISHEYE_FIT:?}, cost {:.2}:\n", cost(&SMALL_FISHEYE_FIT));
    println!("| photo | {} |", LEVELS_DN.map(|level| format!("at {level}")).join(" | "));
    println!("|---|{}", "---|".repeat(LEVELS_DN.len()));
    for (distance_m, off_axis_deg, counts) in PHOTOS {
        let cell = |(level_dn, count): (u8, f64)| {
            format!("{:.1} / {count}", area_px(&SMALL_FISHEYE_FIT, distance_m, off_axis_deg, level_dn))
        };
        let cells: Vec<String> = LEVELS_DN.into_iter().zip(counts).map(cell).collect();
        println!("| {distance_m} m, {off_axis_deg} deg | {} |", cells.join(" | "));
    }
}
