//! `photinus convert`: the same in another format, and what is lost on the way.

mod dataset;
mod frames;
mod text;

use std::path::{Path, PathBuf};

use clap::ValueEnum;
use photinus_io::kind::Kind;

use crate::ending::Content;
use crate::failure::Failure;
use crate::input::InputArgs;
use crate::targets::{FileTarget, Targets, WriteArgs};
use crate::terminal::Terminal;

const EXAMPLES: &str = "\
Examples:
  # OCamCalib text to Photinus TOML
  photinus convert calib_results.txt camera.toml
  # any camera format that Photinus reads
  photinus convert kalibr.yaml camera.toml
  # with an inverse polynomial that fits
  photinus convert camera.toml calib_results.txt
  # for Kalibr, for ROS, for UVDAR on ROS 2
  photinus convert camera.toml camchain.yaml --to kalibr
  photinus convert camera.toml camera_info.yaml --to ros
  photinus convert camera.toml uvdar.yaml --to uvdar
  # an LED layout to an airframe, and back
  photinus convert quad.txt quad.toml
  # a row per neighbour
  photinus convert results.jsonl results.csv
  photinus convert video.y4m recording --camera camera.txt \\
      --airframe quad.toml --exposure-us 1000
  # with gravity as an autopilot logged it: time_s,gx,gy,gz
  photinus convert video.y4m recording --camera camera.txt \\
      --airframe quad.toml --exposure-us 1000 --gravity gravity.csv
  photinus convert *.png video.y4m --rate 60
  photinus convert recording copy --camera recalibrated.txt
  # a bag of ROS 2, and frames out of one
  photinus convert recording flight.mcap
  photinus convert flight.mcap video.y4m

What the new format cannot hold is told.";

/// Write a file in another format
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Args {
    /// What to convert: a camera, an airframe, results, or frames (a dataset, a video, a recording, images)
    #[arg(value_name = "IN", required = true)]
    inputs: Vec<PathBuf>,
    /// Where to write; its extension tells the format, none means a dataset folder
    #[arg(value_name = "OUT", required = true)]
    out: PathBuf,
    /// The format, where the extension does not tell it
    #[arg(long, value_name = "FORMAT")]
    to: Option<Format>,
    #[command(flatten)]
    frames: frames::FrameArgs,
    #[command(flatten)]
    write: WriteArgs,
}

/// The formats that are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Format {
    /// A camera as OCamCalib text
    Ocam,
    /// A camera as a camchain of Kalibr
    Kalibr,
    /// A camera as CameraInfo of ROS
    Ros,
    /// A camera as UVDAR on ROS 2 has it
    Uvdar,
    /// A camera or an airframe as Photinus TOML
    Toml,
    /// An airframe as LED layout text
    Layout,
    /// Results as a table
    Csv,
    /// Frames as a video
    Y4m,
    /// Frames as an MCAP recording, a bag of ROS 2
    Mcap,
    /// Frames as a dataset folder
    Dataset,
}

