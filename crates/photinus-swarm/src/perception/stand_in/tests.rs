//! The table's fit on samples whose law is known, and the table that the program carries.

use super::table::{Sample, Told, fit};
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
            let told = Told {
                log_range: 0.05 + 0.2 * error,
                across_rad: [0.002 * chance.normal(), 0.002 * chance.normal()],
                range_sigma: 0.25,
                across_sigma_rad: 0.003,
                velocity_m_s: [chance.normal(), chance.normal(), chance.normal()],
                velocity_sigma_m_s: 1.1,
                log_bounds: [Some(-0.4), (frame % 4 != 0).then_some(0.6)],
                log_estimates: Some([0.1, -0.1]),
                bearing_bound_rad: 0.1,
                is_fresh: frame % 10 != 0,
            };
            Sample {
                pair: (0, 1),
                time_s: f64::from(frame) * period_s,
                distance_m: 7.0,
                markers: 2,
                light: 1000.0 / 49.0,
                told: is_followed.then_some(told),
            }
        })
        .collect()
}

#[test]
fn the_fit_finds_the_law_of_its_samples() {
    let table = fit(&samples(), (6, 3.0, 120.0), &[0.5, 0.7, 0.9], 1.0);
    let cell = table.errors(7.0, 2);
    assert!((cell.range_bias - 0.05).abs() < 0.02 && (cell.range_sigma / 0.2 - 1.0).abs() < 0.08, "{cell:?}");
    assert!((cell.range_lasts_s - 1.0).abs() < 0.15, "{cell:?}");
    assert!(
        (cell.across_sigma_rad / 0.002 - 1.0).abs() < 0.03 && (cell.velocity_sigma_m_s - 1.0).abs() < 0.03
    );
    assert!((cell.unbounded - 0.25).abs() < 0.01 && cell.broken <= 0.0 && (cell.fresh - 0.9).abs() < 0.01);
    let following = table.follows(1000.0 / 49.0, 2);
    assert!((following.share - 0.75).abs() < 0.03 && (following.lasts_s - 2.0).abs() < 0.3, "{following:?}");
    assert!((table.name_s - 0.7).abs() < 1e-9 && (table.phantoms_per_s - 0.05).abs() < 1e-9);
    // four times the exposure at twice the distance is the same light
    assert_eq!(table.follows(4000.0 / 196.0, 2), following);
}

#[test]
fn the_carried_table_is_whole_and_of_possible_numbers() {
    let table = StandInTable::carried();
    for cell in table.error.iter().flatten() {
        assert!(cell.range_sigma >= 0.0 && cell.range_sigma < 2.0 && cell.range_lasts_s > 0.0, "{cell:?}");
        assert!(cell.lower[0] <= 0.0 && (0.0..=1.0).contains(&cell.broken), "{cell:?}");
    }
    assert!(table.following.iter().flatten().all(|following| (0.0..=1.0).contains(&following.share)));
}
