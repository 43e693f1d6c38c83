//! Plans against rendered and located frames, of set-ups drawn at random: the table of docs/planning.md.
//!
//! ```text
//! cargo run --release -p photinus-plan --example against_simulation -- [SET-UPS] [FRAMES] [--update]
//! ```

#![expect(clippy::print_stdout, clippy::print_stderr, reason = "an example prints its table")]

mod compared;
mod drawn;
mod flown;

use compared::{Compared, compared};
use drawn::{Drawn, drawn};

const FILE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/planning.md");
const BEGIN: &str = "<!-- against simulation: as generated -->\n";
const END: &str = "<!-- against simulation: end -->\n";

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let mut numbers = words.iter().filter_map(|word| word.parse::<u32>().ok());
    let (setups, frames) = (numbers.next().unwrap_or(30), numbers.next().unwrap_or(300));
    let mut text = format!(
        "\n    cargo run --release -p photinus-plan --example against_simulation -- {setups} {frames} --update\n\n\
         | set-up | range, planned m | in frames m | off % | at m | error of distance, planned m | in frames m | off % | rms, planned m | in frames m |\n\
         |---|---|---|---|---|---|---|---|---|---|\n"
    );
    let (mut ranges, mut errors) = (Vec::new(), Vec::new());
    for number in 1..=u64::from(setups) {
        let Drawn { name, setup } = drawn(number);
        let Compared { range_m, at_m, error_m, rms_m } = compared(&setup, number, frames);
        let line = format!(
            "| {name} | {:.1} | {:.1} | {:+.0} | {at_m:.1} | {:.3} | {:.3} | {:+.0} | {:.3} | {:.3} |\n",
            range_m.planned,
            range_m.measured,
            100.0 * range_m.off(),
            error_m.planned,
            error_m.measured,
            100.0 * error_m.off(),
            rms_m.planned,
            rms_m.measured,
        );
        eprint!("{line}");
        text += &line;
        ranges.push(range_m.off().abs());
        errors.push(error_m.off().abs());
    }
    let within = |offs: &[f64], limit: f64| offs.iter().filter(|off| **off <= limit).count();
    text += &format!(
        "\nRange within 10 % in {} of {setups}, the largest difference {:.0} %; error of distance within 25 % in {}, the largest {:.0} %.\n\n",
        within(&ranges, 0.1),
        100.0 * ranges.iter().copied().fold(0.0, f64::max),
        within(&errors, 0.25),
        100.0 * errors.iter().copied().fold(0.0, f64::max),
    );
    println!("{text}");
    if words.iter().any(|word| word == "--update") {
        let document = std::fs::read_to_string(FILE)?;
        let (before, rest) =
            document.split_once(BEGIN).ok_or("docs/planning.md has no place for the table")?;
        let (_, after) = rest.split_once(END).ok_or("docs/planning.md has no end of the table")?;
        std::fs::write(FILE, [before, BEGIN, &text, END, after].concat())?;
    }
    Ok(())
}
