//! `photinus codes check`: what a book truly has, and whether that is what was asked for.

use std::ops::RangeInclusive;
use std::path::PathBuf;

use photinus::identity::{CodeBook, Properties};
use photinus_io::codes::read_codes;

use super::{duty, report};
use crate::failure::Failure;
use crate::info::print;
use crate::terminal::Terminal;

const EXAMPLES: &str = "\
Examples:
  photinus codes check book.txt
  photinus codes check book.txt --distance 3 --longest-run 3 --self-distance 2

Exits with 2 when words cannot be told apart, or what was asked for is not there.";

/// Tell what a book holds: distances at any shift, runs, duty, and how many frames it takes to know a word
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Args {
    /// Code books
    #[arg(value_name = "FILE", required = true)]
    files: Vec<PathBuf>,
    /// The fewest bits in which two words may differ, at any shift
    #[arg(long, value_name = "BITS", default_value_t = 1)]
    distance: u32,
    /// The most equal bits that may follow each other
    #[arg(long, value_name = "BITS")]
    longest_run: Option<usize>,
    /// The fewest bits in which a word may differ from its own shifts
    #[arg(long, value_name = "BITS", default_value_t = 0)]
    self_distance: u32,
    /// The share of bits that may be on, such as 0.4..0.6
    #[arg(long, value_name = "FROM..TO", value_parser = duty)]
    duty: Option<RangeInclusive<f64>>,
}

/// Runs the command. A book that is not as asked for does not keep the others from being told.
pub(super) fn run(args: &Args, terminal: &Terminal) -> Result<(), Failure> {
    let mut failed = false;
    for (number, path) in args.files.iter().enumerate() {
        if number > 0 {
            terminal.result("")?;
        }
        match read_codes(path) {
            Ok(book) => {
                print(path, &report(&book), terminal)?;
                for missed in args.missed_by(&book) {
                    failed = true;
                    terminal.error(format_args!("{}: {missed}", path.display()));
                }
            }
            Err(error) => {
                failed = true;
                terminal.error(error);
            }
        }
    }
    if failed { Err(Failure::Frames { all: true }) } else { Ok(()) }
}

impl Args {
    /// What is not as asked for.
    fn missed_by(&self, book: &CodeBook) -> Vec<String> {
        let has = Properties::of(book);
        let mut missed = Vec::new();
        if let Some((distance, [a, b])) = has.distance.filter(|(distance, _)| *distance < self.distance) {
            missed.push(format!("words {a} and {b} are {distance} bits apart, not {}", self.distance));
        }
        if let Some((distance, word)) =
            has.self_distance.filter(|(distance, _)| *distance < self.self_distance)
        {
            let asked = self.self_distance;
            missed.push(format!("word {word} is {distance} bits from its own shifts, not {asked}"));
        }
        let run = has.longest_dark.max(has.longest_lit);
        if let Some(longest) = self.longest_run.filter(|longest| run > *longest) {
            missed.push(format!("{run} equal bits follow each other, not {longest}"));
        }
        if let Some(duty) =
            self.duty.as_ref().filter(|duty| !has.duty.iter().all(|share| duty.contains(share)))
        {
            let [least, most] = has.duty;
            let (from, to) = (duty.start(), duty.end());
            missed.push(format!(
                "the share of bits that are on is {least:.2} to {most:.2}, not {from} to {to}"
            ));
        }
        missed
    }
}
