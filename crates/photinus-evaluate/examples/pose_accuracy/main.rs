//! How good poses are, against the information bound: through rendered frames, and in pure geometry with a known pixel sigma.
//!
//! ```text
//! cargo run --release -p photinus-evaluate --example pose_accuracy [neighbours per range [spots]]
//! ```
//!
//! Single neighbours at a few ranges, any yaw, elevations to 20 deg, tilted by 4 deg (one sigma per axis), gravity known to
//! 0.3 deg. Beside each error stands the Cramer-Rao bound of the same views, with the priors as information: what is
//! possible if it is known which spot is which marker. Markers that are not seen tell more; the bound leaves that out.
//! With `spots` as the second argument: errors of the spots themselves, by class, for this camera and others.

#![expect(clippy::print_stdout, reason = "an example prints its table")]

mod experiment;
mod render;
mod spots;
mod view;

use experiment::Source;

fn main() {
    let count = std::env::args().nth(1).and_then(|text| text.parse().ok()).unwrap_or(2000);
    if std::env::args().nth(2).is_some_and(|what| what == "spots") {
        for setup in std::iter::once(&render::PAPER).chain(&render::OTHERS) {
            spots::print(setup, &experiment::airframes(), count);
        }
        return;
    }
    for source in [Source::Rendered, Source::Geometry { sigma_px: 0.1 }, Source::Geometry { sigma_px: 0.3 }] {
        println!("\n{source:?}, {count} neighbours per range");
        println!(
            "airframe         range  spots  neighbours  distance rms    bound  ratio     mean   NEES  in 95 %  yaw NEES  outside bounds"
        );
        for airframe in experiment::airframes() {
            for distance_m in [2.0, 5.0, 10.0, 15.0] {
                let (tallies, nothing) = experiment::run(&airframe, distance_m, source, count);
                for (spots, tally) in tallies.iter().enumerate().filter(|(_, tally)| tally.count > 0.0) {
                    println!(
                        "{:16} {distance_m:3.0} m  {spots:5}  {:10.0}  {:10.4} m {:6.4} m {:6.2} {:+7.3} m {:6.2} {:6.1} % {:9.2} {:15.0}",
                        airframe.name(),
                        tally.count,
                        tally.rmse_m(),
                        tally.bound_m(),
                        tally.rmse_m() / tally.bound_m(),
                        tally.bias_m(),
                        tally.nees(),
                        100.0 * tally.inside_95(),
                        tally.yaw_nees(),
                        tally.outside_bounds,
                    );
                }
                if nothing > 0 {
                    println!("{:16} {distance_m:3.0} m  nothing found in {nothing}", airframe.name());
                }
            }
        }
    }
}
