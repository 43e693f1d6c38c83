//! `photinus calibrate`: photos and recordings -> what Photinus must know beforehand, each with its uncertainty.

mod advice;
mod airframe;
mod airframe_light;
mod camera;
mod coverage;
mod mask;
mod mounting;
mod optics;
mod page;
mod photos;
mod report;
mod spot_size;
mod table;

use clap::Subcommand;

use crate::failure::Failure;
use crate::terminal::Terminal;

pub(crate) use optics::Width;

/// Calibrate cameras and airframes from photos and recordings, with the error of every number
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
    Optics(optics::Args),
    Mask(mask::Args),
    SpotSize(spot_size::Args),
    Mounting(mounting::Args),
    Airframe(airframe::Args),
    AirframeLight(airframe_light::Args),
}

impl Args {
    /// Whether only errors and results are to be printed.
    pub(crate) fn quiet(&self) -> bool {
        match &self.what {
            What::Camera(args) => args.quiet(),
            What::Coverage(_) => false,
            What::Optics(args) => args.quiet(),
            What::Mask(args) => args.quiet(),
            What::SpotSize(args) => args.quiet(),
            What::Mounting(args) => args.quiet(),
            What::Airframe(args) => args.quiet(),
            What::AirframeLight(args) => args.quiet(),
        }
    }
}

/// Runs the command.
pub(crate) fn run(args: &Args, terminal: &mut Terminal) -> Result<(), Failure> {
    match &args.what {
        What::Camera(args) => camera::run(args, terminal),
        What::Coverage(args) => coverage::run(args, terminal),
        What::Optics(args) => optics::run(args, terminal),
        What::Mask(args) => mask::run(args, terminal),
        What::SpotSize(args) => spot_size::run(args, terminal),
        What::Mounting(args) => mounting::run(args, terminal),
        What::Airframe(args) => airframe::run(args, terminal),
        What::AirframeLight(args) => airframe_light::run(args, terminal),
    }
}
