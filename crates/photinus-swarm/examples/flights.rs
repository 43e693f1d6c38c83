//! Scenarios flown under many seeds: the tables of docs/swarm.md.
//!
//! ```text
//! cargo run --release -p photinus-swarm --example flights -- GRADE SEEDS [SCENARIO|FILE...]
//! ```

#![allow(clippy::print_stdout, clippy::print_stderr, reason = "an example prints")]

use std::time::Instant;

use photinus_io::Result;
use photinus_swarm::scenario::{CARRIED, Carried, carried};
use photinus_swarm::{Grade, Metrics, Run, Scenario};

fn main() -> Result<()> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let grade = words.first().and_then(|word| Grade::named(word)).unwrap_or(Grade::StandIn);
    let seeds: usize = words.get(1).and_then(|word| word.parse().ok()).unwrap_or(10);
    println!(
        "| scenario | N | flights | with a collision | collisions | with obstacles | smallest distance, m | mean speed, m/s | order | extension, m | its sigma, m | connected, % | seen of those in view, % | leader seen, % | formation, m | its oscillation, m/s | settles, s | bounds broken, % |\n|{}",
        "---|".repeat(18)
    );
    let named = match words.get(2..) {
        Some(named) if !named.is_empty() => named.to_vec(),
        _ => CARRIED.iter().map(|carried| carried.name.to_owned()).collect(),
    };
    for name in &named {
        let scenario = carried(name).map_or_else(|| Scenario::read(name), Carried::read)?;
        let run = Run::new(scenario, name, grade);
        let started = Instant::now();
        let flights = run.monte_carlo(seeds, 2, |_| true)?;
        let flown_s = run.scenario.duration_s * seeds as f64;
        eprintln!("{name}: {:.2} s of flight per s", flown_s / started.elapsed().as_secs_f64());
        println!("{}", row(name, run.scenario.vehicles.len(), &flights));
    }
    Ok(())
}

fn row(name: &str, vehicles: usize, flights: &[Metrics]) -> String {
    let sum = |of: fn(&Metrics) -> usize| flights.iter().map(of).sum::<usize>();
    let touched = flights.iter().filter(|m| m.collisions + m.obstacle_collisions > 0).count();
    let smallest = flights.iter().filter_map(|m| m.smallest_distance_m).fold(f64::INFINITY, f64::min);
    let mean = |of: fn(&Metrics) -> Option<f64>, scale: f64| {
        let numbers: Vec<f64> = flights.iter().filter_map(of).collect();
        match numbers.len() {
            0 => "-".to_owned(),
            count => format!("{:.2}", scale * numbers.iter().sum::<f64>() / count as f64),
        }
    };
    let broken = 100.0 * sum(|m| m.bounds_broken) as f64 / sum(|m| m.bounds).max(1) as f64;
    format!(
        "| {name} | {vehicles} | {} | {touched} | {} | {} | {smallest:.2} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {broken:.2} |",
        flights.len(),
        sum(|m| m.collisions),
        sum(|m| m.obstacle_collisions),
        mean(|m| Some(m.mean_speed_m_s), 1.0),
        mean(|m| m.final_order, 1.0),
        mean(|m| m.final_extension_m, 1.0),
        mean(|m| m.extension_sigma_m, 1.0),
        mean(|m| Some(m.connected), 100.0),
        mean(|m| m.contact, 100.0),
        mean(|m| m.contact_with_leader.filter(|_| m.vehicles == 2), 100.0),
        mean(|m| m.formation_error_m, 1.0),
        mean(|m| m.formation_oscillation_m_s, 1.0),
        mean(|m| m.formation_settles_s, 1.0),
    )
}
