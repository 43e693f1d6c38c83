//! Fits the table that stands in for rendered frames, and prints it:
//!
//! ```text
//! cargo run --release -p photinus-swarm --example fit_stand_in -- [FLIGHTS] > crates/photinus-swarm/src/perception/stand_in/table.toml
//! ```
//!
//! Six vehicles fly figures of eight at distances of 2 to 30 m from each other (`fit.toml`), a flight a seed; their own instruments are without error. Words
//! blink in every second flight, and of three in a row one is exposed four times and one a quarter as long, so that light and distance come apart.

#![allow(clippy::print_stdout, clippy::print_stderr, reason = "an example prints")]

use std::path::Path;

use photinus_io::Result;
use photinus_swarm::perception::{Eyesight, Sampling, StandInTable};
use photinus_swarm::{Grade, Run, Scenario};

fn main() -> Result<()> {
    let flights: u64 = std::env::args().nth(1).and_then(|text| text.parse().ok()).unwrap_or(24);
    let path = Path::new("fit.toml");
    let mut sampling = Sampling::default();
    for seed in 0..flights {
        let mut scenario = Scenario::parse(include_str!("fit.toml"), path)?;
        scenario.seed = seed;
        scenario.exposure_us = [1000.0, 4000.0, 250.0][seed as usize / 2 % 3];
        if seed % 2 == 0 {
            scenario.codes = None;
        }
        let run = Run::new(scenario, path, Grade::Rendered);
        sampling.begin();
        run.fly(2, |world| {
            sampling.take(world);
            Ok(())
        })?;
        eprintln!("flight {seed}: {} samples", sampling.len());
    }
    println!("# Fitted by the example fit_stand_in to {flights} flights, {} samples.", sampling.len());
    print!("{}", text(&sampling.table()));
    Ok(())
}

/// A cell a line.
fn text(table: &StandInTable) -> String {
    let head = format!("name_s = {:?}\nspot_px = {:?}\n", table.name_s, table.spot_px);
    head + &eyesight("steady", &table.steady) + &eyesight("blinking", &table.blinking)
}

fn eyesight(name: &str, sight: &Eyesight) -> String {
    let head = format!(
        "\n[{name}]\nphantoms_per_s = {:?}\nphantom_lasts_s = {:?}\n",
        sight.phantoms_per_s, sight.phantom_lasts_s
    );
    head + &lines("error", &sight.error) + &lines("following", &sight.following)
}

fn lines<T: serde::Serialize>(name: &str, classes: &[Vec<T>]) -> String {
    let cell = |cell: &T| {
        let table = toml::Value::try_from(cell).map_or_else(|_| String::new(), |value| value.to_string());
        format!("    {table},\n")
    };
    let class = |class: &Vec<T>| format!("  [\n{}  ],\n", class.iter().map(cell).collect::<String>());
    format!("{name} = [\n{}]\n", classes.iter().map(class).collect::<String>())
}
