//! The program `photinus`: tells where the neighbours of a flying robot are, from ultraviolet frames.
//!
//! ```text
//! input -> run: detect or locate, frame by frame -> output (JSON lines, CSV, overlay, lines to read) -> summary
//! info, convert: what a file holds, and the same in another format
//! simulate: a scene -> frames with truth
//! inject: a dataset -> the same with faults
//! evaluate: results against the truth of a dataset
//! calibrate: photos of a grid -> a camera whose errors are known
//! codes: what words must have -> books of words that LEDs blink
//! demo: all of it on a flight that the program carries along
//! reproduce: the experiments of the founding paper, each number beside the paper's
//! ```

mod aligned;
mod beforehand;
mod calibrate;
mod clock;
mod codes;
mod convert;
mod demo;
mod detect;
mod evaluate;
mod failure;
mod fault;
mod info;
mod inject;
mod input;
mod interrupt;
mod kind;
mod locate;
mod number;
mod odd_frame;
mod output;
mod overlay;
mod page;
mod plots;
mod pose_options;
mod quantiles;
mod reproduce;
mod resume;
mod run;
mod simulate;
mod spot_options;
mod summary;
mod targets;
mod terminal;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::process::ExitCode;

use clap::{Parser, Subcommand};

use failure::Failure;
use terminal::Terminal;

/// Tells a flying robot where its neighbours are, from one ultraviolet camera.
#[derive(Parser)]
#[command(name = "photinus", version, subcommand_required = true, arg_required_else_help = true, after_help = EXAMPLES)]
struct Program {
    #[command(subcommand)]
    command: Command,
}

const EXAMPLES: &str = "\
Examples:
  photinus demo                                see it work: two robots fly, a page shows what was found
  photinus info camera.txt                     what a file holds, whether it is in order
  photinus detect photo.png --overlay seen     the spots of a photo, and a picture of them
  photinus locate recording --out results.jsonl --overlay seen
  photinus simulate scene.toml --out recording frames with truth, where there is no recording
  photinus evaluate recording results.jsonl    how well that went, where the truth is known
  photinus codes check book.txt                what tells the blink words of a fleet apart
  photinus reproduce                           every figure of the founding paper, in simulation

Every command explains itself: photinus locate --help

Exit codes: 0 done, 1 something failed while running, 2 bad usage or input, 130 interrupted.";

#[derive(Subcommand)]
enum Command {
    Locate(Box<locate::Args>),
    Detect(detect::Args),
    Info(info::Args),
    Convert(convert::Args),
    Simulate(simulate::Args),
    Inject(inject::Args),
    Evaluate(evaluate::Args),
    Demo(demo::Args),
    Reproduce(reproduce::Args),
    Calibrate(calibrate::Args),
    Codes(codes::Args),
}

fn main() -> ExitCode {
    fault::be_quiet();
    interrupt::listen();
    let command = Program::parse().command;
    let mut terminal = Terminal::new(command.quiet());
    let done = catch_unwind(AssertUnwindSafe(|| command.run(&mut terminal))).unwrap_or_else(|payload| {
        Err(Failure::Running(format!("{}; {}", fault::told(payload.as_ref()), fault::ADVICE)))
    });
    let Err(failure) = done else { return ExitCode::SUCCESS };
    if let Some(message) = failure.message() {
        terminal.error(message);
    }
    failure.exit_code()
}

impl Command {
    fn quiet(&self) -> bool {
        match self {
            Self::Locate(args) => args.quiet(),
            Self::Detect(args) => args.quiet(),
            Self::Simulate(args) => args.quiet(),
            Self::Inject(args) => args.quiet(),
            Self::Evaluate(args) => args.quiet(),
            Self::Reproduce(args) => args.quiet(),
            Self::Calibrate(args) => args.quiet(),
            Self::Codes(args) => args.quiet(),
            Self::Info(_) | Self::Convert(_) | Self::Demo(_) => false,
        }
    }

    fn run(&self, terminal: &mut Terminal) -> Result<(), Failure> {
        match self {
            Self::Locate(args) => locate::run(args, terminal),
            Self::Detect(args) => detect::run(args, terminal),
            Self::Info(args) => info::run(args, terminal),
            Self::Convert(args) => convert::run(args, terminal),
            Self::Simulate(args) => simulate::run(args, terminal),
            Self::Inject(args) => inject::run(args, terminal),
            Self::Evaluate(args) => evaluate::run(args, terminal),
            Self::Demo(args) => demo::run(args, terminal),
            Self::Reproduce(args) => reproduce::run(args, terminal),
            Self::Calibrate(args) => calibrate::run(args, terminal),
            Self::Codes(args) => codes::run(args, terminal),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_command_line_is_in_order() {
        use clap::CommandFactory;
        Program::command().debug_assert();
    }
}
