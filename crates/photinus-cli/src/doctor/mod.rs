//! `photinus doctor`: enters what a flight will use, leaves what is doubtful about it, each with what to do.
//!
//! ```text
//! airframe, camera and mask as `info` reads them, but only what is doubtful
//! frames   a recording made on the ground: light, focus, exposure, time
//! ```

mod frames;

use std::path::{Path, PathBuf};

use nalgebra::Vector3;
use photinus_io::airframe::read_airframe;
use photinus_io::kind::Kind;
use photinus_io::mask::read_mask;
use photinus_io::read_camera;

use crate::failure::Failure;
use crate::terminal::Terminal;

const EXAMPLES: &str = "\
Examples:
  photinus doctor camera.toml quad.toml mask.png recording
  photinus doctor camera.toml frames/
  # what a run recorded
  photinus doctor camera.toml flight.mcap

A recording of a minute on the ground, with a neighbour in sight, tells most.
Exits with 0 whatever is doubtful, with 2 when a file cannot be read.";

/// From here an airframe is looked at, m: far enough that only the direction matters.
const AWAY_M: f64 = 20.0;
/// Sides from which it is looked at, deg apart.
const STEP_DEG: u32 = 5;

/// Say what is doubtful before a flight: camera, airframe, mask, a recording from the ground
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Args {
    /// A camera, an airframe, a mask, a dataset, an MCAP recording, a video or images
    #[arg(value_name = "FILE", required = true)]
    files: Vec<PathBuf>,
}

/// What was found about a file.
#[derive(Debug, Default)]
pub(crate) struct Findings {
    /// What is as it should be, in a few words each.
    fine: Vec<String>,
    /// What is doubtful, and what to do, a sentence each.
    doubts: Vec<String>,
}

impl Findings {
    fn check(&mut self, is_fine: bool, fine: impl Into<String>, doubt: impl Into<String>) {
        if is_fine { self.fine.push(fine.into()) } else { self.doubts.push(doubt.into()) }
    }
}

/// Runs the command.
pub(crate) fn run(args: &Args, terminal: &Terminal) -> Result<(), Failure> {
    let size = args.files.iter().find_map(|path| camera_size(path));
    let (mut failed, mut doubts) = (0, 0);
    for path in &args.files {
        match examined(path, size) {
            Ok(findings) => {
                doubts += findings.doubts.len();
                terminal.result(format_args!("{}", path.display()))?;
                for fine in &findings.fine {
                    terminal.result(format_args!("  ok  {fine}"))?;
                }
                for doubt in &findings.doubts {
                    terminal.result(format_args!("   !  {doubt}"))?;
                }
            }
            Err(error) => {
                failed += 1;
                terminal.error(error);
            }
        }
    }
    terminal.result(match doubts {
        0 if failed > 0 => "Nothing is doubtful of what could be read.".to_owned(),
        0 => "Nothing is doubtful.".to_owned(),
        1 => "One thing is doubtful.".to_owned(),
        doubts => format!("{doubts} things are doubtful."),
    })?;
    if failed > 0 { Err(Failure::Frames { all: true }) } else { Ok(()) }
}

/// Columns and rows of the camera, if the file is one.
fn camera_size(path: &Path) -> Option<(usize, usize)> {
    let camera = matches!(Kind::of(path), Ok(Kind::Camera(_))).then(|| read_camera(path).ok())??.camera;
    Some((camera.width(), camera.height()))
}

fn examined(path: &Path, size: Option<(usize, usize)>) -> photinus_io::Result<Findings> {
    match Kind::of(path)? {
        Kind::Camera(_) => camera(path),
        Kind::Airframe => airframe(path),
        Kind::Image if read_mask(path).is_ok() && is_mask(path)? => mask(path, size),
        kind if kind.holds_frames() => frames::examined(path, kind, size),
        other => {
            Err(other.refuse(path, "a camera, an airframe, a mask or frames", "name what a flight uses"))
        }
    }
}

fn camera(path: &Path) -> photinus_io::Result<Findings> {
    let file = read_camera(path)?;
    let camera = &file.camera;
    let mut findings = Findings::default();
    let reach_deg = camera.field_limit_rad().to_degrees();
    findings.check(
        camera.stated_limit_rad().is_some(),
        format!("answers up to {reach_deg:.0} deg off the axis"),
        format!(
            "it does not say how far it was calibrated: answers up to {reach_deg:.0} deg are believed; calibrate it with \
             `photinus calibrate camera`, or give field_limit_deg"
        ),
    );
    findings.check(
        camera.parameter_covariance().is_some(),
        "says how sure its bearings are",
        "it does not say how sure it is: distances of far neighbours claim too little error; calibrate it with `photinus \
         calibrate camera`",
    );
    findings.check(
        camera.optics().is_some(),
        "its optics are measured",
        "its optics are not measured: the first 32 frames with spots teach them; `photinus calibrate optics` measures them once",
    );
    if let Some(calibration) = file.calibration {
        findings.check(
            calibration.mean_px < 0.3,
            format!("residuals of {:.2} px in the mean", calibration.mean_px),
            format!(
                "residuals of {:.2} px in the mean: look at the report of the calibration; photos may be blurred or the board bent",
                calibration.mean_px
            ),
        );
    }
    findings.doubts.extend(file.oddities);
    Ok(findings)
}

fn airframe(path: &Path) -> photinus_io::Result<Findings> {
    let file = read_airframe(path)?;
    let sides = 360 / STEP_DEG;
    let from = |side: u32| {
        let (sin, cos) = libm::sincos(f64::from(side * STEP_DEG).to_radians());
        file.airframe.visible(Vector3::new(cos, sin, 0.0) * AWAY_M).count()
    };
    let (dark, single) = (0..sides).fold((0, 0), |(dark, single), side| match from(side) {
        0 => (dark + 1, single),
        1 => (dark, single + 1),
        _ => (dark, single),
    });
    let mut findings = Findings::default();
    findings.check(
        dark == 0,
        "seen from every side",
        format!("no marker shows from {} % of the sides: add LEDs there", 100 * dark / sides),
    );
    findings.check(
        single == 0,
        "two markers or more from every side: its distance is known",
        format!("a single marker shows from {} % of the sides: from there the distance comes from brightness alone", 100 * single / sides),
    );
    findings.doubts.extend(file.notes);
    Ok(findings)
}

/// Whether an image is of black and white alone, as frames are not.
fn is_mask(path: &Path) -> photinus_io::Result<bool> {
    let image = photinus_io::image::read_image(path)?.image;
    let pixels = image.pixels();
    Ok(pixels.contains(&0) && pixels.iter().all(|&level| level == 0 || level == u8::MAX))
}

fn mask(path: &Path, size: Option<(usize, usize)>) -> photinus_io::Result<Findings> {
    let file = read_mask(path)?;
    let mut findings = Findings::default();
    if let Some((width, height)) = size {
        match file.check_size(width, height) {
            Ok(()) => findings.fine.push("of the camera's size".to_owned()),
            Err(error) => findings.doubts.push(error.to_string()),
        }
    }
    findings.doubts.extend(file.notes);
    Ok(findings)
}
