//! `photinus codes`: books of words that LEDs blink: designed, checked, and those that come with the program.

mod check;
mod design;
mod preset;
mod told;

use std::ops::RangeInclusive;

use clap::Subcommand;

use crate::failure::Failure;
use crate::terminal::Terminal;

pub(crate) use told::report;

/// Design and check books of blink words, or write one that comes with the program
#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    #[command(subcommand)]
    what: What,
}

/// What is done with books.
#[derive(Debug, Subcommand)]
enum What {
    Design(design::Args),
    Check(check::Args),
    Preset(preset::Args),
}

impl Args {
    /// Whether only errors and results are to be printed.
    pub(crate) fn quiet(&self) -> bool {
        matches!(&self.what, What::Design(args) if args.quiet())
    }
}

/// Runs the command.
pub(crate) fn run(args: &Args, terminal: &Terminal) -> Result<(), Failure> {
    match &args.what {
        What::Design(args) => design::run(args, terminal),
        What::Check(args) => check::run(args, terminal),
        What::Preset(args) => preset::run(args, terminal),
    }
}

/// A range of shares as it is given: `0.4..0.6`.
fn duty(text: &str) -> Result<RangeInclusive<f64>, String> {
    let ends = text.split_once("..").and_then(|(low, high)| {
        let end = |text: &str| text.trim_start_matches('=').parse::<f64>().ok();
        Some((end(low)?, end(high)?))
    });
    match ends {
        Some((low, high)) if 0.0 <= low && low <= high && high <= 1.0 => Ok(low..=high),
        _ => Err("write two shares from 0 to 1 in order, such as 0.4..0.6".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn duties_are_ranges_of_shares() {
        assert_eq!(duty("0.4..0.6"), Ok(0.4..=0.6));
        assert_eq!(duty("0..1"), Ok(0.0..=1.0));
        for text in ["0.4", "0.6..0.4", "-1..1", "0..2", "nan..1", "..", "a..b"] {
            assert!(duty(text).is_err(), "{text}");
        }
    }
}
