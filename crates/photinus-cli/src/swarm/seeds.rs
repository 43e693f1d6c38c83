//! Many seeds: metrics of each flight, and over all of them.

use std::time::Instant;

use photinus_io::{Error, Result};
use photinus_swarm::{Metrics, Progress, Run};
use serde::Serialize;

use super::folder::write_json;
use super::page;
use crate::failure::Failure;
use crate::interrupt;
use crate::targets::FolderTarget;
use crate::terminal::Terminal;

/// metrics.json of many flights.
#[derive(Debug, Serialize)]
pub(super) struct Report {
    /// The scenario's name.
    scenario: String,
    /// How vehicles saw.
    perception: &'static str,
    /// How many flights.
    flights: usize,
    /// Collisions of vehicles in all flights.
    collisions: usize,
    /// Collisions with obstacles in all flights.
    obstacle_collisions: usize,
    /// Flights without any.
    without_collision: usize,
    /// Over all flights, m.
    smallest_distance_m: Option<f64>,
    /// Mean over flights of what each flight has a number of.
    pub(super) mean: Vec<Mean>,
    /// Each flight.
    pub(super) each: Vec<Metrics>,
}

/// A number over all flights.
#[derive(Debug, Serialize)]
pub(super) struct Mean {
    /// Which, by its key in `each`.
    pub(super) key: &'static str,
    /// Its mean.
    pub(super) mean: f64,
    /// Its standard deviation.
    pub(super) sigma: f64,
    /// Its least.
    pub(super) least: f64,
    /// Its most.
    pub(super) most: f64,
}

/// Flies under many seeds.
pub(super) fn fly(
    run: &Run,
    (seeds, threads): (usize, usize),
    target: Option<&FolderTarget>,
    terminal: &mut Terminal,
) -> std::result::Result<(), Failure> {
    let started = Instant::now();
    terminal.start(Some(run.scenario.frames() * seeds as u64));
    let flown = run.monte_carlo(seeds, threads, |progress| {
        if let Progress::Frame = progress {
            terminal.frame_done();
        }
        !interrupt::is_asked()
    });
    terminal.finish();
    if interrupt::is_asked() {
        return Err(Failure::Interrupted("interrupted; nothing was kept".to_owned()));
    }
    interrupt::look_away();
    let report = Report::of(run, flown.map_err(Failure::running)?);
    if let Some(target) = target {
        let making = target.whole().map_err(Failure::input)?;
        let write = || -> Result<()> {
            write_json(&making.path().join("metrics.json"), &report)?;
            page::seeds(&run.scenario, &report).write(making.path())
        };
        write().map_err(|error: Error| Failure::running(making.tell(error)))?;
        making.keep().map_err(Failure::running)?;
    }
    terminal.result(report.told())?;
    let took_s = started.elapsed().as_secs_f64();
    terminal.summary(format_args!("{} flights in {took_s:.1} s", report.flights));
    Ok(())
}

impl Report {
    fn of(run: &Run, each: Vec<Metrics>) -> Self {
        let least = |a: f64, b: f64| a.min(b);
        Self {
            scenario: run.scenario.name.clone(),
            perception: run.grade.name(),
            flights: each.len(),
            collisions: each.iter().map(|flight| flight.collisions).sum(),
            obstacle_collisions: each.iter().map(|flight| flight.obstacle_collisions).sum(),
            without_collision: each
                .iter()
                .filter(|flight| flight.collisions + flight.obstacle_collisions == 0)
                .count(),
            smallest_distance_m: each.iter().filter_map(|flight| flight.smallest_distance_m).reduce(least),
            mean: MEASURED.iter().filter_map(|(key, of)| Mean::of(key, *of, &each)).collect(),
            each,
        }
    }

    /// Lines to read.
    pub(super) fn told(&self) -> String {
        let mut lines = vec![format!(
            "{}: {} flights, perception {}: {} collisions, {} with obstacles, {} flights without any",
            self.scenario,
            self.flights,
            self.perception,
            self.collisions,
            self.obstacle_collisions,
            self.without_collision
        )];
        lines.push(format!("  {:26} {:>10} {:>10} {:>10} {:>10}", "", "mean", "sigma", "least", "most"));
        lines.extend(self.mean.iter().map(|Mean { key, mean, sigma, least, most }| {
            format!("  {key:26} {mean:10.3} {sigma:10.3} {least:10.3} {most:10.3}")
        }));
        lines.join("\n")
    }
}

/// A number of a flight.
type Of = fn(&Metrics) -> Option<f64>;

/// What is told over all flights.
const MEASURED: [(&str, Of); 18] = [
    ("smallest_distance_m", |m| m.smallest_distance_m),
    ("smallest_clearance_m", |m| m.smallest_clearance_m),
    ("final_order", |m| m.final_order),
    ("final_extension_m", |m| m.final_extension_m),
    ("extension_sigma_m", |m| m.extension_sigma_m),
    ("formation_error_m", |m| m.formation_error_m),
    ("formation_settles_s", |m| m.formation_settles_s),
    ("mean_speed_m_s", |m| Some(m.mean_speed_m_s)),
    ("connected", |m| Some(m.connected)),
    ("contact", |m| m.contact),
    ("contact_with_anybody", |m| m.contact_with_anybody),
    ("contact_with_leader", |m| m.contact_with_leader),
    ("position_error_m", |m| m.position_error_m),
    ("nees", |m| m.nees),
    ("nees_within_95", |m| m.nees_within_95),
    ("bounds_broken", |m| Some(m.bounds_broken as f64)),
    ("identity_switches", |m| Some(m.identity_switches as f64)),
    ("phantoms", |m| m.phantoms),
];

impl Mean {
    fn of(key: &'static str, of: Of, flights: &[Metrics]) -> Option<Self> {
        let numbers: Vec<f64> = flights.iter().filter_map(of).collect();
        let count = numbers.len() as f64;
        let mean = numbers.iter().sum::<f64>() / count;
        let square = numbers.iter().map(|number| (number - mean) * (number - mean)).sum::<f64>() / count;
        let least = numbers.iter().copied().reduce(f64::min)?;
        let most = numbers.iter().copied().reduce(f64::max)?;
        Some(Self { key, mean, sigma: square.sqrt(), least, most })
    }
}
