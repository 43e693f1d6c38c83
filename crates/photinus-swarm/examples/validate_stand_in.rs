//! What stands in for frames beside rendered frames, on scenarios that it was not fitted to: a table for docs/swarm.md.
//!
//! ```text
//! cargo run --release -p photinus-swarm --example validate_stand_in -- [SEEDS] [SECONDS] [SCENARIO...]
//! ```

#![allow(clippy::print_stdout, clippy::print_stderr, reason = "an example prints")]

use photinus_io::Result;
use photinus_swarm::scenario::{CARRIED, Carried};
use photinus_swarm::{Grade, Metrics, Run};

/// Scenarios whose flights are none of the fit's: controllers in the loop, wind, light, one camera, blinking.
const USUAL: [&str; 6] = ["three", "five", "wind", "day", "leader", "formation"];

/// A column of the table.
type Column = (&'static str, fn(&Metrics) -> Option<f64>);

const COLUMNS: [Column; 9] = [
    ("seen of those in view, %", |m| m.contact.map(|share| 100.0 * share)),
    ("error of distances, %", |m| m.range_error.map(|error| 100.0 * error)),
    ("position error, m", |m| m.position_error_m),
    ("NEES, median", |m| m.nees_median),
    ("within 95 %, %", |m| m.nees_within_95.map(|share| 100.0 * share)),
    ("phantoms, %", |m| m.phantoms.map(|share| 100.0 * share)),
    ("switches", |m| Some(m.identity_switches as f64)),
    ("smallest distance, m", |m| m.smallest_distance_m),
    ("extension at the end, m", |m| m.final_extension_m),
];

fn main() -> Result<()> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let number = |at: usize, usual: f64| words.get(at).and_then(|word| word.parse().ok()).unwrap_or(usual);
    let (seeds, seconds) = (number(0, 3.0) as usize, number(1, 20.0));
    let wanted = |carried: &&Carried| match words.get(2..) {
        Some(names) if !names.is_empty() => names.iter().any(|name| name == carried.name),
        _ => USUAL.contains(&carried.name),
    };
    let heads: String = COLUMNS.iter().map(|(name, _)| format!(" {name} |")).collect();
    println!("| scenario | perception |{heads}\n|---|---|{}", "---|".repeat(COLUMNS.len()));
    for carried in CARRIED.iter().filter(wanted) {
        for grade in [Grade::Rendered, Grade::StandIn, Grade::Perfect] {
            let mut scenario = carried.read()?;
            scenario.duration_s = seconds;
            let run = Run::new(scenario, carried.name, grade);
            let flights = run.monte_carlo(seeds, 2, |_| true)?;
            let cell = |of: fn(&Metrics) -> Option<f64>| {
                let numbers: Vec<f64> = flights.iter().filter_map(of).collect();
                match numbers.len() {
                    0 => " - |".to_owned(),
                    count => format!(" {:.2} |", numbers.iter().sum::<f64>() / count as f64),
                }
            };
            let cells: String = COLUMNS.iter().map(|(_, of)| cell(*of)).collect();
            println!("| {} | {} |{cells}", carried.name, grade.name());
        }
    }
    Ok(())
}
