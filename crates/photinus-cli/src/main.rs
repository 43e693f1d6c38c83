//! The program `photinus`: tells where the neighbours of a flying robot are, from ultraviolet frames.
//!
//! ```text
//! input -> run: detect or locate, frame by frame -> output (JSON lines, CSV, overlay, lines to read) -> summary
//! live: cameras -> the same, as `photinus run` says, for as long as it is asked
//! info, doctor, convert: what a file holds, what is doubtful about it, and the same in another format
//! simulate: a scene -> frames with truth
//! inject: a dataset -> the same with faults
//! evaluate: results against the truth of a dataset
//! calibrate: photos of a grid -> a camera whose errors are known
//! codes: what words must have -> books of words that LEDs blink
//! plan: LEDs, lens, sensor and airframe -> how far and how exactly they will see
//! swarm: a scenario -> robots that fly by what they see
//! demo: all of it on a flight that the program carries along
//! reproduce: the experiments of the founding paper, each number beside the paper's
//! led: a book of words -> an LED board that blinks them, and whether it does
//! completions, man: the command line itself, for shells and manuals
//! ```

mod aligned;
mod arguments;
mod beforehand;
mod calibrate;
mod codes;
mod convert;
mod demo;
mod detect;
mod doctor;
mod ending;
mod evaluate;
mod failure;
mod info;
mod inject;
mod input;
mod interrupt;
mod led;
mod live;
mod locate;
mod number;
mod output;
mod overlay;
mod page;
mod plan;
mod plots;
mod pose_options;
mod protocols;
mod recover;
mod replayed;
mod reproduce;
mod resume;
mod run;
mod shell;
mod simulate;
mod simulated;
mod spot_options;
mod summary;
mod swarm;
mod targets;
mod terminal;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::process::ExitCode;

use clap::{CommandFactory, Parser, Subcommand};

use failure::Failure;
use photinus_run::fault;
use terminal::Terminal;

/// That of the C library that static programs are linked with spins where threads meet: at real-time priorities nobody gets on.
#[cfg(target_env = "musl")]
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

/// Tells a flying robot where its neighbours are, from one ultraviolet camera.
#[derive(Parser)]
#[command(name = "photinus", version, subcommand_required = true, arg_required_else_help = true, after_help = EXAMPLES)]
struct Program {
    #[command(subcommand)]
    command: Command,
}

const EXAMPLES: &str = "\
Examples:
  # see it work: two robots fly, a page shows what was found
  photinus demo
  # what a file holds, whether it is in order
  photinus info camera.txt
  # the spots of a photo, and a picture of them
  photinus detect photo.png --overlay seen
  photinus locate recording --out results.jsonl --overlay seen
  # the same with the cameras of a robot, while it flies
  photinus run photinus.toml
  # frames with truth, where there is no recording
  photinus simulate scene.toml --out recording
  # how far LEDs and a camera will see, before they are bought
  photinus plan set-up.toml
  # robots that fly by what they see
  photinus swarm three --out three
  # how well that went, where truth is known
  photinus evaluate recording results.jsonl
  # every figure of the founding paper, in simulation
  photinus reproduce
  # what tells the blink words of a fleet apart
  photinus codes check book.txt

Every command explains itself: photinus locate --help

Exit codes: 0 done, 1 something failed while running, 2 bad usage or input, 130
interrupted.";

#[derive(Subcommand)]
enum Command {
    Locate(Box<locate::Args>),
    Run(live::Args),
    Led(led::Args),
    Detect(detect::Args),
    Info(info::Args),
    Doctor(doctor::Args),
    Convert(convert::Args),
    Recover(recover::Args),
    Simulate(simulate::Args),
    Swarm(swarm::Args),
    Plan(plan::Args),
    Inject(inject::Args),
    Evaluate(evaluate::Args),
    Demo(demo::Args),
    Reproduce(reproduce::Args),
    Calibrate(calibrate::Args),
    Completions(shell::CompletionsArgs),
    Man(shell::ManArgs),
    Codes(codes::Args),
}

