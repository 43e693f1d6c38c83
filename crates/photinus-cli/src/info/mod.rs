//! `photinus info`: what a file holds, told by its content, and whether it is in order.

mod airframe;
mod camera;
mod dataset;
mod frames;
mod optics;
mod own;
mod recording;
mod records;
mod tables;

use std::path::{Path, PathBuf};

use photinus_io::codes::read_codes;
use photinus_io::kind::Kind;
use photinus_io::{Error, Result};

pub(crate) use optics::{known_beside_summit, sources};

use crate::aligned::{Aligned, Side};
use crate::codes;
use crate::failure::Failure;
use crate::terminal::Terminal;

const EXAMPLES: &str = "\
Examples:
  # field of view, resolution, checks, oddities
  photinus info camera.txt
  # markers, and how many show from which side
  photinus info airframe.toml
  photinus info recording results.jsonl mask.png

Knows cameras (OCamCalib text, Photinus TOML, UVDAR YAML, Kalibr, ROS
CameraInfo, pyocamcalib), airframes, datasets, images, masks, Y4M videos, MCAP
recordings, bags of ROS 1, and every file that Photinus writes. Exits with 2 when a file is not in order.";

/// Tell what files hold and whether they are in order
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Args {
    /// Files or dataset folders
    #[arg(value_name = "FILE", required = true)]
    files: Vec<PathBuf>,
}

/// What is told about a file.
pub(crate) struct Report {
    /// What it is.
    what: String,
    facts: Aligned,
    /// Tables, below the facts.
    tables: Vec<Aligned>,
    /// What a user should know or do, a sentence each.
    pub(crate) notes: Vec<String>,
    /// Whether something is missing or damaged, which a note tells.
    is_broken: bool,
}

impl Report {
    pub(crate) fn new(what: impl Into<String>) -> Self {
        Self {
            what: what.into(),
            facts: Aligned::new(2, &[Side::Left]),
            tables: Vec::new(),
            notes: Vec::new(),
            is_broken: false,
        }
    }

    /// Something is missing or damaged.
    fn broken(&mut self, note: impl Into<String>) {
        self.notes.push(note.into());
        self.is_broken = true;
    }

    pub(crate) fn fact(&mut self, name: &str, value: impl Into<String>) {
        self.facts.row([name.to_owned(), value.into()]);
    }
}

/// Runs the command. A file that is not in order does not keep the others from being told.
pub(crate) fn run(args: &Args, terminal: &Terminal) -> std::result::Result<(), Failure> {
    let (mut failed, mut told) = (0, 0);
    for path in &args.files {
        match report(path) {
            Ok(report) => {
                if told > 0 {
                    terminal.result("")?;
                }
                print(path, &report, terminal)?;
                told += 1;
                failed += usize::from(report.is_broken);
            }
            Err(error) => {
                failed += 1;
                terminal.error(error);
            }
        }
    }
    if failed > 0 { Err(Failure::Frames { all: true }) } else { Ok(()) }
}

fn report(path: &Path) -> Result<Report> {
    match Kind::of(path)? {
        Kind::Airframe => airframe::report(path),
        Kind::Blink => read_codes(path).map(|book| codes::report(&book)),
        Kind::Camera(_) => camera::report(path),
        Kind::Dataset => dataset::dataset(path),
        Kind::DatasetTable => dataset::dataset(path.parent().unwrap_or(Path::new("."))),
        Kind::Image => frames::image(path),
        Kind::ImageFolder => frames::folder(path),
        Kind::Video => frames::video(path),
        Kind::Recording => recording::mcap(path),
        Kind::Bag => recording::of_ros1(path),
        Kind::Results => records::results(path),
        Kind::SpotCurve => records::spot_curve(path),
        Kind::Truth => records::truth(path),
        Kind::Scene => own::scene(path),
        Kind::Mounting => own::mounting(path),
        Kind::Vehicles => own::vehicles(path),
        Kind::PointSpread => own::part_of_a_scene(path, Kind::PointSpread, "[optics]"),
        Kind::Sensor => own::part_of_a_scene(path, Kind::Sensor, "[sensor]"),
        Kind::Scores => own::scores(path),
        Kind::CalibrationReport => own::calibration_report(path),
        Kind::SpotSizeReport => own::spot_size_report(path),
        Kind::Table(table) => tables::report(path, table),
        shown @ (Kind::Page | Kind::Drawing) => Ok(own::shown(path, shown)),
        other @ (Kind::Folder
        | Kind::Foreign(_)
        | Kind::Keys(_)
        | Kind::Text
        | Kind::Binary
        | Kind::Empty) => {
            let refused = Error::format(path, format!("this is {other}"));
            Err(refused.advise(other.remedy(path).unwrap_or_else(|| KNOWN.to_owned())))
        }
    }
}

const KNOWN: &str = "name a camera, an airframe, a mask, frames, or a file that Photinus wrote; docs/file-formats.md shows each";

/// Prints what is told about a file.
pub(crate) fn print(path: &Path, report: &Report, terminal: &Terminal) -> std::result::Result<(), Failure> {
    terminal.result(format_args!("{}: {}", path.display(), report.what))?;
    terminal.result(&report.facts)?;
    for table in &report.tables {
        terminal.result(format_args!("\n{table}"))?;
    }
    for note in &report.notes {
        terminal.result(format_args!("  ! {note}"))?;
    }
    Ok(())
}

/// A count with its word.
pub(crate) fn counted(count: usize, word: &str) -> String {
    if count == 1 { format!("1 {word}") } else { format!("{count} {word}s") }
}
