//! `photinus locate`: frames -> neighbours with distances and bounds.

mod batch;
mod lines;
mod place;
#[cfg(feature = "parquet")]
mod table;

use std::path::{Path, PathBuf};

use nalgebra::{Unit, Vector3};
use photinus::camera::Bearing;
use photinus::locator::{Kind, Settings};
use photinus::ranging::SpotCurve;
use photinus_io::calibration::{MountingFile, read_mounting};
use photinus_io::dataset::{Dataset, DatasetCamera};
use photinus_io::mask::MaskFile;
use photinus_io::sky::Sky;
use photinus_link::recording::Motions;
use photinus_run::View;
use photinus_run::course::{Course, Told, lever_m};
use photinus_run::watch::{self, Looking, Watch};

use crate::beforehand::{self, Conditions};
use crate::failure::Failure;
use crate::input::{Input, InputArgs};
use crate::number;
use crate::output::OutputArgs;
use crate::pose_options::PoseArgs;
use crate::run;
use crate::spot_options::{SpotArgs, mask_of};
use crate::terminal::Terminal;
use batch::BatchArgs;

const EXAMPLES: &str = "\
Examples:
  # a dataset folder says itself what camera and airframe are
  photinus locate recording --out results.jsonl
  # every frame by itself
  photinus locate recording --no-time --out results.jsonl
  # goes on where a stopped run ended
  photinus locate recording --out results.jsonl --resume
  # many recordings on all cores; the same command goes on after a crash
  photinus locate recording flight --out-dir located
  photinus locate *.png --camera camera.txt --airframe quad.toml \\
      --overlay seen
  photinus locate video.y4m --camera camera.txt --airframe quad.toml \\
      --gravity 0,1,0 --csv results.csv
  photinus locate --spots spots.jsonl --camera camera.txt \\
      --airframe quad.toml --out -
  ffmpeg -i video.mp4 -pix_fmt gray -f yuv4mpegpipe -strict -1 - |
    photinus locate - --camera camera.txt --airframe quad.toml

Without --out and --csv a line per neighbour is printed: distance with its
standard deviation, bounds that truth never leaves, and where it is seen from
the camera; of a vehicle that blinks words of the dataset, who it is.

Frames that have times are followed: results have tracks with velocities, also
of who is hidden or dark, and ids where the dataset says who blinks what.

Exit codes: 0 done, 1 some frames failed or writing did, 2 bad usage or input,
or no frame could be used.";

/// Locate the neighbours in frames: how far, between which bounds, where
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Args {
    #[command(flatten)]
    input: InputArgs,
    /// Spots of another detector in place of frames: JSON lines, see docs/file-formats.md
    #[arg(long, value_name = "FILE", conflicts_with_all = ["contrast", "threshold", "reflection_ratio", "mask"])]
    spots: Option<PathBuf>,
    /// The camera's calibration, in any format that `photinus info` knows [default: that of the dataset]
    #[arg(long, value_name = "FILE")]
    camera: Option<PathBuf>,
    /// The neighbours' airframe: where its LEDs sit; once for each kind of neighbour [default: those of the dataset]
    #[arg(long, value_name = "FILE")]
    airframe: Vec<PathBuf>,
    /// How the camera sits on its vehicle, as `photinus calibrate mounting` writes it: neighbours are told in the body frame, too
    /// [default: that of the dataset, if any]
    #[arg(long, value_name = "FILE")]
    mounting: Option<PathBuf>,
    /// How large a spot can be at a distance: a TOML file, or `paper` [default: that of the dataset, if any]
    #[arg(long, value_name = "FILE|paper")]
    spot_curve: Option<PathBuf>,
    /// Direction of gravity (down) in the camera frame: x right, y down, z forward [default: that of each frame, if any]
    #[arg(long, value_name = "X,Y,Z", value_parser = gravity, allow_hyphen_values = true)]
    gravity: Option<Unit<Vector3<f64>>>,
    /// Where and when it was recorded, which tells where the sun was: degrees north and east, the time in UTC at time 0 of the
    /// frames, and, for a camera that keeps it, its heading clockwise from north [default: that of the dataset, if any]
    #[arg(long, value_name = "LATITUDE,LONGITUDE,TIME[,HEADING]", allow_hyphen_values = true)]
    sky: Option<Sky>,
    /// Largest tilt of a neighbour that the bounds allow for, where gravity is known
    #[arg(long, value_name = "DEG", default_value_t = 15.0, value_parser = tilt)]
    max_tilt: f64,
    /// Neighbours less likely than this are left out: clutter now and then looks like one
    #[arg(long, value_name = "SHARE", default_value_t = Settings::DEFAULT_MIN_PROBABILITY, value_parser = probability)]
    min_probability: f64,
    /// Most work on one frame, in looks at a handful of spots, a few microseconds each: bounds the time of frames full of clutter
    #[arg(long, value_name = "LOOKS", default_value_t = Settings::DEFAULT_BUDGET)]
    budget: u32,
    #[command(flatten)]
    pose_options: PoseArgs,
    #[command(flatten)]
    spot_options: SpotArgs,
    #[command(flatten)]
    output: OutputArgs,
    #[command(flatten)]
    batch: BatchArgs,
    /// Every frame by itself: no tracks, no velocities, no ids
    #[arg(long)]
    no_time: bool,
    /// Follow neighbours from frame to frame, which is the default
    #[arg(long = "track", hide = true, conflicts_with = "no_time")]
    _track: bool,
    /// Write a table with a row per neighbour; - is standard output
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
}