fn main() -> ExitCode {
    fault::be_quiet();
    interrupt::listen();
    let command = arguments::read::<Program>().command;
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
            Self::Run(args) => args.quiet(),
            Self::Led(args) => args.quiet(),
            Self::Detect(args) => args.quiet(),
            Self::Simulate(args) => args.quiet(),
            Self::Swarm(args) => args.quiet(),
            Self::Plan(args) => args.quiet(),
            Self::Inject(args) => args.quiet(),
            Self::Evaluate(args) => args.quiet(),
            Self::Reproduce(args) => args.quiet(),
            Self::Calibrate(args) => args.quiet(),
            Self::Info(_)
            | Self::Doctor(_)
            | Self::Convert(_)
            | Self::Recover(_)
            | Self::Demo(_)
            | Self::Completions(_)
            | Self::Man(_) => false,
            Self::Codes(args) => args.quiet(),
        }
    }

    fn run(&self, terminal: &mut Terminal) -> Result<(), Failure> {
        match self {
            Self::Locate(args) => locate::run(args, terminal),
            Self::Run(args) => live::run(args, terminal),
            Self::Led(args) => led::run(args, terminal),
            Self::Detect(args) => detect::run(args, terminal),
            Self::Info(args) => info::run(args, terminal),
            Self::Doctor(args) => doctor::run(args, terminal),
            Self::Convert(args) => convert::run(args, terminal),
            Self::Recover(args) => recover::run(args, terminal),
            Self::Simulate(args) => simulate::run(args, terminal),
            Self::Swarm(args) => swarm::run(args, terminal),
            Self::Plan(args) => plan::run(args, terminal),
            Self::Inject(args) => inject::run(args, terminal),
            Self::Evaluate(args) => evaluate::run(args, terminal),
            Self::Demo(args) => demo::run(args, terminal),
            Self::Reproduce(args) => reproduce::run(args, terminal),
            Self::Calibrate(args) => calibrate::run(args, terminal),
            Self::Completions(args) => shell::completions(args, Program::command(), terminal),
            Self::Man(args) => shell::man(args, Program::command(), terminal),
            Self::Codes(args) => codes::run(args, terminal),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_command_line_is_in_order() {
        Program::command().debug_assert();
    }

    /// The commands in a text: lines that begin with `photinus`, with those that they go on in.
    fn commands(text: &str) -> Vec<String> {
        let joined = text.replace(" \\\n", " ");
        let lines = joined
            .lines()
            .flat_map(|line| line.split([';', '|', '>', '`']).flat_map(|part| part.split("&&")));
        lines.map(str::trim).filter(|part| part.starts_with("photinus ")).map(str::to_owned).collect()
    }

    #[test]
    fn every_example_of_the_help_and_of_the_readme_is_a_command() {
        fn of(command: &clap::Command) -> String {
            let own = command.get_after_help().map_or(String::new(), |text| format!("{text}\n"));
            own + &command.get_subcommands().map(of).collect::<String>()
        }
        let readme = include_str!("../../../README.md");
        let blocks =
            readme.split("```sh\n").skip(1).filter_map(|rest| rest.split("```").next()).collect::<String>();
        let examples: Vec<String> =
            commands(&of(&Program::command())).into_iter().chain(commands(&blocks)).collect();
        assert!(examples.len() > 50, "{}", examples.len());
        for example in examples {
            let parsed = Program::try_parse_from(example.split_whitespace());
            assert!(
                parsed.is_ok(),
                "{example}: {}",
                parsed.err().map_or(String::new(), |error| error.to_string())
            );
        }
    }

    #[test]
    fn examples_fit_a_narrow_terminal_and_none_is_cut_in_its_middle() {
        fn of(command: &clap::Command) -> Vec<String> {
            let own = command.get_after_help().map(ToString::to_string);
            own.into_iter().chain(command.get_subcommands().flat_map(of)).collect()
        }
        let told = of(&Program::command());
        assert!(told.len() >= 16, "{}", told.len());
        let paragraphs =
            told.iter().flat_map(|text| text.split("\n\n")).filter(|text| text.starts_with("Examples:"));
        for line in paragraphs.flat_map(str::lines) {
            assert!(line.chars().count() <= 80, "{line}");
        }
    }
}
