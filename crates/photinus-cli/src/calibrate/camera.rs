//! `photinus calibrate camera`: photos of a grid -> a camera, and how sure it is.

use std::path::PathBuf;

use crate::failure::Failure;
use crate::terminal::Terminal;

/// Calibrate a camera from photos of a grid of LEDs
#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// Photos of the grid, or one table of corners (.csv)
    #[arg(value_name = "PHOTOS", required = true)]
    photos: Vec<PathBuf>,
    /// Print errors only
    #[arg(short, long)]
    quiet: bool,
}

impl Args {
    /// Whether only errors and results are to be printed.
    pub(crate) fn quiet(&self) -> bool {
        self.quiet
    }
}

/// Runs the command.
pub(crate) fn run(args: &Args, _: &mut Terminal) -> Result<(), Failure> {
    Err(Failure::Running(format!("{} photos: not in this build", args.photos.len())))
}
