//! `photinus evaluate`: truth (of a dataset, of a file, or of two logs) and results -> tables, JSON, plots.
//!
//! What is counted and how stands in [`photinus_evaluate`]; here it is read, refused in words, and shown.

mod bins;
mod logs;
pub(crate) mod plots;
mod pose_log;
mod tables;
mod truth;

use std::path::{Path, PathBuf};

use photinus_evaluate::alignment::TargetClock;
use photinus_evaluate::{EvaluateError, RangeBins, Scores, Settings, Side, evaluate};
use photinus_io::results::{FrameRecord, read_results};
use photinus_io::{Cause, Error, Place};
use serde::Serialize;

use crate::ending::Content;
use crate::failure::Failure;
use crate::number;
use crate::targets::{FileTarget, Targets, WriteArgs};
use crate::terminal::Terminal;
use logs::AlignmentReport;
use plots::plot;
use pose_log::PoseLog;
use truth::GroundTruth;

const EXAMPLES: &str = "\
Examples:
  # first, locate, then see how well
  photinus locate flight --out results.jsonl
  photinus evaluate flight results.jsonl
  # what `photinus demo` leaves
  photinus evaluate photinus-demo/truth.jsonl photinus-demo/results.jsonl
  photinus evaluate flight results.jsonl --plots figures --json s.json
  photinus evaluate flight results.jsonl -q --json - | jq .distance.overall
  # truth from the poses that two vehicles logged
  photinus evaluate observer.csv results.jsonl --target target.csv
  # each on a clock of its own, at most 2 s apart
  photinus evaluate observer.csv results.jsonl --target target.csv \\
      --target-clock-offset 0
  # the same of what ROS recorded
  photinus evaluate flight.mcap:/observer/odom results.jsonl \\
      --target flight.mcap:/target/odom

Frames of truth that the results do not hold count as missed.";

/// After this many bad lines the others are only counted.
const REPORTED_LINES: usize = 5;

/// Compare results with ground truth: recall, errors, bounds, covariances
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Args {
    /// The folder of a dataset with truth.jsonl, or such a file alone; with --target, the log of the vehicle that carries the camera, in
    /// any form that --target takes
    #[arg(value_name = "TRUTH")]
    dataset: PathBuf,
    /// What `photinus locate --out` wrote for it
    #[arg(value_name = "RESULTS")]
    results: PathBuf,
    /// The log of the vehicle that is seen, in the world frame of the log given as TRUTH: a CSV of poses, an MCAP recording, or a bag of
    /// ROS 1; FILE:TOPIC names one of several topics with poses. Clock offsets and lever arms are estimated and told
    #[arg(long, value_name = "FILE")]
    target: Option<PathBuf>,
    /// With --target: about how much to add to the times of frames to get those of the log given as TRUTH; looked for within 2 s of it
    #[arg(long, value_name = "S", default_value_t = 0.0, allow_hyphen_values = true, requires = "target")]
    clock_offset: f64,
    /// The target's log has a clock of its own: about how much to add to the times of the log given as TRUTH to get those of the
    /// target's; looked for within 2 s of it. Without this option both logs share a clock
    #[arg(long, value_name = "S", allow_hyphen_values = true, requires = "target")]
    target_clock_offset: Option<f64>,
    /// Write every number as JSON, described in docs/file-formats.md; - is standard output, in place of the tables
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Write a page with the tables and plots, each also as PNG and SVG, into this folder, which is made
    #[arg(long, value_name = "DIR")]
    plots: Option<PathBuf>,
    /// Edges between bins of true distance [default: 1,2,3,4,6,8,10,12,15,20,30,50]
    #[arg(long, value_name = "M,M,...", value_parser = bins::parse)]
    bins: Option<RangeBins>,
    /// How far a spot may be from its LED, or its own radius where that is more
    #[arg(long, value_name = "PX", default_value_t = 3.0, value_parser = number::positive)]
    spot_gate: f64,
    /// How far a neighbour's bearing may be from truth; near neighbours may be 0.6 m aside
    #[arg(long, value_name = "DEG", default_value_t = 3.0, value_parser = number::positive)]
    bearing_gate: f64,
    /// A track farther than this from where truth has a vehicle is another one, to GOSPA
    #[arg(long, value_name = "M", default_value_t = 2.0, value_parser = number::positive)]
    gospa_cutoff: f64,
    /// Which camera, of a dataset with several
    #[arg(long, value_name = "NAME")]
    only: Option<String>,
    #[command(flatten)]
    write: WriteArgs,
    /// Print no tables and no warnings
    #[arg(short, long)]
    quiet: bool,
}

