//! `photinus reproduce`: every figure of the founding paper, in simulation. Names of figures enter; a folder of figures, their
//! data and a summary leaves.
//!
//! ```text
//! drawing    panels of an experiment -> PNG and SVG
//! tables     series and rows -> CSV, and a table to read
//! animation  figure 17: the flight as it was seen, frame by frame
//! index      all of it on a page
//! ```

mod animation;
mod drawing;
mod index;
mod tables;

use std::collections::BTreeSet;
use std::path::PathBuf;
use std::sync::Mutex;
use std::time::Instant;

use photinus_io::Error;
use photinus_reproduce::{Effort, Experiment, Figure, Report, ReproduceError, Rig};

use crate::demo::carried::OUTDOOR_FLIGHT;
use crate::failure::Failure;
use crate::targets::{Targets, WriteArgs};
use crate::terminal::Terminal;
use photinus_run::fault;

const EXAMPLES: &str = "\
Examples:
  # every figure, into photinus-reproduce/
  photinus reproduce
  # the sizes of spots over distance
  photinus reproduce 10 11 --out spots
  # what the paper says in words
  photinus reproduce range heading --out more
  # a fraction of the frames: numbers scatter more
  photinus reproduce --quick --out glance

Figures: 4 sunlight and the UV band; 7, 8 layouts and lobes; 10, 11 spot sizes;
12 bearings; 13, 14 distances; 15, 16, 17 the outdoor flight; range; heading.
DIR/index.html shows all of them, DIR/summary.csv holds each number beside the
paper's. A number out of its tolerance is shown with its reason; it is a
finding, not a failure of the program.";

/// Run the experiments of the founding paper in simulation, each number beside the paper's
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Args {
    /// Which figures: numbers of the paper, range, heading [default: all]
    #[arg(value_name = "FIGURE", value_parser = figure)]
    figures: Vec<Figure>,
    /// Where to write: a new folder
    #[arg(long, value_name = "DIR", default_value = "photinus-reproduce")]
    out: PathBuf,
    /// Simulate a fraction of the frames, to see that it works
    #[arg(long)]
    quick: bool,
    #[command(flatten)]
    write: WriteArgs,
    /// Print no table and no progress
    #[arg(short, long)]
    quiet: bool,
}

impl Args {
    /// Whether only errors are to be printed.
    pub(crate) fn quiet(&self) -> bool {
        self.quiet
    }

    fn effort(&self) -> Effort {
        if self.quick { Effort::Quick } else { Effort::Full }
    }

    fn wants(&self, figure: Figure) -> bool {
        self.figures.is_empty() || self.figures.contains(&figure)
    }
}

fn figure(name: &str) -> Result<Figure, String> {
    Figure::named(name).ok_or_else(|| {
        let names = Figure::ALL.map(Figure::name).join(", ");
        format!("there is no such figure to reproduce; choose among {names}")
    })
}

/// Runs the command.
pub(crate) fn run(args: &Args, terminal: &mut Terminal) -> Result<(), Failure> {
    let started = Instant::now();
    let target = Targets::new(args.write, []).folder(&args.out)?;
    let making = target.whole().map_err(Failure::input)?;
    let folder = making.path();
    let broken = |error| Failure::running(making.tell(error));
    let scene =
        OUTDOOR_FLIGHT.unpack(&folder.join("scene")).map_err(|error| Failure::input(making.tell(error)))?;
    let rig = Rig::new(scene).map_err(|error| Failure::Running(error.to_string()))?;
    let wanted: BTreeSet<Experiment> =
        Figure::ALL.into_iter().filter(|figure| args.wants(*figure)).map(Figure::experiment).collect();
    let pictures =
        if args.wants(Figure::Overlay) { animation::numbers(rig.scene(), args.effort()) } else { Vec::new() };
    let frames: u64 = wanted.iter().map(|experiment| experiment.frames(&rig, args.effort())).sum();
    terminal.start(Some(frames + pictures.len() as u64));
    let mut reports = run_all(&wanted, &rig, args.effort(), terminal)?;
    reports.retain(|report| args.wants(report.figure));
    reports.sort_by_key(|report| report.figure);
    for report in &reports {
        drawing::save(folder, report).map_err(broken)?;
        tables::save_data(folder, report).map_err(broken)?;
    }
    let player = match pictures.as_slice() {
        [] => None,
        pictures => Some(animation::save(&making, rig.scene(), pictures, terminal)?),
    };
    index::write(folder, &reports, player.as_ref()).map_err(broken)?;
    tables::save_summary(folder, &reports).map_err(broken)?;
    making.keep().map_err(Failure::running)?;
    terminal.finish();
    if !args.quiet {
        terminal.result(tables::to_read(&reports).trim_end())?;
    }
    let seconds = started.elapsed().as_secs_f64();
    terminal.summary(format_args!(
        "{frames} frames in {seconds:.0} s; open {}/index.html in a browser; figures and data are beside it",
        args.out.display()
    ));
    Ok(())
}

/// Runs the experiments, the longest first, each on one thread.
fn run_all(
    wanted: &BTreeSet<Experiment>,
    rig: &Rig,
    effort: Effort,
    terminal: &Terminal,
) -> Result<Vec<Report>, Failure> {
    let queue = Mutex::new(Experiment::ALL.into_iter().filter(|experiment| wanted.contains(experiment)));
    let next = || queue.lock().ok().and_then(|mut queue| queue.next());
    let work = || -> Result<Vec<Report>, ReproduceError> {
        let mut reports = Vec::new();
        while let Some(experiment) = next() {
            reports.extend(experiment.run(rig, effort, &|| terminal.frame_done())?);
        }
        Ok(reports)
    };
    let threads = std::thread::available_parallelism().map_or(1, usize::from).min(wanted.len().max(1));
    let done: Vec<_> = std::thread::scope(|scope| {
        let workers: Vec<_> = (0..threads).map(|_| scope.spawn(work)).collect();
        workers.into_iter().map(std::thread::ScopedJoinHandle::join).collect()
    });
    let mut reports = Vec::new();
    for worker in done {
        let worker = worker.map_err(|payload| {
            Failure::Running(format!("{}; {}", fault::told(payload.as_ref()), fault::ADVICE))
        })?;
        reports.extend(worker.map_err(|error| Failure::Running(error.to_string()))?);
    }
    Ok(reports)
}

/// What cannot be written, in words.
fn refuse(path: &std::path::Path, error: std::io::Error) -> Error {
    Error::io(path, error).advise("name a folder that can be written to, with --out")
}
