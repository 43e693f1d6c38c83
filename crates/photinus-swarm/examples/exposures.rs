//! How large a flock is that sees by one exposure or another, with margins that are sizes of spots and with margins that are distances: a table of docs/swarm.md.
//!
//! ```text
//! cargo run --release -p photinus-swarm --example exposures -- SEEDS
//! ```

#![allow(clippy::print_stdout, reason = "an example prints")]

use photinus_control::controllers::RangeTest;
use photinus_io::Result;
use photinus_swarm::mind::Plan;
use photinus_swarm::scenario::carried;
use photinus_swarm::{Grade, Metrics, Run};

const EXPOSURES_US: [f64; 6] = [250.0, 500.0, 1000.0, 2000.0, 4000.0, 8000.0];

fn main() -> Result<()> {
    let seeds: usize = std::env::args().nth(1).and_then(|word| word.parse().ok()).unwrap_or(5);
    let Some(exposure) = carried("exposure") else { return Ok(()) };
    let scenario = exposure.read()?;
    println!(
        "| margins are | exposure, us | flights | extension at the end, m | its sigma, m | connected, % | largest part, % | collisions |\n|{}",
        "---|".repeat(8)
    );
    for (margins, tests) in
        [("sizes", None), ("distances", Some((RangeTest::Inline, RangeTest::Perpendicular)))]
    {
        for exposure_us in EXPOSURES_US {
            let mut steady = scenario.clone();
            (steady.exposure_us, steady.duration_s) = (exposure_us, 60.0);
            steady.events.clear();
            for vehicle in &mut steady.vehicles {
                if let (Plan::Boids(boids), Some(tests)) = (&mut vehicle.mind, tests) {
                    (boids.near_by, boids.far_by) = tests;
                }
            }
            let run = Run::new(steady, "exposure", Grade::StandIn);
            println!("| {margins} {}", row(exposure_us, &run.monte_carlo(seeds, 2, |_| true)?));
        }
    }
    Ok(())
}

fn row(exposure_us: f64, flights: &[Metrics]) -> String {
    let mean = |of: fn(&Metrics) -> Option<f64>| {
        flights.iter().filter_map(of).sum::<f64>() / flights.len().max(1) as f64
    };
    format!(
        "| {exposure_us:.0} | {} | {:.2} | {:.2} | {:.1} | {:.1} | {} |",
        flights.len(),
        mean(|m| m.final_extension_m),
        mean(|m| m.extension_sigma_m),
        100.0 * mean(|m| Some(m.connected)),
        100.0 * mean(|m| Some(m.largest_part)),
        flights.iter().map(|m| m.collisions).sum::<usize>(),
    )
}
