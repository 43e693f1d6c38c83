//! Fleets whose arms blink words of their own, rendered and followed with default settings: who is named, and whether covariances keep their word.
//!
//! ```text
//! cargo run --release -p photinus-evaluate --example fleets [first seed [last seed]]
//! ```
//!
//! Each seed is a scene of six quadrotors with four words each, 3.5 to 10.5 m away, for three seconds (`scene.rs`); scores count from three code lengths on
//! (`flight.rs`). docs/tracking.md has the tables.

#![expect(clippy::print_stdout, reason = "an example prints its table")]

mod flight;
mod scene;
mod score;

use flight::fly;
use scene::{Built, MOTIONS};
use score::Score;

/// Seeds that nothing was developed on.
const SEEDS: [u64; 2] = [71, 76];

fn main() {
    let given = |place: usize| std::env::args().nth(place).and_then(|text| text.parse().ok());
    let first = given(1).unwrap_or(SEEDS[0]);
    let last = given(2).unwrap_or(SEEDS[1].max(first));
    for built in [Built::AsTold, Built::ByHand] {
        println!("\nbuilt {}\n{}", built.name(), Score::HEADS);
        let mut all = Score::default();
        let mut by_motion: [Score; MOTIONS.len()] = Default::default();
        for seed in first..=last {
            let flights = fly(seed, built);
            let mut of_seed = Score::default();
            for flight in flights {
                of_seed.add(&flight.score);
                by_motion[flight.motion].add(&flight.score);
            }
            println!("{}", of_seed.line(&seed.to_string()));
            all.add(&of_seed);
        }
        for (motion, score) in MOTIONS.iter().zip(&by_motion) {
            println!("{}", score.line(motion));
        }
        println!("{}", all.line("all"));
    }
}
