//! A flock whose near and far margins go by one distance or another: the founding paper's choice (near by l_B, far by l_A) beside the others, a table of
//! docs/swarm.md.
//!
//! ```text
//! cargo run --release -p photinus-swarm --example margins -- SEEDS [SCENARIO...]
//! ```

#![allow(clippy::print_stdout, reason = "an example prints")]

use photinus_control::controllers::RangeTest::{Estimate, Inline, Perpendicular};
use photinus_io::Result;
use photinus_swarm::mind::Plan;
use photinus_swarm::scenario::carried;
use photinus_swarm::{Grade, Metrics, Run};

fn main() -> Result<()> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let seeds: usize = words.first().and_then(|word| word.parse().ok()).unwrap_or(10);
    let names =
        if words.len() > 1 { words[1..].to_vec() } else { vec!["ten".to_owned(), "twenty".to_owned()] };
    println!(
        "| scenario | near by | far by | flights | with a collision | smallest distance, m | extension, m | its sigma, m | connected, % |\n|{}",
        "---|".repeat(9)
    );
    for scenario in names.iter().filter_map(|name| carried(name)) {
        for (near_by, far_by) in [
            (Inline, Perpendicular),
            (Perpendicular, Inline),
            (Inline, Inline),
            (Perpendicular, Perpendicular),
            (Estimate, Estimate),
        ] {
            let mut flock = scenario.read()?;
            for vehicle in &mut flock.vehicles {
                if let Plan::Boids(boids) = &mut vehicle.mind {
                    (boids.near_by, boids.far_by) = (near_by, far_by);
                }
            }
            let run = Run::new(flock, scenario.name, Grade::StandIn);
            let flights = run.monte_carlo(seeds, 2, |_| true)?;
            println!("| {} | {near_by:?} | {far_by:?} {}", scenario.name, row(&flights));
        }
    }
    Ok(())
}

fn row(flights: &[Metrics]) -> String {
    let mean = |of: fn(&Metrics) -> Option<f64>| {
        flights.iter().filter_map(of).sum::<f64>() / flights.len().max(1) as f64
    };
    format!(
        "| {} | {} | {:.2} | {:.2} | {:.3} | {:.1} |",
        flights.len(),
        flights.iter().filter(|m| m.collisions > 0).count(),
        flights.iter().filter_map(|m| m.smallest_distance_m).fold(f64::INFINITY, f64::min),
        mean(|m| m.final_extension_m),
        mean(|m| m.extension_sigma_m),
        100.0 * mean(|m| Some(m.connected)),
    )
}
