//! Whether a calibration is as far off as it says: simulated calibrations, their errors in units of what they claim.
//!
//! ```text
//! cargo run --release -p photinus-calibrate --example consistency -- 100
//! ```

#![allow(clippy::print_stdout, reason = "a program that reports")]

#[path = "../tests/calibrate/simulation/mod.rs"]
mod simulation;

use photinus_calibrate::camera::Calibration;

fn main() {
    let seeds = std::env::args().nth(1).and_then(|count| count.parse().ok()).unwrap_or(100);
    let truth = simulation::lens();
    let (mut sum, mut squares, mut raised, mut worst_rad) = (0.0, 0.0, 0.0, 0.0_f64);
    for seed in 0..seeds {
        let calibration: Calibration = simulation::calibrated(&simulation::photos(seed, 20, 0.035));
        let (normalised, off_rad) = simulation::normalised_error(calibration.camera(), &truth);
        sum += normalised / 2.0;
        squares += normalised * normalised / 4.0;
        raised += calibration.inflation().measured;
        worst_rad = worst_rad.max(off_rad);
    }
    let count = seeds as f64;
    let mean = sum / count;
    let error = ((squares / count - mean * mean) / count).sqrt();
    println!(
        "{seeds} calibrations: squared error over what is claimed {mean:.3} +- {error:.3} (1 is honest)"
    );
    println!("sigmas raised by {:.3} in the mean; worst error {:.3} mrad", raised / count, 1e3 * worst_rad);
}
