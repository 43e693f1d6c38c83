//! `photinus codes preset`: the books that come with the program.

use std::path::PathBuf;

use photinus_io::codes::{PRESETS, Preset};

use crate::ending::Content;
use crate::failure::Failure;
use crate::targets::{Targets, WriteArgs};
use crate::terminal::Terminal;

const EXAMPLES: &str = "\
Examples:
  # which there are
  photinus codes preset
  # one of them as a file
  photinus codes preset l18-d3-r2 --out book.txt

Their names say bits of a word, distance and longest run; this program designed
them.";

/// Write a book that comes with the program, or list them
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Args {
    /// Which book; without, all are listed
    #[arg(value_name = "NAME")]
    name: Option<String>,
    /// Where to write it; standard output without
    #[arg(long, value_name = "FILE", default_value = "-", requires = "name")]
    out: PathBuf,
    #[command(flatten)]
    write: WriteArgs,
}

/// Runs the command.
pub(super) fn run(args: &Args, terminal: &Terminal) -> Result<(), Failure> {
    let Some(name) = &args.name else {
        return PRESETS
            .iter()
            .try_for_each(|preset| terminal.result(format_args!("{:<10} {}", preset.name, claim(preset))));
    };
    let Some(preset) = PRESETS.iter().find(|preset| preset.name == name) else {
        let names: Vec<&str> = PRESETS.iter().map(|preset| preset.name).collect();
        return Err(Failure::Input(format!("{name}: no book of this name; there are {}", names.join(", "))));
    };
    let target = Targets::new(args.write, []).file(&args.out, Content::Codes)?;
    match target.is_standard() {
        true => terminal.result(preset.text.trim_end()),
        false => target.write(preset.text.as_bytes()).map_err(Failure::running),
    }
}

/// What the first line of its file says.
fn claim(preset: &Preset) -> &'static str {
    preset.text.lines().next().unwrap_or_default().trim_start_matches("# ")
}
