//! `photinus run`: cameras -> neighbours, published for as long as it is asked, as a configuration says.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use photinus_io::Error;
use photinus_run::config::{Config, EXAMPLE};
use photinus_run::health::{CameraHealth, Level, Notice, SinkHealth};
use photinus_run::live::{self, Camera, Report};
use photinus_run::motion::Motion;
use photinus_run::sink::Sink;

use crate::aligned::{Aligned, Side};
use crate::failure::Failure;
use crate::terminal::Terminal;
use crate::{interrupt, protocols};

const EXAMPLES: &str = "\
Examples:
  # a configuration to begin with, with every key explained
  photinus run --example > photinus.toml
  # whether every camera opens and every port is free
  photinus run --check photinus.toml
  photinus run photinus.toml

Ctrl-C or SIGTERM ends it: what waits is written, and it is told what was done.

Exit codes: 0 ended as asked, 1 a sink failed while running, 2 bad usage or
configuration, or a part that --check found wanting.";

/// Locate neighbours with the cameras of a robot, and publish them while it flies
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Args {
    /// What there is and what is wanted, as --example writes it
    #[arg(value_name = "CONFIG.toml", required_unless_present = "example")]
    config: Option<PathBuf>,
    /// Print a configuration with every key explained
    #[arg(long, conflicts_with_all = ["config", "check"])]
    example: bool,
    /// Try every part, and end: cameras open and give frames of their calibration's size, files can be written, ports are free
    #[arg(long)]
    check: bool,
    /// Print no notes, no warnings, no summary
    #[arg(short, long)]
    quiet: bool,
}

impl Args {
    /// Whether only errors and results are to be printed.
    pub(crate) fn quiet(&self) -> bool {
        self.quiet
    }
}

/// Runs the command.
pub(crate) fn run(args: &Args, terminal: &mut Terminal) -> Result<(), Failure> {
    let path = match &args.config {
        Some(path) if !args.example => path,
        _ => return terminal.result(EXAMPLE.trim_end()),
    };
    let config = Config::read(path).map_err(Failure::input)?;
    match args.check {
        true => check(&config, terminal),
        false => fly(&config, terminal),
    }
}

fn fly(config: &Config, terminal: &mut Terminal) -> Result<(), Failure> {
    let motion = Motion::default();
    let cameras = config
        .cameras(&motion, &|origin, spots| protocols::source(config, origin, spots), &mut |text| {
            terminal.note(text);
        })
        .map_err(Failure::input)?;
    let (sinks, page) = sinks(config, &motion, &cameras)?;
    if let Some(page) = page {
        terminal.note(format_args!("the page is at {page}"));
    }
    let is_over = Arc::new(interrupt::is_asked);
    let report = live::run(cameras, sinks, config.pace(), is_over, &mut |notice| tell(notice, terminal));
    interrupt::look_away();
    let report = report.map_err(Failure::running)?;
    for sink in &report.stuck {
        terminal.error(format_args!("{sink} did not end in time; what waited for it is lost"));
    }
    terminal.summary(summary(&report));
    match report.stuck.is_empty() && report.health.sinks.iter().all(is_whole) {
        true => Ok(()),
        false => Err(Failure::Output),
    }
}

/// Sinks end by themselves only at the end, when all was taken.
fn is_whole(sink: &SinkHealth) -> bool {
    sink.finished
}

fn check(config: &Config, terminal: &mut Terminal) -> Result<(), Failure> {
    let motion = Motion::default();
    let cameras = config
        .cameras(&motion, &|origin, spots| protocols::source(config, origin, spots), &mut |text| {
            terminal.note(text);
        })
        .map_err(Failure::input)?;
    // What was not there before is not left behind.
    let new: Vec<PathBuf> = config.files().into_iter().filter(|path| !path.exists()).collect();
    let (sinks, page) = sinks(config, &motion, &cameras)?;
    let mut wanting = 0;
    for camera in cameras {
        let name = camera.name.clone();
        match camera.check() {
            Ok(told) => terminal.result(format_args!("camera {name}: {told}"))?,
            Err(error) => {
                wanting += 1;
                terminal.error(format_args!("camera {name}: {error}"));
            }
        }
    }
    for sink in &sinks {
        terminal.result(format_args!("{}: ready", sink.name()))?;
    }
    drop(sinks);
    if let Some(page) = page {
        terminal.result(format_args!("the page would be at {page}"))?;
    }
    new.iter().for_each(|path| drop(std::fs::remove_file(path)));
    match wanting {
        0 => Ok(()),
        _ => Err(Failure::input(
            Error::format(config.path(), format!("cameras that would not run: {wanting}"))
                .advise("they are told above"),
        )),
    }
}

type Sinks = Vec<Box<dyn Sink>>;

/// All sinks, and where the page is.
fn sinks(config: &Config, motion: &Motion, cameras: &[Camera]) -> Result<(Sinks, Option<String>), Failure> {
    let mut sinks = config.sinks().map_err(Failure::input)?;
    for table in config.protocols() {
        sinks.extend(protocols::sinks(config, table, motion, cameras)?);
    }
    let (page, address) = protocols::page(config)?.unzip();
    sinks.extend(page);
    if sinks.is_empty() {
        let nobody = Error::format(config.path() as &Path, "nobody is told what is found");
        return Err(Failure::input(nobody.advise("add [json], [page] or another sink")));
    }
    Ok((sinks, address))
}

fn tell(notice: &Notice, terminal: &Terminal) {
    match notice.level {
        Level::Note => terminal.note(&notice.text),
        Level::Warning => terminal.warning(&notice.text),
        Level::Error => terminal.error(&notice.text),
    }
}

/// What was done, a line per camera and sink.
fn summary(report: &Report) -> String {
    let right = |columns: usize| [vec![Side::Left], vec![Side::Right; columns]].concat();
    let mut cameras = Aligned::new(0, &right(7));
    cameras.row(["camera", "frames", "failed", "dropped", "lost", "ms p50", "p99", "p99.9"]);
    for (camera, latencies_ms) in report.health.cameras.iter().zip(&report.latencies_ms) {
        let CameraHealth { name, frames, failed, dropped, lost, .. } = camera;
        let counts = [frames, failed, dropped, lost].map(ToString::to_string);
        let ms = [0.5, 0.99, 0.999]
            .map(|share| latencies_ms.at(share).map_or("-".to_owned(), |ms| format!("{ms:.2}")));
        cameras.row([name.clone()].into_iter().chain(counts).chain(ms));
    }
    let mut sinks = Aligned::new(0, &right(2));
    sinks.row(["sink", "taken", "dropped"]);
    for sink in &report.health.sinks {
        sinks.row([sink.name.clone(), sink.written.to_string(), sink.dropped.to_string()]);
    }
    let idle_ms = [0.5, 0.99, 0.999]
        .map(|share| report.wake_up_ms.at(share).map_or("-".to_owned(), |ms| format!("{ms:.2}")));
    cameras.row([vec!["(idle thread)".to_owned()], vec![String::new(); 4], idle_ms.to_vec()].concat());
    format!("{cameras}\n{sinks}")
}