/// Runs the command.
pub(crate) fn run(args: &Args, terminal: &mut Terminal) -> Result<(), Failure> {
    let [first, others @ ..] = args.inputs.as_slice() else {
        return Err(Failure::Input("nothing to convert: name an input and an output".to_owned()));
    };
    let is_stream = first.as_os_str() == "-";
    let kind = if is_stream { Kind::Video } else { Kind::of(first).map_err(Failure::input)? };
    let format = format(args, kind)?;
    if args.out.as_os_str() == "-" {
        return Err(Failure::Input("standard output: convert writes files; name one".to_owned()));
    }
    let is_frames = matches!(format, Format::Y4m | Format::Mcap | Format::Dataset);
    if let (false, [other, ..]) = (is_frames, others) {
        return Err(Failure::Input(format!(
            "{}: only frames are converted several at a time",
            other.display()
        )));
    }
    let targets = |read: &[PathBuf]| Targets::new(args.write, read.iter().cloned());
    if is_frames && kind.holds_frames() {
        let input = InputArgs::of(&args.inputs, &args.frames.dataset).open()?;
        let read: Vec<PathBuf> = input.files.iter().cloned().chain(args.frames.files()).collect();
        return frames::convert(input, &args.out, format, &args.frames, targets(&read), terminal);
    }
    type Convert = fn(&Path, &FileTarget, &Terminal) -> Result<(), Failure>;
    let (convert, content): (Convert, Content) = match (kind, format) {
        (Kind::Camera(_), Format::Ocam) => (text::camera_to_ocam, Content::OcamText),
        (Kind::Camera(_), Format::Kalibr) => (text::camera_to_kalibr, Content::Yaml),
        (Kind::Camera(_), Format::Ros) => (text::camera_to_ros, Content::Yaml),
        (Kind::Camera(_), Format::Uvdar) => (text::camera_to_uvdar, Content::Yaml),
        (Kind::Camera(_), Format::Toml) => (text::camera_to_toml, Content::Toml),
        (Kind::Airframe, Format::Layout) => (text::airframe_to_layout, Content::Layout),
        (Kind::Airframe, Format::Toml) => (text::airframe_to_toml, Content::Toml),
        (Kind::Results, Format::Csv) => (text::results_to_csv, Content::Csv),
        _ => {
            return Err(Failure::Input(format!(
                "{}: this is {}, which cannot become {}; {}",
                first.display(),
                kind,
                name(format),
                choices(kind, first)
            )));
        }
    };
    convert(first, &targets(&args.inputs).file(&args.out, content)?, terminal)
}

/// What was asked for, or what the extension tells.
fn format(args: &Args, kind: Kind) -> Result<Format, Failure> {
    if let Some(format) = args.to {
        return Ok(format);
    }
    let extension = args.out.extension().and_then(|extension| extension.to_str()).map(str::to_lowercase);
    match extension.as_deref() {
        Some("txt") if kind == Kind::Airframe => Ok(Format::Layout),
        Some("txt") => Ok(Format::Ocam),
        Some("toml") => Ok(Format::Toml),
        Some("csv") => Ok(Format::Csv),
        Some("y4m") => Ok(Format::Y4m),
        Some("mcap") => Ok(Format::Mcap),
        Some("yaml" | "yml") => Err(Failure::Input(format!(
            "{}: cameras of several programs end in .yaml; choose --to kalibr, --to ros or --to uvdar",
            args.out.display()
        ))),
        None => Ok(Format::Dataset),
        Some(other) => Err(Failure::Input(format!(
            "{}: `.{other}` tells no format that is written; end it in .txt, .toml, .yaml, .csv, .y4m or .mcap, or give --to",
            args.out.display()
        ))),
    }
}

fn name(format: Format) -> &'static str {
    match format {
        Format::Ocam => "OCamCalib text",
        Format::Kalibr => "a camchain of Kalibr",
        Format::Ros => "a CameraInfo of ROS",
        Format::Uvdar => "a camera of UVDAR",
        Format::Toml => "Photinus TOML",
        Format::Layout => "an LED layout",
        Format::Csv => "CSV",
        Format::Y4m => "a Y4M video",
        Format::Mcap => "an MCAP recording",
        Format::Dataset => "a dataset folder",
    }
}

/// What to do with a file of this kind instead.
fn choices(kind: Kind, path: &Path) -> String {
    match kind {
        Kind::Airframe => "choose --to toml or --to layout".to_owned(),
        Kind::Camera(_) => "choose --to toml, ocam, kalibr, ros or uvdar".to_owned(),
        Kind::Results => "choose --to csv".to_owned(),
        Kind::DatasetTable => "name its folder instead".to_owned(),
        _ if kind.holds_frames() => "choose --to y4m, mcap or dataset".to_owned(),
        _ => kind.remedy(path).unwrap_or_else(|| "name a camera, an airframe, results, or frames".to_owned()),
    }
}
