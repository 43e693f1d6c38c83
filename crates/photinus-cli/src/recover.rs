//! `photinus recover`: makes a recording that was cut off whole again.

use std::path::PathBuf;

use photinus_link::recording::{Recovered, recover};

use crate::ending::Content;
use crate::failure::Failure;
use crate::targets::{Targets, WriteArgs};
use crate::terminal::Terminal;

const EXAMPLES: &str = "\
Examples:
  # the power went while it was recorded
  photinus recover flight.mcap
  photinus recover flight.mcap --out whole.mcap

Everything that was written up to the last second is there: messages keep their
order and their times, and the new file has the index that the old one lacks.";

/// Mend an MCAP recording that was cut off
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Args {
    /// The recording; it stays as it is
    #[arg(value_name = "FILE")]
    file: PathBuf,
    /// Where to write [default: FILE with .recovered.mcap in place of .mcap]
    #[arg(long, value_name = "FILE.mcap")]
    out: Option<PathBuf>,
    #[command(flatten)]
    write: WriteArgs,
}

/// Runs the command.
pub(crate) fn run(args: &Args, terminal: &Terminal) -> Result<(), Failure> {
    let out = args.out.clone().unwrap_or_else(|| args.file.with_extension("recovered.mcap"));
    let target = Targets::new(args.write, [args.file.clone()]).file(&out, Content::Recording)?;
    let part = target.part();
    let Recovered { messages, arrived_ns, damage } = recover(&args.file, &part).map_err(Failure::input)?;
    if messages == 0 {
        let _ = std::fs::remove_file(part);
        let file = args.file.display();
        return Err(Failure::Input(format!(
            "{file}: no whole message is in it; {}",
            damage.unwrap_or_default()
        )));
    }
    target.take().map_err(Failure::running)?;
    let seconds = arrived_ns.map_or(0.0, |(first, last)| (last - first) as f64 * 1e-9);
    if let Some(damage) = damage {
        terminal.note(format_args!("{}: read up to the damage: {damage}", args.file.display()));
    }
    terminal.result(format_args!("{}: {messages} messages, {seconds:.1} s", out.display()))
}
