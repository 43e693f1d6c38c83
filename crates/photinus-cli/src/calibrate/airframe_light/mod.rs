//! `photinus calibrate airframe-light`: recordings of one neighbour -> how its LEDs shine, and how well their positions are known.

mod report;

use std::path::{Path, PathBuf};

use photinus::camera::Camera;
use photinus::locator::{self, Locator, Settings};
use photinus_calibrate::airframe_light::{Flight, Light, LightError, calibrate};
use photinus_io::airframe::{AirframeFile, Tolerances, toml_text};
use photinus_io::{Error, Place};

use crate::beforehand;
use crate::ending::Content;
use crate::failure::Failure;
use crate::input::{DatasetArgs, Input, InputArgs};
use crate::spot_options::{SpotArgs, mask_of};
use crate::targets::{Targets, WriteArgs};
use crate::terminal::Terminal;

const EXAMPLES: &str = "\
Examples:
  photinus calibrate airframe-light flight --out learned.toml
  photinus calibrate airframe-light morning evening --airframe quad.toml \\
      --out learned.toml
  photinus locate other-flight --airframe learned.toml

A recording is a dataset folder. Fly one robot alone in front of the camera, 500
frames or more at 10 per second or faster; let it turn about itself several
times, near by and farther away, so that every LED is seen from all sides, often
without a saturated pixel: a short exposure helps. Gravity in the recording
makes it surer. Faint spots count where a marker is. What is not learned stays
as the airframe file has it: positions, axes and signals.";

/// Recordings further apart than any loss within one, s.
const APART_S: f64 = 1e6;

/// Calibrate how the LEDs of an airframe shine: lobes, the power of each, how well positions are known
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Args {
    /// Folders of datasets that show one such robot alone
    #[arg(value_name = "RECORDING", required = true)]
    recordings: Vec<PathBuf>,
    /// The camera's calibration, in any format that `photinus info` knows [default: that of the dataset]
    #[arg(long, value_name = "FILE")]
    camera: Option<PathBuf>,
    /// The airframe as it is known so far [default: that of the first dataset]
    #[arg(long, value_name = "FILE")]
    airframe: Option<PathBuf>,
    /// Write the airframe as learned
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    #[command(flatten)]
    spots: SpotArgs,
    #[command(flatten)]
    dataset: DatasetArgs,
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
    let open = |recording: &PathBuf| InputArgs::of(std::slice::from_ref(recording), &args.dataset).open();
    let inputs: Vec<Input> = args.recordings.iter().map(open).collect::<Result<_, _>>()?;
    let named = args.airframe.clone().or_else(|| of_dataset(&inputs[0]));
    let path = named.ok_or_else(|| {
        Failure::Input(
            "no airframe: give --airframe FILE, or a dataset folder, which names its own".to_owned(),
        )
    })?;
    let files = inputs.iter().flat_map(|input| input.files.iter().cloned());
    let beside = args.camera.iter().cloned().chain([path.clone()]).chain(args.spots.file());
    let mut targets = Targets::new(args.write, files.chain(beside));
    let out = args.out.as_deref().map(|out| targets.file(out, Content::Toml)).transpose()?;
    let known = beforehand::airframe(&path, terminal).map_err(Failure::input)?;
    let mut flight = Flight::new(&known.airframe);
    for (number, input) in inputs.into_iter().enumerate() {
        let mut recording = Recording::new(args, input, &known, terminal)?;
        recording.follow(&mut flight, number as f64 * APART_S, terminal)?;
    }
    let found = calibrate(&flight).map_err(|error| refuse(&args.recordings[0], &flight, &error))?;
    if let Some(out) = out {
        let text = toml_text(&found.airframe, &tolerances(&found, &known.tolerances));
        out.write(format!("{}{text}", report::comment(&found)).as_bytes()).map_err(Failure::running)?;
    }
    match args.quiet {
        true => Ok(()),
        false => terminal.result(report::Told { found: &found, flight: &flight }),
    }
}

