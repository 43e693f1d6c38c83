//! The last test of a run, without a harness, which would hide what it prints: it lists the tests that skipped, and why.
//!
//! It passes all the same, unless PHOTINUS_SKIP_NOTHING is set: on a machine that has everything, a skip is a failure.

#![allow(clippy::print_stdout, reason = "this is what it is for")]

use std::process::ExitCode;

use photinus_testing::Skipped;

fn main() -> ExitCode {
    // Whoever asks for the names of tests runs none.
    if std::env::args().any(|argument| argument == "--list") {
        return ExitCode::SUCCESS;
    }
    let skipped = Skipped::of_this_run().take();
    match skipped.len() {
        0 => println!("\nno test was skipped"),
        count => println!("\n{count} tests were skipped:"),
    }
    skipped.iter().for_each(|line| println!("skipped: {line}"));
    if !skipped.is_empty() && std::env::var_os("PHOTINUS_SKIP_NOTHING").is_some() {
        println!("PHOTINUS_SKIP_NOTHING is set, so this is a failure");
        return ExitCode::FAILURE;
    }
    ExitCode::SUCCESS
}
