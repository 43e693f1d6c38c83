//! Carried scenarios with the safety layer flown under many seeds, and the same without it: which assumptions of its proof were kept, a table of docs/swarm.md.
//!
//! ```text
//! cargo run --release -p photinus-swarm --example contracts -- GRADE SEEDS [SCENARIO...]
//! ```

#![allow(clippy::print_stdout, reason = "an example prints")]

use photinus_io::Result;
use photinus_swarm::metrics::Contract;
use photinus_swarm::scenario::CARRIED;
use photinus_swarm::{Grade, Metrics, Run};

fn main() -> Result<()> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let grade = words.first().and_then(|word| Grade::named(word)).unwrap_or(Grade::StandIn);
    let seeds: usize = words.get(1).and_then(|word| word.parse().ok()).unwrap_or(10);
    println!(
        "| scenario | perception | flights | collisions | with obstacles | flights where the proof applied | collisions there | proven, % | braking, % | slow, % | too fast | velocity off | strayed | farthest stray, m | bounds broken | held broken | unseen near | smallest distance, m | mean speed, m/s |\n|{}",
        "---|".repeat(19)
    );
    let wanted = |name: &str| words.len() < 3 || words[2..].iter().any(|word| word == name);
    for carried in CARRIED.iter().filter(|carried| wanted(carried.name)) {
        let scenario = carried.read()?;
        if scenario.vehicles.iter().all(|vehicle| vehicle.safety.is_none()) {
            continue;
        }
        let mut bare = scenario.clone();
        bare.vehicles.iter_mut().for_each(|vehicle| vehicle.safety = None);
        for (scenario, name) in
            [(scenario, carried.name.to_owned()), (bare, format!("{}, no layer", carried.name))]
        {
            let run = Run::new(scenario, carried.name, grade);
            println!("{}", row(&name, grade, &run.monte_carlo(seeds, 2, |_| true)?));
        }
    }
    Ok(())
}

fn row(name: &str, grade: Grade, flights: &[Metrics]) -> String {
    let collisions = |flight: &Metrics| flight.collisions + flight.obstacle_collisions;
    let applied = |flight: &&Metrics| flight.contract.as_ref().is_some_and(|contract| contract.proof_applied);
    let sum = |of: fn(&Contract) -> usize| {
        flights.iter().filter_map(|m| m.contract.as_ref()).map(of).sum::<usize>()
    };
    let share = |part: usize| 100.0 * part as f64 / sum(|c| c.decisions).max(1) as f64;
    let stray_m =
        flights.iter().filter_map(|m| m.contract.as_ref()).map(|c| c.farthest_stray_m).fold(0.0, f64::max);
    let smallest_m = flights.iter().filter_map(|m| m.smallest_distance_m).fold(f64::INFINITY, f64::min);
    let speed_m_s = flights.iter().map(|m| m.mean_speed_m_s).sum::<f64>() / flights.len().max(1) as f64;
    format!(
        "| {name} | {} | {} | {} | {} | {} | {} | {:.1} | {:.1} | {:.1} | {} | {} | {} | {stray_m:.2} | {} | {} | {} | {smallest_m:.2} | {speed_m_s:.2} |",
        grade.name(),
        flights.len(),
        flights.iter().map(|m| m.collisions).sum::<usize>(),
        flights.iter().map(|m| m.obstacle_collisions).sum::<usize>(),
        flights.iter().filter(applied).count(),
        flights.iter().filter(applied).map(collisions).sum::<usize>(),
        share(sum(|c| c.proven)),
        share(sum(|c| c.braking)),
        share(sum(|c| c.slow)),
        sum(|c| c.too_fast),
        sum(|c| c.velocity_off),
        sum(|c| c.strayed),
        sum(|c| c.bounds_broken),
        sum(|c| c.held_broken),
        sum(|c| c.unseen_near),
    )
}
