//! `photinus calibrate`: photos and recordings -> what Photinus must know beforehand, each with its uncertainty.

mod advice;
mod camera;
mod coverage;
mod photos;
mod report;
mod table;

use clap::Subcommand;

use crate::failure::Failure;
use crate::terminal::Terminal;

/// Calibrate: from photos and recordings to a camera whose errors are known
#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    #[command(subcommand)]
    what: What,
}

/// What is calibrated.
#[derive(Debug, Subcommand)]
enum What {
    Camera(camera::Args),
    Coverage(coverage::Args),
}

impl Args {
    /// Whether only errors and results are to be printed.
    pub(crate) fn quiet(&self) -> bool {
        match &self.what {
            What::Camera(args) => args.quiet(),
            What::Coverage(_) => false,
        }
    }
}

/// Runs the command.
pub(crate) fn run(args: &Args, terminal: &mut Terminal) -> Result<(), Failure> {
    match &args.what {
        What::Camera(args) => camera::run(args, terminal),
        What::Coverage(args) => coverage::run(args, terminal),
    }
}