/// How well the airframe is known now; what the flight does not tell is as before.
fn tolerances(found: &Light, before: &Tolerances) -> Tolerances {
    let told_m = found.position_sigma_m.map(|sigma_m| sigma_m.value);
    Tolerances {
        position_sigma_m: told_m.or(before.position_sigma_m),
        power_sigma: found.power_sigma().or(before.power_sigma),
    }
}

fn of_dataset(input: &Input) -> Option<PathBuf> {
    input.dataset.as_ref().map(|dataset| dataset.path(&dataset.info().airframe.first))
}

/// Frames of one camera, and what locates the neighbour in them.
struct Recording {
    input: Input,
    locator: Locator,
}

impl Recording {
    fn new(args: &Args, input: Input, known: &AirframeFile, terminal: &Terminal) -> Result<Self, Failure> {
        let of_dataset = input.one_camera()?.zip(input.dataset.as_ref());
        let path =
            args.camera.clone().or_else(|| of_dataset.map(|(camera, dataset)| dataset.path(&camera.camera)));
        let path = path.ok_or_else(|| {
            Failure::Input(
                "no camera: give --camera FILE, or a dataset folder, which names its own".to_owned(),
            )
        })?;
        let camera: Camera = beforehand::camera(&path, terminal).map_err(Failure::input)?.camera;
        let mut settings = Settings::default();
        settings.spots = args.spots.settings();
        settings.pose.marker_sigma_m =
            known.tolerances.position_sigma_m.unwrap_or(settings.pose.marker_sigma_m);
        let mask = args.spots.masks(&input, terminal)?.pop().flatten();
        let refuse = |error: photinus::locator::LocatorError| Failure::Input(error.to_string());
        let mut locator =
            Locator::new(camera, &known.airframe, None, Flight::settings(settings)).map_err(refuse)?;
        locator.set_mask(mask_of(mask.as_ref()).cloned()).map_err(refuse)?;
        Ok(Self { input, locator })
    }

    /// Adds what every frame shows to the flight, its times after `begins_s`.
    fn follow(&mut self, flight: &mut Flight, begins_s: f64, terminal: &mut Terminal) -> Result<(), Failure> {
        terminal.start(self.input.count);
        for (number, entry) in (0_u32..).zip(&mut self.input.entries) {
            terminal.frame_done();
            let entry = match entry {
                Ok(entry) => entry,
                Err(error) => {
                    terminal.error(error);
                    continue;
                }
            };
            let Some(image) = &entry.image else { continue };
            let view = image.view();
            let input = locator::Input::frame(&view).gravity(entry.gravity.as_ref());
            let located = self.locator.locate(input.exposure(entry.exposure_s)).map_err(|error| {
                let frame = entry.record.frame.unwrap_or(u64::from(number));
                Failure::input(Error::format(&entry.record.source, error.to_string()).at(Place::Frame(frame)))
            })?;
            let time_s = entry.record.time_s.unwrap_or(f64::from(number) * UNTIMED_S);
            flight.add(located, entry.gravity.as_ref(), begins_s + time_s);
        }
        terminal.finish();
        Ok(())
    }
}

/// From frame to frame where nobody wrote down times, s.
const UNTIMED_S: f64 = 0.05;

fn refuse(recording: &Path, flight: &Flight, error: &LightError) -> Failure {
    let advice = match error {
        LightError::TooFewFrames { .. } if flight.not_alone() > 0 => {
            "record longer, with one robot alone in sight, and gravity if the camera's robot knows it"
        }
        LightError::TooFewFrames { .. } => {
            "record longer and nearer by, and gravity if the camera's robot knows it"
        }
        LightError::TooFewLights { .. } => "record with a shorter exposure or from farther away",
        _ => "check that the airframe and the camera are those of the recording",
    };
    Failure::input(Error::format(recording, error.to_string()).advise(advice))
}