impl Args {
    /// Whether only errors and results are to be printed.
    pub(crate) fn quiet(&self) -> bool {
        self.output.quiet
    }

    /// The files that are read beside the input.
    fn files(&self) -> impl Iterator<Item = PathBuf> {
        [&self.camera, &self.spot_curve, &self.mounting]
            .into_iter()
            .flatten()
            .chain(&self.airframe)
            .cloned()
            .chain(self.spot_options.file())
    }

    fn open_input(&self) -> std::result::Result<Input, Failure> {
        match &self.spots {
            Some(path) => self.input.open_spots(path),
            None => self.input.open(),
        }
    }

    /// The kinds of neighbours that are looked for.
    fn kinds(&self, input: &Input, terminal: &Terminal) -> std::result::Result<Vec<Kind>, Failure> {
        let of_dataset = || input.dataset.as_ref().map(Dataset::airframes);
        let named = (!self.airframe.is_empty()).then(|| self.airframe.clone());
        let paths = named.or_else(of_dataset).ok_or_else(|| missing("airframe"))?;
        let read = |path: PathBuf| beforehand::airframe(&path, terminal).map(|file| (path, file));
        let files = paths.into_iter().map(read).collect::<photinus_io::Result<_>>();
        let kinds = files.and_then(watch::told_apart).map_err(Failure::input)?;
        Ok(kinds.into_iter().map(|file| self.pose_options.kind(file)).collect())
    }

    fn settings(&self) -> Settings {
        let mut settings = Settings::default();
        settings.spots = self.spot_options.settings();
        settings.max_tilt_rad = self.max_tilt.to_radians();
        settings.pose = self.pose_options.settings();
        settings.min_probability = self.min_probability;
        settings.budget = self.budget;
        settings
    }

    /// What looks through each camera of the input.
    fn views(
        &self,
        input: &Input,
        kinds: &[Kind],
        terminal: &Terminal,
    ) -> std::result::Result<Vec<View>, Failure> {
        if self.camera.is_some() || self.spot_curve.is_some() || self.mounting.is_some() {
            input.one_camera()?;
        }
        let cameras: Vec<Option<&DatasetCamera>> = match input.cameras.as_slice() {
            [] => vec![None],
            cameras => cameras.iter().map(Some).collect(),
        };
        let masks = self.spot_options.masks(input, terminal)?;
        let warn = |text: String| terminal.warning(format_args!("{}: {text}", input.name));
        let dataset = input.dataset.as_ref().filter(|_| !self.no_time);
        let fleets = watch::fleets(dataset, kinds, warn).map_err(Failure::input)?;
        let view = |(of_dataset, mask): (Option<&DatasetCamera>, Option<MaskFile>)| {
            let named = of_dataset.zip(input.dataset.as_ref());
            let path = needed(self.camera.as_deref(), "camera", named.map(|(c, d)| d.path(&c.camera)))?;
            let camera = beforehand::camera(&path, terminal).map_err(Failure::input)?.camera;
            if let Some(mask) = &mask {
                mask.check_size(camera.width(), camera.height()).map_err(Failure::input)?;
            }
            let mounting = match &self.mounting {
                Some(path) => Some(read_mounting(path).map_err(Failure::input)?),
                None => of_dataset.and_then(|camera| camera.mounting),
            };
            let curve = self.spot_curve(named, terminal)?;
            let mask = mask_of(mask.as_ref());
            let view = View::new(camera.clone(), kinds, curve, self.settings(), mask)
                .map_err(|error| Failure::Input(error.to_string()))?
                .mounted(mounting)
                .level(self.gravity)
                .under(self.sky.or_else(|| input.dataset.as_ref()?.sky()));
            if self.no_time {
                return Ok((view, None));
            }
            let is_rig = of_dataset.is_some_and(|camera| camera.name.is_some());
            let course = match dataset {
                Some(dataset) => Course::of(dataset, is_rig, mounting.as_ref()).map_err(Failure::input)?,
                None => recorded(input, mounting.as_ref(), terminal).map_err(Failure::input)?,
            };
            let (mask, exposure_us) = (mask.cloned(), of_dataset.map(|camera| camera.exposure_us));
            Ok((view, Some(Looking { camera, mask, mounting, course, exposure_us })))
        };
        let views = cameras.into_iter().zip(masks).map(view).collect::<std::result::Result<Vec<_>, _>>()?;
        let (views, looking): (Vec<_>, Vec<_>) = views.into_iter().unzip();
        let looking: Vec<Looking> = looking.into_iter().flatten().collect();
        if looking.is_empty() {
            return Ok(views);
        }
        let watches = Watch::of(looking, kinds, &self.settings(), &fleets)
            .map_err(|error| Failure::Input(error.to_string()))?;
        Ok(views.into_iter().zip(watches).map(|(view, watch)| view.following(watch)).collect())
    }

