//! Time on rendered frames with default settings: what becomes of tracks and names while something is wrong, where vehicles cross, and while LEDs are dark.
//!
//! ```text
//! cargo run --release -p photinus-evaluate --example time -- faults    [first seed [last seed [fault]]]
//! cargo run --release -p photinus-evaluate --example time -- crossings [first seed [last seed]]
//! cargo run --release -p photinus-evaluate --example time -- dark      [first seed [last seed]]
//! cargo run --release -p photinus-evaluate --example time -- words     [first seed [last seed]]
//! ```
//!
//! docs/tracking.md has the tables.

#![expect(clippy::print_stdout, reason = "an example prints its tables")]

mod crossings;
mod dark;
mod fault;
mod flight;
mod scene;
mod score;

use fault::FAULTS;
use flight::fly;
use scene::AIRFRAMES;
use score::Score;

fn main() {
    let text = |place: usize| std::env::args().nth(place);
    let number = |place: usize| text(place).and_then(|text| text.parse().ok());
    let which = text(1).unwrap_or_default();
    // Seeds that nothing was developed on.
    let seeds = match which.as_str() {
        "faults" => [313, 324],
        "crossings" => [401, 500],
        "words" => [61, 100],
        _ => [501, 520],
    };
    let first: u64 = number(2).unwrap_or(seeds[0]);
    let last = number(3).unwrap_or(seeds[1].max(first));
    match which.as_str() {
        "faults" => faults(first, last, text(4).as_deref()),
        "crossings" => crossings::table(first..=last),
        "dark" => dark::table(first..=last),
        "words" => dark::words(first..=last),
        _ => println!("faults, crossings, dark or words"),
    }
}

/// Each fault by itself, then some together.
fn faults(first: u64, last: u64, only: Option<&str>) {
    println!("{}", Score::HEADS);
    for airframe in AIRFRAMES {
        for fault in FAULTS.iter().filter(|fault| only.is_none_or(|only| only == fault.name)) {
            let mut all = Score::default();
            for seed in first..=last {
                let of_seed = fly(seed, airframe, fault);
                if only.is_some() {
                    println!("{}", of_seed.line(airframe, &format!("{}, seed {seed}", fault.name)));
                }
                all.add(&of_seed);
            }
            println!("{}", all.line(airframe, fault.name));
        }
    }
}
