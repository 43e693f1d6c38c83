//! `photinus completions` and `photinus man`: what shells and manuals are told of the command line.

use std::path::PathBuf;

use clap_complete::Shell;
use photinus_io::Error;

use crate::failure::Failure;
use crate::targets::{Targets, WriteArgs};
use crate::terminal::Terminal;

const EXAMPLES: &str = "\
Examples:
  photinus completions bash > photinus.bash
  photinus completions fish > ~/.config/fish/completions/photinus.fish";

/// Print a script that completes commands and options in a shell
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct CompletionsArgs {
    /// For which shell
    #[arg(value_name = "SHELL")]
    shell: Shell,
}

/// Write manual pages, one for each command
#[derive(Debug, clap::Args)]
pub(crate) struct ManArgs {
    /// Where to write: a new folder; `man -l DIR/photinus-locate.1` shows a page
    #[arg(value_name = "DIR")]
    out: PathBuf,
    #[command(flatten)]
    write: WriteArgs,
}

/// Prints the completions of `program`.
pub(crate) fn completions(
    args: &CompletionsArgs,
    mut program: clap::Command,
    terminal: &Terminal,
) -> Result<(), Failure> {
    let mut text = Vec::new();
    clap_complete::generate(args.shell, &mut program, "photinus", &mut text);
    terminal.result(String::from_utf8_lossy(&text).trim_end())
}

/// Writes the pages of `program` and its commands.
pub(crate) fn man(args: &ManArgs, program: clap::Command, terminal: &Terminal) -> Result<(), Failure> {
    let making = Targets::new(args.write, []).folder(&args.out)?.whole().map_err(Failure::input)?;
    clap_mangen::generate_to(program, making.path())
        .map_err(|error| Failure::running(making.tell(Error::io(making.path(), error))))?;
    making.keep().map_err(Failure::running)?;
    terminal.summary(format_args!("{}: written", args.out.display()));
    Ok(())
}
