//! The program `photinus`: tells where the neighbours of a flying robot are, from ultraviolet frames.
//!
//! ```text
//! input -> run: detect or locate, frame by frame -> output (JSON lines, CSV, overlay, lines to read) -> summary
//! info, convert: what a file holds, and the same in another format
//! simulate: a scene -> frames with truth
//! inject: a dataset -> the same with faults
//! evaluate: results against the truth of a dataset
//! calibrate: photos of a grid -> a camera whose errors are known
//! demo: all of it on a flight that the program carries along
//! reproduce: the experiments of the founding paper, each number beside the paper's
//! ```

mod aligned;
mod beforehand;
mod calibrate;
mod clock;
mod convert;
mod demo;
mod detect;
mod evaluate;
mod failure;
mod info;
mod inject;
mod input;
mod kind;
mod locate;
mod number;
mod output;
mod overlay;
mod page;
mod plots;
mod pose_options;
mod reproduce;
mod run;
mod simulate;
mod spot_options;
mod summary;
mod terminal;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

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
  photinus reproduce                           every figure of the founding paper, in simulation

Every command explains itself: photinus locate --help

Exit codes: 0 done, 1 something failed while running, 2 bad usage or input.";

#[derive(Subcommand)]
enum Command {
    Locate(locate::Args),
    Detect(detect::Args),
    Info(info::Args),
    Convert(convert::Args),
    Simulate(simulate::Args),
    Inject(inject::Args),
    Evaluate(evaluate::Args),
    Demo(demo::Args),
    Reproduce(reproduce::Args),
    Calibrate(calibrate::Args),
}

fn main() -> ExitCode {
    let command = Program::parse().command;
    let quiet = match &command {
        Command::Locate(args) => args.quiet(),
        Command::Detect(args) => args.quiet(),
        Command::Simulate(args) => args.quiet(),
        Command::Inject(args) => args.quiet(),
        Command::Evaluate(args) => args.quiet(),
        Command::Reproduce(args) => args.quiet(),
        Command::Calibrate(args) => args.quiet(),
        Command::Info(_) | Command::Convert(_) | Command::Demo(_) => false,
    };
    let mut terminal = Terminal::new(quiet);
    let done = match command {
        Command::Locate(args) => locate::run(&args, &mut terminal),
        Command::Detect(args) => detect::run(&args, &mut terminal),
        Command::Info(args) => info::run(&args, &terminal),
        Command::Convert(args) => convert::run(&args, &mut terminal),
        Command::Simulate(args) => simulate::run(&args, &mut terminal),
        Command::Inject(args) => inject::run(&args, &mut terminal),
        Command::Evaluate(args) => evaluate::run(&args, &terminal),
        Command::Demo(args) => demo::run(&args, &mut terminal),
        Command::Reproduce(args) => reproduce::run(&args, &mut terminal),
        Command::Calibrate(args) => calibrate::run(&args, &mut terminal),
    };
    let Err(failure) = done else { return ExitCode::SUCCESS };
    if let Some(message) = failure.message() {
        terminal.error(message);
    }
    failure.exit_code()
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
