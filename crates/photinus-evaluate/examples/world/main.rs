//! The world against the program: what faults, cameras and crowds do to it with default options.
//!
//! ```text
//! cargo run --release -p photinus-evaluate --example world -- faults|cameras|optics|crowds|reliability [frames] [--only=PART...] [--update]
//! cargo run --release -p photinus-evaluate --example world -- snapshot [--update]
//! ```
//!
//! Prints a table of neighbours and a table of spots, or one of what neighbours claim, of the rows whose names have one of the
//! parts in them, if any is given. With `--update` the tables take the place of those in docs/world.md, or of the committed
//! snapshot. The columns are explained in docs/world.md.

#![expect(clippy::print_stdout, clippy::print_stderr, reason = "an example prints its table")]

mod calibrated;
mod cameras;
mod crowds;
mod document;
mod faults;
mod light;
mod priors;
mod reliability;
mod row;
mod snapshot;
mod table;

use std::process::ExitCode;

use row::{Outcome, Row};
use table::Table;

const USAGE: &str = "give faults, cameras, optics, crowds or reliability, a number of frames per row if you like, and --update \
                     to write docs/world.md; or snapshot, and --update to write the committed one";

fn main() -> ExitCode {
    let mut words: Vec<String> = std::env::args().skip(1).collect();
    let update = words.iter().any(|word| word == "--update");
    let only: Vec<String> =
        words.iter().filter_map(|word| word.strip_prefix("--only=")).map(str::to_owned).collect();
    words.retain(|word| !word.starts_with("--"));
    let frames = words.get(1).map_or(Some(500), |text| text.parse().ok().filter(|&frames| frames > 0));
    let (Some(what), Some(frames)) = (words.first(), frames) else { return usage() };
    let single = |rows: Vec<Row>| rows.into_iter().map(|row| (row, frames)).collect();
    let mut rows: Vec<(Row, u64)> = match what.as_str() {
        "faults" => single(faults::rows(&cameras::paper())),
        "cameras" => single(cameras::rows(0)),
        "optics" => single(cameras::rows(200)),
        "reliability" => reliability::rows(&cameras::paper(), frames),
        "crowds" => crowds::rows(&cameras::paper(), 2 * frames),
        "snapshot" => return take_snapshot(update),
        _ => return usage(),
    };
    rows.retain(|(row, _)| only.is_empty() || only.iter().any(|part| row.name.contains(part.as_str())));
    let outcomes: Vec<Outcome> = rows.iter().map(|(row, frames)| told(row.run(*frames))).collect();
    let (aligned, markdown) = match what.as_str() {
        "reliability" => of_claims(&outcomes),
        _ => of_neighbours_and_spots(&outcomes),
    };
    println!("{aligned}");
    let notes = if what == "cameras" { format!("\n{}", cameras::about()) } else { String::new() };
    let update = update && only.is_empty();
    let written = if update { document::update(what, frames, &(markdown + &notes)) } else { Ok(()) };
    written.map_or_else(failed, |()| ExitCode::SUCCESS)
}

/// The tables to print, and those of the document.
fn of_neighbours_and_spots(outcomes: &[Outcome]) -> (String, String) {
    let [neighbours, spots] = [Table::of_neighbours(outcomes), Table::of_spots(outcomes)];
    (
        format!("{}\nspots\n{}", neighbours.aligned(), spots.aligned()),
        format!("{}\nSpots:\n\n{}", neighbours.markdown(), spots.markdown()),
    )
}

/// The same of what neighbours claim.
fn of_claims(outcomes: &[Outcome]) -> (String, String) {
    let claims = reliability::table(outcomes);
    (claims.aligned(), claims.markdown())
}

/// Says that a row is done: some take long.
fn told(outcome: Outcome) -> Outcome {
    eprintln!("{}, {}", outcome.name, outcome.airframe);
    outcome
}

fn take_snapshot(update: bool) -> ExitCode {
    let text = snapshot::text();
    print!("{text}");
    let written = if update { std::fs::write(snapshot::FILE, text) } else { Ok(()) };
    written
        .map_err(|error| format!("{}: {error}", snapshot::FILE))
        .map_or_else(failed, |()| ExitCode::SUCCESS)
}

fn usage() -> ExitCode {
    eprintln!("{USAGE}");
    ExitCode::from(2)
}

fn failed(reason: String) -> ExitCode {
    eprintln!("error: {reason}");
    ExitCode::FAILURE
}
