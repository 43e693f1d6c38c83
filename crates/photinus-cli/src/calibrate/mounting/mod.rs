//! `photinus calibrate mounting`: places in the image of what is known in the body frame -> how the camera sits.

mod report;

use std::path::PathBuf;

use nalgebra::Unit;
use photinus::camera::{Camera, Pixel};
use photinus_calibrate::mounting::{Known, MountingError, Observation, calibrate};
use photinus_calibrate::sighted::Sighted;
use photinus_io::calibration::{self, KnownSighting, mounting_text, read_known_sightings};
use photinus_io::{Error, Place};

use crate::beforehand;
use crate::ending::Content;
use crate::failure::Failure;
use crate::targets::{Targets, WriteArgs};
use crate::terminal::Terminal;

const EXAMPLES: &str = "\
Examples:
  photinus calibrate mounting seen.csv --camera camera.toml \\
      --out mounting.toml

The table has the columns u_px,v_px and x,y,z: the direction in the body frame
(x forward, y left, z up) in which a marker stood, for markers so far away that
the camera's place does not matter. With x_m,y_m,z_m in their place, positions
in the body frame, the camera's place is found as well. A column sigma_px may
say how sure each row is. Spread the markers over the image; ten or more, of
which a few may be wrong.";

/// Standard deviation of a place whose row gives none, px: only its ratio to others matters.
const SIGMA_PX: f64 = 1.0;

/// Calibrate how a camera sits on its vehicle
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Args {
    /// The table (CSV) of places in the image and directions or positions in the body frame
    #[arg(value_name = "TABLE")]
    table: PathBuf,
    /// The camera's calibration, in any format that `photinus info` knows
    #[arg(long, value_name = "FILE")]
    camera: PathBuf,
    /// Write the mounting, described in docs/file-formats.md
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    #[command(flatten)]
    write: WriteArgs,
    /// Print errors only
    #[arg(short, long)]
    quiet: bool,
}

impl Args {
    /// Whether only errors are to be printed.
    pub(crate) fn quiet(&self) -> bool {
        self.quiet
    }
}

/// Runs the command.
pub(crate) fn run(args: &Args, terminal: &Terminal) -> Result<(), Failure> {
    let mut targets = Targets::new(args.write, [args.table.clone(), args.camera.clone()]);
    let out = args.out.as_deref().map(|path| targets.file(path, Content::Toml)).transpose()?;
    let camera = beforehand::camera(&args.camera, terminal).map_err(Failure::input)?.camera;
    let rows = read_known_sightings(&args.table).map_err(Failure::input)?;
    let observations: Vec<Observation> =
        rows.iter().map(|row| observation(args, &camera, row)).collect::<Result<_, _>>()?;
    let found = calibrate(&observations).map_err(|error| refuse(args, error))?;
    if let Some(out) = out {
        let file = calibration::MountingFile {
            body_from_camera: found.body_from_camera,
            rotation_covariance_rad2: found.rotation_covariance_rad2,
            position_m: found.centre.map(|centre| centre.0),
            position_covariance_m2: found.centre.map(|centre| centre.1),
        };
        out.write(format!("{}{}", report::comment(&found), mounting_text(&file)).as_bytes())
            .map_err(Failure::running)?;
    }
    match args.quiet {
        true => Ok(()),
        false => terminal.result(report::Told { found: &found, rows: &rows }),
    }
}

fn observation(args: &Args, camera: &Camera, row: &KnownSighting) -> Result<Observation, Failure> {
    let known = match row.known {
        calibration::Known::Direction(vector) => Known::Direction(Unit::new_normalize(vector)),
        calibration::Known::Position(position_m) => Known::Position(position_m),
    };
    let pixel = Pixel::new(row.u_px, row.v_px);
    let sighted = Sighted::new(camera, pixel, row.sigma_px.unwrap_or(SIGMA_PX));
    let outside = || {
        let reason = format!("the camera sees nothing at ({}, {}) px", row.u_px, row.v_px);
        let advice = "give places inside the image and the camera's field, in pixels of this calibration";
        Failure::input(Error::format(&args.table, reason).at(Place::Line(row.line)).advise(advice))
    };
    Ok(Observation { sighted: sighted.ok_or_else(outside)?, known })
}

fn refuse(args: &Args, error: MountingError) -> Failure {
    let advice = match error {
        MountingError::TooFew { .. } => "add rows, spread over the image",
        MountingError::Alike { .. } => "add markers in other directions, far apart in the image",
        MountingError::PlaceUnknown { .. } => {
            "add markers near the camera and on other sides, or give directions (x, y, z) and measure the place"
        }
        MountingError::AtTheCamera => {
            "check that the positions are those of the markers, in the body frame, in metres"
        }
        _ => {
            "check that rows pair the right places with the right directions, and that the camera file is this camera's"
        }
    };
    Failure::input(Error::format(&args.table, error.to_string()).advise(advice))
}
