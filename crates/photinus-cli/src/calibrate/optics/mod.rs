//! `photinus calibrate optics`: frames with LEDs -> the optics of the camera that took them.
//!
//! ```text
//! frames    every frame of every recording -> spots and dark patches; which camera they are of
//! table     what was learned, to read
//! page      the same as a page of figures
//! width     how wide a point spread is
//! ```

mod frames;
mod page;
mod table;
mod width;

use std::path::PathBuf;

use photinus_calibrate::optics::{Collection, LearnError, Learned, learn};
use photinus_io::camera::{OpticsSummary, write_calibrated_camera_toml};

use crate::ending::Content;
use crate::failure::Failure;
use crate::input::{Input, InputArgs};
use crate::targets::{Targets, WriteArgs};
use crate::terminal::Terminal;

pub(crate) use width::Width;

const EXAMPLES: &str = "\
Examples:
  photinus calibrate optics flight --out camera.toml --report optics
  photinus calibrate optics photos/*.png --camera calib.txt --out camera.toml
  photinus calibrate optics video.y4m --camera camera.toml --out measured.toml
  photinus info measured.toml

Any frames with LEDs will do, moving or not; where the LEDs are need not be
known. Let there be a hundred spots or more that stand 10 px and more apart, all
over the image, some so bright that pixels are full, most not. Turn the camera while
LEDs stand still, and it learns how much light the lens passes off its axis. What the frames
do not tell is said, and stays what is believed of any camera. Without --camera
a dataset's own is taken.";

/// Calibrate lens and sensor: point spread, noise, saturation, from any frames with LEDs
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Args {
    #[command(flatten)]
    input: InputArgs,
    /// The camera's calibration, in any format that `photinus info` knows [default: that of the dataset]
    #[arg(long, value_name = "FILE")]
    camera: Option<PathBuf>,
    /// Write the camera with its optics, described in docs/file-formats.md
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Write a page of plots and numbers, and each plot as PNG and SVG, into this folder, which is made
    #[arg(long, value_name = "DIR")]
    report: Option<PathBuf>,
    /// A mask: an image of the frames' size whose pixels are 0 where nothing is looked for [default: that of the dataset, if any]
    #[arg(long, value_name = "FILE")]
    mask: Option<PathBuf>,
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
pub(crate) fn run(args: &Args, terminal: &mut Terminal) -> Result<(), Failure> {
    let inputs = args.input.recordings()?;
    let inputs: Vec<Input> = inputs.iter().map(InputArgs::open).collect::<Result<_, _>>()?;
    let camera = frames::camera(&inputs, args.camera.as_deref(), terminal)?;
    let files = inputs.iter().flat_map(|input| input.files.iter().cloned());
    let read: Vec<PathBuf> = files.chain(args.camera.clone()).chain(args.mask.clone()).collect();
    let mut targets = Targets::new(args.write, read);
    let out = args.out.as_deref().map(|path| targets.file(path, Content::Toml)).transpose()?;
    let report = args.report.as_deref().map(|path| targets.folder(path)).transpose()?;
    let name = inputs.first().map_or(String::new(), |input| input.name.clone());
    let mut collection = Collection::of(&camera.camera);
    for input in inputs {
        let mask = frames::mask(&input, args.mask.as_deref(), terminal)?;
        frames::collect(input, &camera.camera, mask.as_ref(), &mut collection, terminal)?;
    }
    terminal.summary(format_args!(
        "{} spots stand alone in {} frames ...",
        collection.spots(),
        collection.frames()
    ));
    let learned = learn(&collection).map_err(|error| refuse(&name, &error))?;
    if let Some(out) = out {
        let mut text = Vec::new();
        let measured = camera.camera.clone().with_optics(learned.optics.clone());
        let summary = summary(&learned);
        write_calibrated_camera_toml(
            &measured,
            camera.calibration.as_ref(),
            Some(&summary),
            &mut text,
            out.path(),
        )
        .and_then(|()| out.write(&text))
        .map_err(Failure::running)?;
        terminal.summary(format_args!("{}: written", out.path().display()));
    }
    if let Some(report) = report {
        let folder = report.whole().map_err(Failure::input)?;
        let size_px = [camera.camera.width(), camera.camera.height()];
        page::write(folder.path(), &learned, size_px)
            .map_err(|error| Failure::running(folder.tell(error)))?;
        folder.keep().map_err(Failure::running)?;
        terminal.summary(format_args!("{}: written", report.path().join("index.html").display()));
    }
    match args.quiet {
        true => Ok(()),
        false => terminal.result(table::Told(&learned)),
    }
}

/// What the file says of the calibration.
fn summary(learned: &Learned) -> OpticsSummary {
    OpticsSummary {
        frames: learned.frames,
        spots: learned.spots as u64,
        saturation_sigma_dn: learned.saturation_sigma_dn,
        shape_error_sigma: Some(learned.shape_error_sigma),
        unseen: learned.unseen.iter().map(|unseen| unseen.name().to_owned()).collect(),
    }
}

fn refuse(name: &str, error: &LearnError) -> Failure {
    let advice = match error {
        LearnError::TooFew { .. } => {
            "record more frames, with LEDs 10 px and more apart, most of them no brighter than a pixel can tell"
        }
        _ => "check that the frames show LEDs, and are as the camera took them",
    };
    Failure::Input(format!("{name}: {error}; {advice}"))
}
