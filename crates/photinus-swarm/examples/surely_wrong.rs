//! Flights by rendered frames -> who was told at places that are surely wrong (beyond five sigma), how long, and who else was nearly in line.
//!
//! ```text
//! cargo run --release -p photinus-swarm --example surely_wrong -- SCENARIO SECONDS SEEDS [FIRST]
//! ```

#![allow(clippy::print_stdout, reason = "an example prints")]

use std::collections::BTreeMap;

use photinus_io::Result;
use photinus_swarm::metrics::pair;
use photinus_swarm::perception::nees;
use photinus_swarm::scenario::carried;
use photinus_swarm::{Grade, Run, World};

/// Five standard deviations, squared, for three degrees of freedom: one in two million.
const SURELY: f64 = 32.0;
/// Who is nearer than this to the line of sight is nearly in line, deg.
const IN_LINE_DEG: f64 = 5.0;

/// One track that was of somebody, while it was wrong.
#[derive(Debug)]
struct Wrong {
    frames: usize,
    from_s: f64,
    to_s: f64,
    true_m: f64,
    told_m: f64,
    in_line: Vec<usize>,
}

fn main() -> Result<()> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let name = words.first().map_or("ten", String::as_str);
    let number = |at: usize, usual: f64| words.get(at).and_then(|word| word.parse().ok()).unwrap_or(usual);
    let mut scenario = carried(name).unwrap_or_else(|| panic!("no scenario {name}")).read()?;
    scenario.duration_s = number(1, 8.0);
    let (mut all, mut wrong_frames) = (0, 0);
    let first = number(3, 0.0) as u64;
    for seed in first..first + number(2, 3.0) as u64 {
        let run = Run::new(scenario.clone(), name, Grade::Rendered).with_seed(seed);
        let mut wrong = BTreeMap::new();
        let (mut sum, mut told) = (0.0, 0);
        run.fly(2, |world| {
            (0..world.robots().len()).for_each(|observer| {
                take(world, observer, &mut wrong, &mut sum, &mut told);
            });
            Ok(())
        })?;
        println!("seed {seed}: NEES {:.2} of {told} positions", sum / told as f64);
        for ((observer, target), wrong) in &wrong {
            let Wrong { frames, from_s, to_s, true_m, told_m, in_line } = wrong;
            println!(
                "  {observer} of {target}: {frames} frames, {from_s:.2} to {to_s:.2} s, first at {told_m:.1} m for {true_m:.1} m; nearly in line: {in_line:?}"
            );
            wrong_frames += frames;
        }
        all += told;
    }
    println!(
        "{wrong_frames} of {all} positions are surely wrong: {:.2} %",
        100.0 * wrong_frames as f64 / all as f64
    );
    Ok(())
}

/// Takes what one vehicle is told of the others in a frame.
fn take(
    world: &World,
    observer: usize,
    wrong: &mut BTreeMap<(usize, usize), Wrong>,
    sum: &mut f64,
    told: &mut usize,
) {
    let robots = world.robots();
    let (time_s, seen) = (world.moment().time_s, &robots[observer].seen);
    for pair in pair(world, observer) {
        let Some(place) = seen[pair.seen].position_m else { continue };
        let Some(off) = nees(&place, &pair.truth_m) else { continue };
        *sum += off;
        *told += 1;
        if off < SURELY {
            continue;
        }
        let way_m = |target: usize| robots[target].state.position_m - robots[observer].state.position_m;
        let is_in_line = |other: &usize| {
            ![observer, pair.target].contains(other)
                && way_m(*other).angle(&way_m(pair.target)).to_degrees() < IN_LINE_DEG
        };
        let own = wrong.entry((observer, pair.target)).or_insert_with(|| Wrong {
            frames: 0,
            from_s: time_s,
            to_s: time_s,
            true_m: pair.truth_m.norm(),
            told_m: place.mean.norm(),
            in_line: (0..robots.len()).filter(is_in_line).collect(),
        });
        own.frames += 1;
        own.to_s = time_s;
    }
}
