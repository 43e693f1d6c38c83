//! `photinus inject`: a dataset with faults wrapped around its frames, as a dataset.
//!
//! Frames go through `photinus_sim::faults`; camera and airframe are copied, or written as they are told when a fault is in what is
//! told; truth goes along as far as its frames do.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use photinus_io::airframe::{read_airframe, toml_text};
use photinus_io::camera::write_camera_toml;
use photinus_io::dataset::{Dataset, DatasetInfo, DatasetWriter, TruthFrame};
use photinus_io::frames::FrameSource;
use photinus_io::{Error, Result, read_camera};
use photinus_sim::faults::{Fault, Faults, Shot};

use crate::failure::Failure;
use crate::output::refuse_to_mix;
use crate::terminal::Terminal;

const EXAMPLES: &str = "\
Examples:
  photinus inject flight --fault noise=8 --out noisy
  photinus inject flight --fault lamp=25px-beside --fault gravity=5 --out bad-day --seed 3
  photinus locate bad-day --out results.jsonl && photinus evaluate bad-day results.jsonl

Faults happen in the order in which they are given; the same seed gives the same bytes. Frames are 8 bit before and after each.";

/// Wrap faults around the frames of a dataset: noise, lamps, dead LEDs, lost frames, ...
#[derive(Debug, clap::Args)]
#[command(after_help = help())]
pub(crate) struct Args {
    /// The dataset folder
    #[arg(value_name = "DATASET")]
    dataset: PathBuf,
    /// What goes wrong, once for each; the words are below
    #[arg(long = "fault", value_name = "WORD", required = true)]
    faults: Vec<Fault>,
    /// The new dataset folder
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Where random numbers start
    #[arg(long, value_name = "SEED", default_value_t = 0)]
    seed: u64,
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

/// The words of faults, and examples.
fn help() -> String {
    let line = |(word, meaning): &(&str, &str)| format!("  {word:17} {meaning}\n");
    format!("Faults:\n{}\n{EXAMPLES}", Fault::WORDS.iter().map(line).collect::<String>())
}

/// Runs the command.
pub(crate) fn run(args: &Args, terminal: &mut Terminal) -> std::result::Result<(), Failure> {
    let dataset = Dataset::read(&args.dataset).map_err(Failure::input)?;
    let truth = dataset.truth().map_err(Failure::input)?;
    if let (None, Some(fault)) = (&truth, args.faults.iter().find(|fault| fault.needs_truth())) {
        return Err(Failure::Input(format!(
            "{}: it holds no truth, and {fault} needs to know where markers are; simulate a dataset, or place a lamp yourself",
            args.dataset.display()
        )));
    }
    refuse_to_mix(&args.out)?;
    let faults = Faults { list: args.faults.clone(), seed: args.seed };
    let mut writer = create(&dataset, &faults, &args.out).map_err(Failure::input)?;
    let mut truth: HashMap<u64, TruthFrame> =
        truth.unwrap_or_default().into_iter().map(|truth| (truth.frame, truth)).collect();
    terminal.start(Some(dataset.frames().len() as u64));
    let shots = FrameSource::dataset(dataset.clone())
        .map(|frame| frame.map(|frame| Shot { truth: truth.remove(&frame.index), frame }));
    let (mut written, mut failed) = (0_u64, 0_u64);
    for shot in faults.inject(shots) {
        match shot {
            Ok(shot) => {
                write(&mut writer, &shot).map_err(Failure::running)?;
                written += 1;
            }
            Err(error) => {
                failed += 1;
                terminal.error(error);
            }
        }
        terminal.frame_done();
    }
    terminal.finish();
    terminal.summary(format_args!(
        "{}: {written} of {} frames written to {}",
        args.dataset.display(),
        dataset.frames().len(),
        args.out.display()
    ));
    match failed {
        0 => Ok(()),
        _ => Err(Failure::Frames { all: written == 0 }),
    }
}

fn write(writer: &mut DatasetWriter, shot: &Shot) -> Result<()> {
    let frame = &shot.frame;
    writer.numbered_frame(
        frame.index,
        &frame.image.view(),
        frame.time_s.unwrap_or_default(),
        frame.gravity,
    )?;
    shot.truth.as_ref().map_or(Ok(()), |truth| writer.truth(truth))
}

/// Starts the new dataset: what is told of camera and airframe, and copies of the rest.
fn create(dataset: &Dataset, faults: &Faults, out: &Path) -> Result<DatasetWriter> {
    let old = dataset.info();
    let is_in = |of: fn(&Fault) -> bool| faults.list.iter().any(of);
    let (camera_told, airframe_told) =
        (is_in(|fault| matches!(fault, Fault::Focal(_))), is_in(|fault| matches!(fault, Fault::Airframe(_))));
    let named = |path: &PathBuf, name: &str, is_told: bool| {
        let extension = path.extension().map_or(String::new(), |end| format!(".{}", end.to_string_lossy()));
        PathBuf::from(if is_told { format!("{name}.toml") } else { format!("{name}{extension}") })
    };
    let info = DatasetInfo {
        camera: named(&old.camera, "camera", camera_told),
        airframe: named(&old.airframe, "airframe", airframe_told),
        spot_curve: old.spot_curve.as_ref().map(|path| named(path, "spot_curve", false)),
        mask: old.mask.as_ref().map(|path| named(path, "mask", false)),
        ..old.clone()
    };
    let camera = read_camera(&dataset.path(&old.camera))?.camera;
    let airframe = read_airframe(dataset.path(&old.airframe))?.airframe;
    let wrong = |named: &Path, reason: String| Error::format(dataset.path(named), reason);
    let camera = faults.camera(&camera).map_err(|error| wrong(&old.camera, error.to_string()))?;
    let airframe = faults.airframe(&airframe).map_err(|error| wrong(&old.airframe, error.to_string()))?;

    let writer = DatasetWriter::create(out, &info)?;
    let text_to = |name: &Path, text: &[u8]| {
        let path = out.join(name);
        std::fs::write(&path, text).map_err(|error| Error::io(path, error))
    };
    let mut text = Vec::new();
    write_camera_toml(&camera, &mut text, &out.join(&info.camera))?;
    match camera_told {
        true => text_to(&info.camera, &text)?,
        false => copy(dataset, &old.camera, out, &info.camera)?,
    }
    match airframe_told {
        true => text_to(&info.airframe, toml_text(&airframe).as_bytes())?,
        false => copy(dataset, &old.airframe, out, &info.airframe)?,
    }
    for (from, to) in [(&old.spot_curve, &info.spot_curve), (&old.mask, &info.mask)] {
        if let (Some(from), Some(to)) = (from, to) {
            copy(dataset, from, out, to)?;
        }
    }
    Ok(writer)
}

fn copy(dataset: &Dataset, from: &Path, out: &Path, to: &Path) -> Result<()> {
    let (from, to) = (dataset.path(from), out.join(to));
    std::fs::copy(&from, &to).map(drop).map_err(|error| Error::io(&from, error))
}
