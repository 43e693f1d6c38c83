//! `photinus swarm`: a scenario -> robots that fly by what they see, and how well that went.
//!
//! ```text
//! scenario   a file, or one that the program carries, by name
//! flight     one seed: truth, every vehicle's results, metrics, a page      folder, page
//! seeds      many seeds at once: metrics of each, and over all of them      seeds
//! told       what is printed
//! ```

mod folder;
mod page;
mod seeds;
mod told;

use std::path::PathBuf;
use std::time::Instant;

use photinus_io::Error;
use photinus_swarm::scenario::{CARRIED, carried};
use photinus_swarm::{Grade, Run, Scenario};

use crate::failure::Failure;
use crate::interrupt;
use crate::number;
use crate::simulate::{processors, threads};
use crate::targets::{Targets, WriteArgs};
use crate::terminal::Terminal;
use folder::Folder;

const EXAMPLES: &str = "\
Examples:
  # which scenarios the program carries
  photinus swarm --list
  # fly one and look at it: DIR/index.html
  photinus swarm three --out three
  # by frames, every camera rendered and located in
  photinus swarm three --perception rendered --out three
  # the text of a carried one, to change it
  photinus swarm three --print
  photinus swarm my-swarm.toml --seeds 100 --out many

A run depends on scenario, seed and perception alone, not on the threads. The
folder holds truth.jsonl, a file per vehicle with what it saw and decided,
metrics.json and index.html. docs/swarm.md has every key and every number.";

/// Fly a swarm that sees: scenario in, flights with metrics and a page out
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Args {
    /// A scenario file, or the name of one that the program carries
    #[arg(value_name = "SCENARIO", required_unless_present = "list")]
    scenario: Option<PathBuf>,
    /// List the scenarios that the program carries
    #[arg(long, conflicts_with_all = ["scenario", "out", "seeds", "print"])]
    list: bool,
    /// Print the text of a carried scenario, to change it
    #[arg(long, conflicts_with_all = ["out", "seeds"])]
    print: bool,
    /// Where to write: a new folder
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// How vehicles see, in place of what the scenario says
    #[arg(long, value_name = "GRADE")]
    perception: Option<Perception>,
    /// Where random numbers start, in place of the scenario's seed
    #[arg(long, value_name = "SEED")]
    seed: Option<u64>,
    /// Fly under this many seeds, one after the other from the first
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = number::count)]
    seeds: u64,
    /// Seconds of the flight, in place of the scenario's duration
    #[arg(long, value_name = "S", value_parser = seconds)]
    duration: Option<f64>,
    /// Threads; results do not depend on their number
    #[arg(long, value_name = "N", default_value_t = processors(), value_parser = threads)]
    threads: usize,
    #[command(flatten)]
    write: WriteArgs,
    /// Print results and errors only
    #[arg(short, long)]
    quiet: bool,
}

#[derive(Clone, Copy, Debug, clap::ValueEnum)]
#[value(rename_all = "snake_case")]
enum Perception {
    /// Frames are rendered and located in
    Rendered,
    /// Errors are drawn from a table fitted to rendered frames
    StandIn,
    /// What is in view is known exactly
    Perfect,
    /// The noise of UVDAR's own simulator, ten times a second
    Uvdar,
}

impl Args {
    /// Whether only errors are to be printed.
    pub(crate) fn quiet(&self) -> bool {
        self.quiet
    }
}

fn seconds(text: &str) -> Result<f64, String> {
    number::within(text, 0.01..=3600.0, "seconds")
}

/// Runs the command.
pub(crate) fn run(args: &Args, terminal: &mut Terminal) -> Result<(), Failure> {
    let Some(named) = &args.scenario else { return list(terminal) };
    let name = named.to_str().unwrap_or_default();
    let own = carried(name).filter(|_| !named.is_file());
    if args.print {
        let text = own.map(|own| own.text).ok_or_else(|| unknown(name))?;
        return terminal.result(text.trim_end());
    }
    let (scenario, path) = match own {
        Some(own) => (own.read(), PathBuf::from(format!("{name}.toml"))),
        None if !named.exists() && named.extension().is_none() => return Err(unknown(name)),
        None => (Scenario::read(named), named.clone()),
    };
    let mut scenario = scenario.map_err(Failure::input)?;
    scenario.seed = args.seed.unwrap_or(scenario.seed);
    scenario.duration_s = args.duration.unwrap_or(scenario.duration_s);
    let grade = args.perception.map_or(scenario.grade, |perception| match perception {
        Perception::Rendered => Grade::Rendered,
        Perception::StandIn => Grade::StandIn,
        Perception::Perfect => Grade::Perfect,
        Perception::Uvdar => Grade::Uvdar,
    });
    let read = if own.is_some() { Vec::new() } else { vec![path.clone()] };
    let run = Run::new(scenario, path, grade);
    let mut targets = Targets::new(args.write, read);
    let target = args.out.as_deref().map(|out| targets.folder(out)).transpose()?;
    match args.seeds {
        1 => fly(&run, args, target.as_ref(), terminal),
        many => seeds::fly(&run, (many as usize, args.threads), target.as_ref(), terminal),
    }
}

/// One flight.
fn fly(
    run: &Run,
    args: &Args,
    target: Option<&crate::targets::FolderTarget>,
    terminal: &mut Terminal,
) -> Result<(), Failure> {
    let started = Instant::now();
    let mut folder = target.map(|target| Folder::create(target, &run.scenario)).transpose()?;
    terminal.start(Some(run.scenario.frames()));
    let flown = run.fly(args.threads, |world| {
        if interrupt::is_asked() {
            return Err(Error::format(&run.path, "interrupted"));
        }
        if let Some(folder) = &mut folder {
            folder.take(world)?;
        }
        terminal.frame_done();
        Ok(())
    });
    terminal.finish();
    if interrupt::is_asked() {
        return Err(Failure::Interrupted("interrupted; nothing was kept".to_owned()));
    }
    interrupt::look_away();
    let metrics = flown.map_err(Failure::running)?;
    let took_s = started.elapsed().as_secs_f64();
    if let Some(folder) = folder {
        folder.keep(&run.scenario, &metrics)?;
    }
    terminal.result(told::metrics(&metrics))?;
    terminal.summary(format_args!("{:.1} s of flight in {took_s:.1} s", metrics.duration_s));
    if let Some(out) = &args.out {
        terminal.summary(format_args!("Open {}/index.html in a browser.", out.display()));
    }
    Ok(())
}

/// The scenarios that the program carries.
fn list(terminal: &Terminal) -> Result<(), Failure> {
    let widest = CARRIED.iter().map(|carried| carried.name.len()).max().unwrap_or(0);
    for carried in CARRIED {
        let scenario = carried.read().map_err(Failure::running)?;
        terminal.result(format_args!(
            "{:widest$}  {:3} vehicles  {:3.0} s  {}",
            carried.name,
            scenario.vehicles.len(),
            scenario.duration_s,
            scenario.about
        ))?;
    }
    Ok(())
}

fn unknown(name: &str) -> Failure {
    let names = CARRIED.iter().map(|carried| carried.name).collect::<Vec<_>>().join(", ");
    Failure::Input(format!(
        "there is no file {name} and the program carries no scenario of that name; it carries {names}"
    ))
}