    fn spot_curve(
        &self,
        named: Option<(&DatasetCamera, &Dataset)>,
        terminal: &Terminal,
    ) -> std::result::Result<Option<SpotCurve>, Failure> {
        let of_dataset = || named.and_then(|(c, d)| c.spot_curve.as_ref().map(|named| d.path(named)));
        let Some(path) = self.spot_curve.clone().or_else(of_dataset) else { return Ok(None) };
        let file = beforehand::spot_curve(&path).map_err(Failure::input)?;
        let brightness = self.spot_options.settings().brightness;
        let now = Conditions {
            brightness: self.spots.is_none().then_some(brightness),
            exposure_us: named.map(|(camera, _)| camera.exposure_us),
        };
        for difference in beforehand::differences(&file, &now) {
            terminal.warning(format_args!("{}: {difference}", path.display()));
        }
        Ok(Some(file.curve))
    }
}

/// Runs the command.
pub(crate) fn run(args: &Args, terminal: &mut Terminal) -> std::result::Result<(), Failure> {
    if let Some(folder) = &args.batch.out_dir {
        return batch::run(args, folder, terminal);
    }
    let done = args.output.done()?;
    let input = args.open_input()?;
    let kinds = args.kinds(&input, terminal)?;
    let read: Vec<PathBuf> = input.files.iter().cloned().chain(args.files()).collect();
    let mut views = args.views(&input, &kinds, terminal)?;
    let cameras = views.iter().map(|view| view.camera.clone()).collect();
    let outputs = args.output.claim(args.csv.as_deref(), &read, cameras, lines::of)?;
    run::run(input, outputs, done.as_ref(), terminal, &mut views)
}

fn probability(text: &str) -> std::result::Result<f64, String> {
    number::within(text, 0.0..=1.0, "a share")
}

/// What a recording says of the vehicle's own motion.
fn recorded(
    input: &Input,
    mounting: Option<&MountingFile>,
    terminal: &Terminal,
) -> photinus_io::Result<Course> {
    let Some(path) = &input.recording else { return Ok(Course::default()) };
    let motions = Motions::read(path)?;
    let mounting = match mounting {
        _ if motions.is_empty() => return Ok(Course::default()),
        Some(mounting) => mounting,
        None => {
            let path = path.display();
            terminal.warning(format_args!(
                "{path}: its imu or odometry is not used: how the camera sits on the vehicle is not known; give --mounting"
            ));
            return Ok(Course::default());
        }
    };
    let camera_from_body = mounting.body_from_camera.inverse();
    let turn = |(time_s, of_body)| (time_s, camera_from_body * of_body);
    Ok(Course::Told(Told {
        rates: motions.rates.into_iter().map(turn).collect(),
        velocities: motions
            .velocities
            .into_iter()
            .map(|(time_s, velocity)| (time_s, velocity.turned(&camera_from_body)))
            .collect(),
        lever_m: lever_m(mounting),
        has_down: true,
        attitudes: motions
            .attitudes
            .into_iter()
            .map(|(time_s, world_from_body)| (time_s, world_from_body * mounting.body_from_camera))
            .collect(),
    }))
}

/// The file that was named, or that of the dataset.
fn needed(
    named: Option<&Path>,
    what: &str,
    of_dataset: Option<PathBuf>,
) -> std::result::Result<PathBuf, Failure> {
    named.map(Path::to_owned).or(of_dataset).ok_or_else(|| missing(what))
}

fn missing(what: &str) -> Failure {
    Failure::Input(format!("no {what}: give --{what} FILE, or a dataset folder, which names its own"))
}

fn gravity(text: &str) -> std::result::Result<Unit<Vector3<f64>>, String> {
    let wrong = || "give three numbers, such as 0,1,0 for a level camera".to_owned();
    let numbers: Vec<f64> = text
        .split(',')
        .map(|word| word.trim().parse().map_err(|_| wrong()))
        .collect::<std::result::Result<_, _>>()?;
    let [x, y, z] = numbers.as_slice() else { return Err(wrong()) };
    let down =
        Bearing::new(Vector3::new(*x, *y, *z)).ok_or_else(|| "these numbers have no direction".to_owned())?;
    Ok(Unit::new_unchecked(*down.vector()))
}

fn tilt(text: &str) -> std::result::Result<f64, String> {
    let degrees: Option<f64> = text.parse().ok().filter(|degrees| (0.0..=180.0).contains(degrees));
    degrees.ok_or_else(|| "give degrees, 0 to 180".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gravity_is_a_direction_of_any_length() {
        assert_eq!(gravity("0, 9.81,0"), Ok(Vector3::y_axis()));
        for wrong in ["", "0,1", "0,0,0", "0,1,nan", "0,1,inf", "a,b,c", "0,1,0,0"] {
            assert!(gravity(wrong).is_err(), "{wrong}");
        }
    }
}
