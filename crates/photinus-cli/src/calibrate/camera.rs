//! `photinus calibrate camera`: photos of a grid -> a camera, and how sure it is.

use std::path::PathBuf;

use clap::ValueEnum;
use photinus_calibrate::camera::{BoardChoice, Calibration, Choices, calibrate};
use photinus_calibrate::lens::LensModel;
use photinus_io::camera::{CalibrationSummary, write_calibrated_camera_toml, write_ocam_text};
use photinus_io::whole::{Existing, write_whole};

use super::photos::{PhotoArgs, side_by_side};
use super::report::{CameraReport, Repeats};
use super::{advice, page, table};
use crate::ending::Content;
use crate::failure::Failure;
use crate::targets::{FileTarget, FolderTarget, Targets, WriteArgs};
use crate::terminal::Terminal;

const EXAMPLES: &str = "\
Examples:
  photinus calibrate camera photos/*.png --grid 7x5 --pitch 0.05 \\
      --out camera.toml
  photinus calibrate camera photos/*.png --grid 7x5 --out camera.toml \\
      --ocam calib_results.txt --report report
  photinus calibrate camera corners.csv --size 752x480 --grid 8x6 \\
      --out camera.toml
  photinus calibrate camera photos/*.png --grid 7x5 --model ocam:4 \\
      --board flat --out camera.toml

15 to 30 photos with the grid near, far, tilted and at every edge of the image
make a good calibration.";

/// Calibrate a camera from photos of a flat grid of LEDs
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Args {
    #[command(flatten)]
    photos: PhotoArgs,
    /// auto, equidistant, kannala-brandt (1 to 4 terms), kannala-brandt:N, ocam (degree 4 to 10), ocam:N
    #[arg(long, value_name = "MODEL", default_value = "auto", value_parser = models)]
    model: Models,
    /// Whether the LEDs are exactly on the grid, or their places are to be found
    #[arg(long, value_name = "BOARD", default_value = "auto")]
    board: BoardArg,
    /// Where to write the camera
    #[arg(long, value_name = "FILE.toml")]
    out: PathBuf,
    /// Where to write it as OCamCalib text, too
    #[arg(long, value_name = "FILE.txt")]
    ocam: Option<PathBuf>,
    /// A folder for the report
    #[arg(long, value_name = "DIR")]
    report: Option<PathBuf>,
    /// Random splits of the photos into halves
    #[arg(long, value_name = "N", default_value_t = 20)]
    splits: u64,
    /// Calibrations from photos drawn with replacement
    #[arg(long, value_name = "N", default_value_t = 100)]
    bootstraps: u64,
    #[command(flatten)]
    write: WriteArgs,
    /// Print errors only
    #[arg(short, long)]
    quiet: bool,
}

/// Whether the LEDs are exactly on the grid.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum BoardArg {
    /// They are
    Flat,
    /// They are not: find their places, or fail
    Solve,
    /// Find their places if the photos tell them
    Auto,
}

/// The models to choose among.
#[derive(Clone, Debug)]
struct Models(Vec<LensModel>);

fn models(name: &str) -> Result<Models, String> {
    LensModel::candidates(name).map(Models).map_err(|error| error.to_string())
}

impl Args {
    /// Whether only errors and results are to be printed.
    pub(crate) fn quiet(&self) -> bool {
        self.quiet
    }
}

/// Runs the command.
pub(crate) fn run(args: &Args, terminal: &mut Terminal) -> Result<(), Failure> {
    let mut targets = Targets::new(args.write, args.photos.files().iter().cloned());
    let out = Outputs {
        camera: targets.file(&args.out, Content::Toml)?,
        ocam: args.ocam.as_deref().map(|path| targets.file(path, Content::OcamText)).transpose()?,
        report: args.report.as_deref().map(|path| targets.folder(path)).transpose()?,
    };
    let searched = args.photos.search(terminal)?;
    let name = |photo: usize| &searched.photos[photo].name;
    for (photo, error) in &searched.refused {
        terminal.warning(format_args!("{}: not used: {error}; {}", name(*photo), advice::on(error)));
    }
    if let Some(advice) = advice::on_all(&searched) {
        return Err(Failure::Input(advice));
    }
    let choices = Choices {
        models: args.model.0.clone(),
        board: match args.board {
            BoardArg::Flat => BoardChoice::Flat,
            BoardArg::Solve => BoardChoice::Solve,
            BoardArg::Auto => BoardChoice::Auto,
        },
    };
    let calibration = calibrate(&searched.views, &searched.grid, searched.size_px, &choices, |stage| {
        terminal.summary(format_args!("{stage} ..."));
    })
    .map_err(|error| Failure::Input(error.to_string()))?;
    let repeats = repeat(&calibration, args, terminal);
    let report = CameraReport::of(&searched, &calibration, &repeats);
    table::print(&report, terminal)?;
    for warning in &report.warnings {
        terminal.warning(warning);
    }
    out.write(&calibration, &report, terminal)
}

/// Halves of the photos and photos drawn with replacement, on all processors.
fn repeat(calibration: &Calibration, args: &Args, terminal: &Terminal) -> Repeats {
    let count = |n: u64| usize::try_from(n).unwrap_or(usize::MAX);
    terminal.summary(format_args!(
        "calibrating {} halves and {} draws of the photos ...",
        2 * args.splits,
        args.bootstraps
    ));
    Repeats {
        splits: side_by_side(count(args.splits), |repeat| calibration.split(repeat as u64)),
        resampled: side_by_side(count(args.bootstraps), |repeat| calibration.resampled(repeat as u64))
            .into_iter()
            .flatten()
            .collect(),
    }
}

/// Where the calibration goes.
struct Outputs {
    camera: FileTarget,
    ocam: Option<FileTarget>,
    report: Option<FolderTarget>,
}

impl Outputs {
    fn write(
        &self,
        calibration: &Calibration,
        report: &CameraReport,
        terminal: &Terminal,
    ) -> Result<(), Failure> {
        let summary = CalibrationSummary {
            photos_used: u32::try_from(report.photos_used).unwrap_or(u32::MAX),
            mean_px: report.mean_px,
            rms_px: report.rms_px,
            max_px: report.max_px,
        };
        let (mut text, path) = (Vec::new(), self.camera.path());
        write_calibrated_camera_toml(calibration.camera(), Some(&summary), None, &mut text, path)
            .and_then(|()| self.camera.write(&text))
            .map_err(Failure::running)?;
        terminal.summary(format_args!("{}: written", path.display()));
        self.ocam.as_ref().map_or(Ok(()), |target| write_ocam(target, calibration, terminal))?;
        self.report.as_ref().map_or(Ok(()), |folder| write_report(folder, report, terminal))
    }
}

fn write_ocam(target: &FileTarget, calibration: &Calibration, terminal: &Terminal) -> Result<(), Failure> {
    let (mut text, path) = (Vec::new(), target.path());
    let ocam =
        calibration.ocam().map_err(|error| Failure::Running(format!("{}: {error}", path.display())))?;
    let inverse = write_ocam_text(&ocam.camera, &mut text, path).map_err(Failure::running)?;
    target.write(&text).map_err(Failure::running)?;
    terminal.summary(format_args!(
        "{}: written, within {:.3} mrad of the camera, its polynomials within {:.4} px of each other",
        path.display(),
        1e3 * ocam.max_off_rad,
        inverse.max_px
    ));
    Ok(())
}

fn write_report(target: &FolderTarget, report: &CameraReport, terminal: &Terminal) -> Result<(), Failure> {
    let text = serde_json::to_string_pretty(report)
        .map_err(|error| Failure::Running(format!("{}: {error}", target.path().display())))?;
    let folder = target.whole().map_err(Failure::running)?;
    write_whole(folder.path().join("report.json"), text.as_bytes(), Existing::Keep)
        .and_then(|()| page::write(folder.path(), report))
        .map_err(|error| Failure::running(folder.tell(error)))?;
    folder.keep().map_err(Failure::running)?;
    let path = target.path().join("report.json");
    terminal.summary(format_args!("{}: written, with a page to look at, index.html", path.display()));
    Ok(())
}
