//! The table's fit on samples whose law is known, and the table that the program carries.

use super::fit::{Phantoms, Sample, Told, fit, name_s, spot_law};
use super::*;

/// Errors of a known law: sigma 0.2 that lasts 1 s, followed three quarters of the time for 2 s at once.
fn samples() -> Vec<Sample> {
    let mut chance = Chance::new(9, Use::Seeing, 1);
    let (period_s, mut error, mut is_followed) = (0.05, 0.0, true);
    let keeps = libm::exp(-period_s / 1.0_f64);
    let dies = 1.0 - libm::exp(-period_s / 2.0_f64);
    (0..60_000)
        .map(|frame| {
            error = error * keeps + chance.normal() * (1.0 - keeps * keeps).sqrt();
            let draw = chance.uniform();
            is_followed = if is_followed { draw >= dies } else { draw < 3.0 * dies };
            let light = 100.0 + 50.0 * chance.uniform();
            let told = Told {
                log_range: 0.05 + 0.2 * error,
                across_rad: [0.002 * chance.normal(), 0.002 * chance.normal()],
                range_sigma: 0.25,
                across_sigma_rad: 0.003,
                velocity_m_s: [chance.normal(), chance.normal(), chance.normal()],
                velocity_sigma_m_s: 1.1,
                // lower bounds are spread evenly, and stay for 40 frames
                log_bounds: [Some(-0.4 - 0.01 * f64::from(frame / 40 % 11)), (frame % 4 != 0).then_some(0.6)],
                log_estimates: Some([0.1, -0.1]),
                bearing_bound_rad: 0.1,
                spot_px: Some(0.2 * libm::pow(light, 0.8) * libm::exp(0.1 * chance.normal())),
                is_fresh: frame % 10 != 0,
            };
            Sample {
                pair: (0, 1),
                time_s: f64::from(frame) * period_s,
                distance_m: 7.0,
                markers: 2,
                light,
                told: is_followed.then_some(told),
            }
        })
        .collect()
}

#[test]
fn the_fit_finds_the_law_of_its_samples() {
    let samples = samples();
    let table = fit(&samples, Phantoms { count: 6, told_s: 3.0, looked_s: 120.0 });
    let cell = table.errors(7.0, 2);
    assert!((cell.range_bias - 0.05).abs() < 0.02 && (cell.range_sigma / 0.2 - 1.0).abs() < 0.08, "{cell:?}");
    assert!((cell.range_lasts_s - 1.0).abs() < 0.15, "{cell:?}");
    assert!(
        (cell.across_sigma_rad / 0.002 - 1.0).abs() < 0.03 && (cell.velocity_sigma_m_s - 1.0).abs() < 0.03
    );
    assert!((cell.unbounded - 0.25).abs() < 0.01 && cell.broken <= 0.0 && (cell.fresh - 0.9).abs() < 0.01);
    for (number, wanted) in cell.lower.iter().zip([-0.5, -0.47, -0.45, -0.43, -0.4]) {
        assert!((number - wanted).abs() < 0.011, "{cell:?}");
    }
    // one step in forty frames: correlated for longer than errors of distance are
    assert!(cell.bounds_last_s > 1.0, "{cell:?}");
    // found again three times as fast as it is lost
    let following = table.follows(125.0, 2);
    let found_s = -0.05 / libm::log1p(-3.0 * (1.0 - libm::exp(-0.05_f64 / 2.0)));
    assert!((following.found_s / found_s - 1.0).abs() < 0.1, "{following:?}");
    assert!((following.lasts_s - 2.0).abs() < 0.3, "{following:?}");
    assert!((name_s(&[0.5, 0.7, 0.9]) - 0.7).abs() < 1e-9 && (table.phantoms_per_s - 0.05).abs() < 1e-9);
    let [unit_px, power, sigma] = spot_law(samples.iter());
    assert!((unit_px / 0.2 - 1.0).abs() < 0.1 && (power - 0.8).abs() < 0.02, "{unit_px} {power}");
    assert!((sigma / 0.1 - 1.0).abs() < 0.05, "{sigma}");
}

#[test]
fn the_carried_table_is_whole_and_of_possible_numbers() {
    let table = StandInTable::carried();
    for cell in table.steady.error.iter().chain(&table.blinking.error).flatten() {
        assert!(cell.range_sigma >= 0.0 && cell.range_sigma < 2.0 && cell.range_lasts_s > 0.0, "{cell:?}");
        assert!(
            cell.lower.is_sorted() && cell.lower[4] <= 0.0 && (0.0..=1.0).contains(&cell.broken),
            "{cell:?}"
        );
    }
    let mut following = table.steady.following.iter().chain(&table.blinking.following).flatten();
    assert!(following.all(|following| following.found_s >= 0.0 && following.lasts_s > 0.0));
}
