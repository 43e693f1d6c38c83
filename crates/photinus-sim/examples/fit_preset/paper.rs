//! The paper's camera: figures 10 and 11 and equation (13).
//!
//! Five physical parameters are searched; the sixth, the light that passes lens and filter, follows in closed form from the
//! last two-pixel spot at 6.62 m.

use photinus_sim::preset::{BLUEFOX_FIT, Fitted, bluefox};
use photinus_sim::receding::RecedingLed;

use crate::search::{between, least};

const LAST_TWO_PX_M: f64 = 6.62;
#[allow(clippy::approx_constant, reason = "a distance, not a ratio")]
const FIRST_ONE_PX_M: f64 = 3.14;
const SINGLE_PIXEL_M: [(f64, f64); 6] =
    [(100.0, 2.12), (200.0, 3.23), (500.0, 5.06), (1000.0, 6.62), (2000.0, 8.34), (5000.0, 14.16)];
const ENVELOPE_M: [f64; 10] = [0.5, 0.6, 0.75, 0.9, 1.1, 1.3, 1.6, 2.0, 2.5, 3.0];

fn envelope_px(distance_m: f64) -> f64 {
    let shifted_m = distance_m - 0.0154;
    1.3398 + 31.4704 / (shifted_m * shifted_m)
}

fn experiment(fitted: &Fitted) -> RecedingLed {
    let preset = bluefox(fitted);
    RecedingLed {
        emitter: preset.emitter,
        lens: preset.lens,
        sensor: preset.sensor,
        rad_per_px: 3.7673e-3,
        threshold_dn: 200,
    }
}

/// Parameters from a point of the unit cube.
fn fitted(x: &[f64; 5]) -> Fitted {
    Fitted {
        core_px: between(x[0], 0.1, 0.6),
        skirt_share: between(x[1], 0.01, 0.7),
        skirt_px: between(x[2], 0.5, 5.0),
        well: between(x[3], 1.0, 12.0),
        spill: 1.0 - between(x[4], 1e-3, 1.0),
        transmission: 0.02,
    }
}

/// The same with the light that puts the last two-pixel spot where the paper has it.
fn with_light(mut fitted: Fitted) -> Fitted {
    let last_m = experiment(&fitted).last_two_px_m(1000.0);
    fitted.transmission *= (LAST_TWO_PX_M / last_m) * (LAST_TWO_PX_M / last_m);
    fitted
}

fn cost(fitted: &Fitted) -> f64 {
    let led = experiment(fitted);
    let first = libm::log(led.first_one_px_m(1000.0) / FIRST_ONE_PX_M);
    let mut sum = 400.0 * first * first;
    for distance_m in ENVELOPE_M {
        let wanted = envelope_px(distance_m);
        let places = [[0.0, 0.0], [0.5, 0.0], [0.5, 0.5], [0.25, 0.25], [0.25, 0.0]];
        let largest = places.iter().map(|&place| led.area_px(distance_m, 1000.0, place)).max().unwrap_or(0);
        let error = (f64::from(largest) - wanted) / (0.5 + 0.1 * wanted);
        sum += 0.1 * error * error;
    }
    sum
}

/// Searches, and prints what was found and what the preset as it stands gives.
pub(crate) fn fit() {
    let (cost, x) = least(|x| cost(&with_light(fitted(x))));
    println!("the paper's camera, found with a cost of {cost:.3}: {:#?}", with_light(fitted(&x)));
    println!("\nthe preset as it stands, {BLUEFOX_FIT:?}:\n");
    report(&experiment(&BLUEFOX_FIT));
}

fn report(led: &RecedingLed) {
    println!("| distance, 1000 us | smallest spot | largest spot | (13) |\n|---|---|---|---|");
    for distance_m in ENVELOPE_M {
        let areas = led.areas(distance_m, 1000.0);
        let paper_px = envelope_px(distance_m);
        println!("| {distance_m:.2} m | {} px | {} px | {paper_px:.1} px |", areas.min_px, areas.max_px);
    }
    println!("\n| exposure | last spot of 2 px | paper | difference |\n|---|---|---|---|");
    for (exposure_us, paper_m) in SINGLE_PIXEL_M {
        let last_m = led.last_two_px_m(exposure_us);
        let percent = 100.0 * (last_m / paper_m - 1.0);
        println!("| {exposure_us} us | {last_m:.2} m | {paper_m} m | {percent:+.0} % |");
    }
    println!("| 10000 us | {:.2} m | past 15 m | |", led.last_two_px_m(10_000.0));
    println!("\nfirst spot of 1 px at 1000 us: {:.2} m, paper 3.14 m", led.first_one_px_m(1000.0));
    println!("\n| threshold | every place in a pixel seen to | the best place to |\n|---|---|---|");
    for threshold_dn in [200, 120, 80, 50] {
        let led = RecedingLed { threshold_dn, ..led.clone() };
        let (always_m, last_m) = (led.last_always_seen_m(1000.0), led.last_seen_m(1000.0));
        println!("| {threshold_dn} | {always_m:.1} m | {last_m:.1} m |");
    }
}
