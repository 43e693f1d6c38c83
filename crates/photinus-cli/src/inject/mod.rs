//! `photinus inject`: a dataset with faults wrapped around its frames, as a dataset.
//!
//! Frames go through `photinus_sim::faults`, camera by camera; the files beside them are copied, or written as they are told when a
//! fault is in what is told (`folder.rs`); truth goes along as far as its frames do.

mod folder;

use std::collections::HashMap;
use std::path::PathBuf;

use photinus_io::Result;
use photinus_io::dataset::{Dataset, DatasetWriter, TruthFrame};
use photinus_io::frames::FrameSource;
use photinus_sim::faults::{Fault, Faults, Shot};

use crate::failure::Failure;
use crate::interrupt;
use crate::targets::{Targets, WriteArgs};
use crate::terminal::Terminal;

const EXAMPLES: &str = "\
Examples:
  photinus inject flight --fault noise=8 --out noisy
  photinus inject flight --fault lamp=25px-beside --fault gravity=5 \\
      --out bad-day --seed 3
  photinus locate bad-day --out results.jsonl \\
      && photinus evaluate bad-day results.jsonl

Faults happen in the order in which they are given; the same seed gives the same
bytes. Frames are 8 bit before and after each.";

/// Write a dataset again with faults: noise, lamps, dead LEDs, lost frames, ...
#[derive(Debug, clap::Args)]
#[command(after_help = help())]
pub(crate) struct Args {
    /// The dataset folder
    #[arg(value_name = "DATASET")]
    dataset: PathBuf,
    /// A fault, of those below; may be given several times
    #[arg(long = "fault", value_name = "WORD", required = true)]
    faults: Vec<Fault>,
    /// The new dataset folder
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Seed of the random numbers
    #[arg(long, value_name = "SEED", default_value_t = 0)]
    seed: u64,
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

    /// What goes wrong with a camera: each with random numbers of its own.
    fn of_camera(&self, camera: usize) -> Faults {
        Faults { list: self.faults.clone(), seed: self.seed ^ ((camera as u64) << 56) }
    }
}

/// The words of faults, and examples.
fn help() -> String {
    let line = |(word, meaning): &(&str, &str)| format!("  {word:17} {meaning}\n");
    format!("Faults:\n{}\n{EXAMPLES}", Fault::WORDS.iter().map(line).collect::<String>())
}

/// Truth by the camera and the number of the frame.
type Truth = HashMap<(Option<String>, u64), TruthFrame>;

/// Runs the command.
pub(crate) fn run(args: &Args, terminal: &mut Terminal) -> std::result::Result<(), Failure> {
    let dataset = Dataset::read(&args.dataset).map_err(Failure::input)?;
    let advice = "copy it first, with photinus convert --allow-outside";
    dataset.check_inside().map_err(|error| Failure::input(error.advise(advice)))?;
    let truth = dataset.truth().map_err(Failure::input)?;
    if let (None, Some(fault)) = (&truth, args.faults.iter().find(|fault| fault.needs_truth())) {
        return Err(Failure::Input(format!(
            "{}: it holds no truth, and {fault} needs to know where markers are; simulate a dataset, or place a lamp yourself",
            args.dataset.display()
        )));
    }
    let target = Targets::new(args.write, dataset.files()).folder(&args.out)?;
    let making = target.whole().map_err(Failure::input)?;
    let mut writer = folder::start(&dataset, &args.of_camera(0), making.path())
        .map_err(|error| Failure::input(making.tell(error)))?;
    let by_frame = |truth: TruthFrame| ((truth.camera.clone(), truth.frame), truth);
    let mut truth: Truth = truth.unwrap_or_default().into_iter().map(by_frame).collect();
    let count: u64 = dataset.cameras().iter().map(|camera| camera.frames.len() as u64).sum();
    terminal.start(Some(count));
    let (mut written, mut failed) = (0_u64, 0_u64);
    for camera in 0..dataset.cameras().len() {
        for shot in args.of_camera(camera).inject(shots(&dataset, camera, &mut truth)) {
            match shot {
                Ok(shot) => {
                    write(&mut writer, camera, &shot)
                        .map_err(|error| Failure::running(making.tell(error)))?;
                    written += 1;
                }
                Err(error) => {
                    failed += 1;
                    terminal.error(error);
                }
            }
            terminal.frame_done();
            if interrupt::is_asked() {
                break;
            }
        }
    }
    interrupt::look_away();
    terminal.finish();
    drop(writer);
    if written > 0 {
        making.keep().map_err(Failure::running)?;
    }
    if interrupt::is_asked() {
        let told = format!("interrupted; {}: {written} frames are in it", args.out.display());
        return Err(Failure::Interrupted(told));
    }
    terminal.summary(format_args!(
        "{}: {written} of {count} frames written to {}",
        args.dataset.display(),
        args.out.display()
    ));
    match failed {
        0 => Ok(()),
        _ => Err(Failure::Frames { all: written == 0 }),
    }
}

/// The frames of a camera with their truth.
fn shots(dataset: &Dataset, camera: usize, truth: &mut Truth) -> impl Iterator<Item = Result<Shot>> {
    let name = dataset.cameras()[camera].name.clone();
    FrameSource::dataset_camera(dataset.clone(), camera).map(move |frame| {
        frame.map(|frame| Shot { truth: truth.remove(&(name.clone(), frame.index)), frame })
    })
}

fn write(writer: &mut DatasetWriter, camera: usize, shot: &Shot) -> Result<()> {
    let frame = &shot.frame;
    writer.image(camera, frame.index, &frame.image.view())?;
    writer.row(camera, frame.index, frame.time_s.unwrap_or_default(), frame.gravity, frame.index)?;
    shot.truth.as_ref().map_or(Ok(()), |truth| writer.truth(truth))
}