/// What `--json` writes.
#[derive(Serialize)]
struct Report<'a> {
    dataset: &'a Path,
    results: &'a Path,
    settings: &'a Settings,
    #[serde(skip_serializing_if = "Option::is_none")]
    alignment: Option<AlignmentReport>,
    #[serde(flatten)]
    scores: &'a Scores,
}

impl Args {
    /// Whether only errors and results are to be printed.
    pub(crate) fn quiet(&self) -> bool {
        self.quiet
    }

    fn settings(&self, truth: &GroundTruth) -> Settings {
        let mut settings = Settings::default();
        settings.spot_gate_px = self.spot_gate;
        settings.bearing_gate_rad = self.bearing_gate.to_radians();
        settings.time_tolerance_s = truth.time_tolerance_s;
        settings.gospa_cutoff_m = self.gospa_cutoff;
        settings.bins = self.bins.clone().unwrap_or_default();
        settings
    }

    fn refuse(&self, error: &EvaluateError, truth: &GroundTruth) -> Failure {
        let (file, advice) = match error.side() {
            Side::Truth => (truth.path.clone(), "mend the truth, or make it again"),
            Side::Results if matches!(error, EvaluateError::RepeatedFrame(..)) => {
                (self.results.clone(), "give the results of one run")
            }
            Side::Results => (self.results.clone(), "give the results of this dataset"),
        };
        let refused = Error::format(file, error.to_string()).advise(advice);
        Failure::input(match error.frame() {
            Some(frame) => refused.at(Place::Frame(frame)),
            None => refused,
        })
    }
}

/// Runs the command.
pub(crate) fn run(args: &Args, terminal: &Terminal) -> Result<(), Failure> {
    let source = Source::of(args)?;
    let read = source.files().into_iter().chain([args.results.clone()]);
    let mut targets = Targets::new(args.write, read);
    let json = args.json.as_deref().map(|path| targets.file(path, Content::Json)).transpose()?;
    let plots = args.plots.as_deref().map(|path| targets.folder(path)).transpose()?;
    let (mut results, bad_lines) = read_records(args, terminal)?;
    let truth = source.truth(args, &results)?;
    results.retain(|record| record.camera == truth.camera);
    let settings = args.settings(&truth);
    let evaluation =
        evaluate(&truth.frames, &results, &settings).map_err(|error| args.refuse(&error, &truth))?;

    let is_for_people = !args.quiet && !json.as_ref().is_some_and(FileTarget::is_standard);
    if let Some(json) = json {
        let (dataset, results, scores) = (&args.dataset, &args.results, &evaluation.scores);
        let alignment = truth.alignment.as_ref().map(AlignmentReport::of);
        write_json(&json, &Report { dataset, results, settings: &settings, alignment, scores }, terminal)?;
    }
    if let Some(plots) = plots {
        let folder = plots.whole().map_err(Failure::running)?;
        let tables = told(&truth, &evaluation.scores);
        let drawn = plot(folder.path(), &evaluation, &truth.frames).and_then(|figures| {
            plots::page::write(folder.path(), &args.results, tables.trim_end(), &figures)
        });
        drawn.map_err(|error| folder.tell(error)).and_then(|()| folder.keep()).map_err(Failure::running)?;
    }
    warn(&evaluation.scores, args, terminal);
    if is_for_people {
        terminal.result(told(&truth, &evaluation.scores).trim_end())?;
    }
    if bad_lines > 0 { Err(Failure::Frames { all: results.is_empty() }) } else { Ok(()) }
}

/// Where truth comes from.
enum Source {
    /// It is there.
    Known(Box<GroundTruth>),
    /// The observer's log, that of the target, and the results make it.
    Logs { observer: PoseLog, target: PoseLog },
}

impl Source {
    fn of(args: &Args) -> Result<Self, Failure> {
        match &args.target {
            Some(target) => {
                let [observer, target] = [&args.dataset, target].map(|name| PoseLog::named(name));
                Ok(Self::Logs { observer, target })
            }
            None => {
                GroundTruth::read(&args.dataset, args.only.as_ref()).map(|truth| Self::Known(truth.into()))
            }
        }
    }

    /// The files that are read for it.
    fn files(&self) -> Vec<PathBuf> {
        match self {
            Self::Known(truth) => truth.files.clone(),
            Self::Logs { observer, target } => vec![observer.file.clone(), target.file.clone()],
        }
    }

    fn truth(self, args: &Args, results: &[FrameRecord]) -> Result<GroundTruth, Failure> {
        match self {
            Self::Known(truth) => check_frames(args, &truth, results).map(|()| *truth),
            Self::Logs { observer, target } => {
                let target_clock = match args.target_clock_offset {
                    Some(near_s) => TargetClock::Own { near_s },
                    None => TargetClock::Shared,
                };
                logs::truth(&observer, &target, results, args.clock_offset, target_clock)
            }
        }
    }
}

/// All tables, and before them what was estimated to have a truth.
fn told(truth: &GroundTruth, scores: &Scores) -> String {
    let alignment = truth.alignment.as_ref().map_or_else(String::new, logs::table);
    format!("{alignment}{}", tables::Tables(scores))
}

/// The records that can be read, and how many lines cannot: their frames count as missed.
fn read_records(args: &Args, terminal: &Terminal) -> Result<(Vec<FrameRecord>, usize), Failure> {
    let (mut records, mut bad_lines) = (Vec::new(), 0);
    for record in read_results(&args.results).map_err(Failure::input)? {
        match record {
            Ok(record) => records.push(record),
            Err(error) if matches!(error.cause, Cause::Cut) => terminal
                .warning(format_args!("{error}; the {} whole lines before it are used", records.len())),
            Err(error) => {
                bad_lines += 1;
                if bad_lines <= REPORTED_LINES {
                    terminal.error(error);
                }
            }
        }
    }
    if bad_lines > REPORTED_LINES {
        terminal.error(format_args!("{} more lines are no results", bad_lines - REPORTED_LINES));
    }
    if records.is_empty() {
        let refused = Error::format(&args.results, "it holds no result");
        return Err(Failure::input(
            refused.advise("give what `photinus locate --out` wrote for this dataset"),
        ));
    }
    Ok((records, bad_lines))
}

/// Refuses results of frames that the truth does not have.
fn check_frames(args: &Args, truth: &GroundTruth, records: &[FrameRecord]) -> Result<(), Failure> {
    let (listed, frames) = &truth.listed;
    let of_camera = records.iter().filter(|record| record.camera == truth.camera);
    match of_camera.filter_map(|record| record.frame).find(|frame| !frames.contains(frame)) {
        None => Ok(()),
        Some(frame) => {
            let reason = format!("{} lists no such frame", listed.display());
            let refused = Error::format(&args.results, reason).at(Place::Frame(frame));
            Err(Failure::input(refused.advise("give the results of this dataset")))
        }
    }
}

fn write_json(target: &FileTarget, report: &Report<'_>, terminal: &Terminal) -> Result<(), Failure> {
    let text = serde_json::to_string_pretty(report)
        .map_err(|error| Failure::Running(format!("the scores as JSON: {error}")))?;
    match target.is_standard() {
        true => terminal.result(text),
        false => target.write(format!("{text}\n").as_bytes()).map_err(Failure::running),
    }
}

/// What is likely not meant.
fn warn(scores: &Scores, args: &Args, terminal: &Terminal) {
    let frames = scores.frames;
    if frames.missing > 0 {
        terminal.warning(format_args!(
            "{}: {} of {} frames are not in it and count as missed",
            args.results.display(),
            frames.missing,
            frames.truth
        ));
    }
    let neighbours = scores.neighbours.by_range.overall;
    if neighbours.found == 0 && neighbours.visible > 0 && neighbours.false_neighbours > 0 {
        terminal.warning(format_args!(
            "{}: no neighbour is where truth has one; check that these are the results of {}",
            args.results.display(),
            args.dataset.display()
        ));
    }
}
