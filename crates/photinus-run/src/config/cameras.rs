//! Tables of the configuration -> what looks through each camera, and what opens it.

use std::path::{Path, PathBuf};
use std::time::Instant;

use nalgebra::{Unit, Vector3};
use photinus::identity::CodeBook;
use photinus::locator::{self, Kind};
use photinus::lookout::Fleet;
use photinus::spots::Brightness;
use photinus_io::airframe::{AirframeFile, read_airframe};
use photinus_io::calibration::read_mounting;
use photinus_io::codes::read_codes;
use photinus_io::dataset::{self, Dataset, DatasetCamera, Vehicle};
use photinus_io::mask::read_mask;
use photinus_io::spot_curve::{SpotCurveFile, read_spot_curve};
use photinus_io::{Error, Place, Result, read_camera};

use super::Config;
use super::keys::{CameraKeys, LocateKeys, SourceKeys, TimesKey};
use crate::course::Course;
use crate::exposure::Exposure;
use crate::live::{Camera, Pace};
use crate::motion::Motion;
use crate::source::{Carrier, Opener, Recorded, Source, Stream, StreamFormat, Takeoff, Times};
use crate::watch::{self, Looking, Watch};
use crate::{HostClock, View};

/// The exposure of frames of which nobody says it, us.
const EXPOSURE_US: f64 = 1000.0;

/// Opens frames that come from elsewhere, or spots where that is said; `None` where nothing is linked that can.
pub type Linked<'a> = &'a dyn Fn(Origin<'_>, bool) -> Result<Option<Opener>>;

/// Where frames come from that this crate cannot open itself.
#[derive(Clone, Debug, PartialEq)]
pub enum Origin<'a> {
    /// A topic of ROS 2.
    Ros2(&'a str),
    /// A key of Zenoh.
    Zenoh(&'a str),
    /// What a run recorded.
    Recording {
        /// Its file.
        path: PathBuf,
        /// Which of its cameras, where it has several.
        camera: Option<&'a str>,
    },
    /// A scene, rendered while it runs.
    Scene {
        /// Its file.
        path: PathBuf,
        /// Which of its cameras, where it has several.
        camera: Option<&'a str>,
        /// How long it is exposed, us, where that is not as the scene says.
        exposure_us: Option<f64>,
        /// When its clock shows 0; without, frames come as fast as they are taken.
        takeoff: Option<Takeoff>,
        /// It goes on past its duration.
        repeat: bool,
    },
}

impl Origin<'_> {
    /// What opens it, and what to do where that is missing.
    fn wants(&self) -> (&'static str, &'static str) {
        match self {
            Origin::Ros2(_) => ("messages of ros2", "build with --features ros2, or name another source"),
            Origin::Zenoh(_) => (
                "messages of zenoh",
                "build with --features zenoh and add the table [zenoh], or name another source",
            ),
            Origin::Recording { .. } => ("recordings", "name another source"),
            Origin::Scene { .. } => ("scenes", "name another source"),
        }
    }
}

/// A camera of the configuration, with the dataset that it is of.
struct Named<'a> {
    keys: &'a CameraKeys,
    recording: Option<(Dataset, usize)>,
}

impl Named<'_> {
    fn of_dataset(&self) -> Option<(&Dataset, &DatasetCamera)> {
        self.recording.as_ref().map(|(dataset, number)| (dataset, &dataset.cameras()[*number]))
    }

    /// The file that the configuration names, or else the dataset.
    fn file(
        &self,
        config: &Config,
        own: Option<&PathBuf>,
        of: fn(&DatasetCamera) -> Option<&PathBuf>,
    ) -> Option<PathBuf> {
        let of_dataset = || self.of_dataset().and_then(|(dataset, camera)| Some(dataset.path(of(camera)?)));
        own.map(|path| config.located(path)).or_else(of_dataset)
    }
}

/// The vehicles that the configuration lists itself.
struct Listed {
    file: PathBuf,
    vehicles: Vec<Vehicle>,
    codes: Option<CodeBook>,
}

impl Listed {
    /// Their airframes, a file each, as they can be opened.
    fn airframes(&self) -> Vec<PathBuf> {
        let folder = self.file.parent().unwrap_or(Path::new(""));
        let mut files: Vec<PathBuf> = Vec::new();
        for vehicle in &self.vehicles {
            let file = folder.join(&vehicle.airframe_file);
            if !files.contains(&file) {
                files.push(file);
            }
        }
        files
    }

    fn fleets(&self, kinds: &[Kind], note: &mut dyn FnMut(String)) -> Result<Vec<Option<Fleet>>> {
        match &self.codes {
            Some(book) => watch::fleets_of(book, &self.vehicles, &self.file, kinds, note),
            None => Ok(kinds.iter().map(|_| None).collect()),
        }
    }
}

impl Config {
    /// The cameras, ready to run. `motion` is what arrives of the vehicle's own motion; `linked` opens frames from elsewhere, where it can; `note` takes what
    /// was read otherwise than it stands in a file.
    ///
    /// # Errors
    /// [`Error`] when a file that is named is missing or not in order, or settings have no meaning.
    pub fn cameras(
        &self,
        motion: &Motion,
        linked: Linked<'_>,
        note: &mut dyn FnMut(String),
    ) -> Result<Vec<Camera>> {
        let named = self.keys.camera.iter().enumerate().map(|(number, keys)| self.named(number, keys));
        let named: Vec<Named<'_>> = named.collect::<Result<_>>()?;
        let first = named.iter().find_map(|camera| camera.recording.as_ref());
        let dataset = first.map(|(dataset, _)| dataset);
        let listed = self.listed()?;
        let kinds = self.kinds(listed.as_ref(), dataset, note)?;
        let fleets = match &listed {
            Some(listed) => listed.fleets(&kinds, note)?,
            None => watch::fleets(dataset, &kinds, &mut *note)?,
        };
        let begun = (HostClock::start(), Takeoff::default());
        let start_s = named
            .iter()
            .filter_map(Named::of_dataset)
            .filter_map(|(_, camera)| camera.frames.first())
            .map(|row| row.time_s);
        // All recordings begin together, in the order of their own times.
        let start_s = start_s.reduce(f64::min).unwrap_or(0.0);
        let camera = |camera| self.camera(camera, &kinds, (motion, linked), (&begun, start_s), note);
        let cameras = named.iter().map(camera).collect::<Result<Vec<_>>>()?;
        if !self.keys.locate.time.unwrap_or(true) {
            return Ok(cameras.into_iter().map(|(camera, _)| camera).collect());
        }
        let (cameras, looking): (Vec<_>, Vec<_>) = cameras.into_iter().unzip();
        let watches = Watch::of(looking, &kinds, &self.keys.locate.settings(), &fleets)
            .map_err(|error| self.refuse_settings(error.to_string()))?;
        let following =
            |(camera, watch): (Camera, Watch)| Camera { view: camera.view.following(watch), ..camera };
        Ok(cameras.into_iter().zip(watches).map(following).collect())
    }

    fn refuse_settings(&self, error: String) -> Error {
        Error::format(&self.path, error).at(Place::Key("locate".to_owned()))
    }

    fn named<'a>(&self, number: usize, keys: &'a CameraKeys) -> Result<Named<'a>> {
        let Some(folder) = &keys.source.dataset else { return Ok(Named { keys, recording: None }) };
        let dataset = Dataset::read(self.located(folder))
            .map_err(|error| self.of_key(&format!("camera[{number}].source.dataset"), error))?;
        dataset.check_inside()?;
        let all = dataset.cameras();
        let wanted = keys.source.camera.as_ref();
        let place = match (all.len(), wanted) {
            (1, None) => Some(0),
            _ => all.iter().position(|camera| camera.name.as_ref() == wanted && wanted.is_some()),
        };
        let Some(place) = place else {
            let names: Vec<&str> = all.iter().filter_map(|camera| camera.name.as_deref()).collect();
            let key = format!("camera[{number}].source.camera");
            let advice = format!("give one of: {}", names.join(", "));
            return Err(self.refuse(&key, "the dataset has several cameras, or none of this name", &advice));
        };
        Ok(Named { keys, recording: Some((dataset, place)) })
    }

    /// The vehicles that the configuration lists itself.
    fn listed(&self) -> Result<Option<Listed>> {
        let Some(keys) = &self.keys.vehicles else { return Ok(None) };
        let of_key = |key: &str, error: Error| self.of_key(&format!("vehicles.{key}"), error);
        let codes = keys.codes.as_ref().map(|path| read_codes(self.located(path))).transpose();
        let codes = codes.map_err(|error| of_key("codes", error))?;
        let file = self.located(&keys.file);
        let vehicles =
            dataset::read_vehicles(&file, codes.as_ref()).map_err(|error| of_key("file", error))?;
        Ok(Some(Listed { file, vehicles, codes }))
    }

    /// The kinds of neighbours: as the configuration says, or else those of the vehicles that it lists, or of the dataset.
    fn kinds(
        &self,
        listed: Option<&Listed>,
        dataset: Option<&Dataset>,
        note: &mut dyn FnMut(String),
    ) -> Result<Vec<Kind>> {
        let own = self.keys.airframe.as_ref().map(|keys| keys.file.iter().map(|file| self.located(file)));
        let paths = own.map(Iterator::collect).or_else(|| listed.map(Listed::airframes));
        let Some(paths) = paths.or_else(|| dataset.map(Dataset::airframes)) else {
            let advice = "add [airframe] with file = \"...\", or [vehicles]";
            return Err(self.refuse("airframe", "nobody says how neighbours are built", advice));
        };
        let named = |error: Error| match &self.keys.airframe {
            Some(_) => self.of_key("airframe.file", error),
            None => error,
        };
        let read = |path: PathBuf| read_airframe(&path).map(|file| (path, file));
        let files = paths.into_iter().map(read).collect::<Result<_>>();
        let files = files.and_then(watch::told_apart).map_err(named)?;
        let settings = &self.keys.locate;
        files.iter().flat_map(|file| &file.notes).for_each(|text| note(text.clone()));
        Ok(files.into_iter().map(|file| settings.kind(file)).collect())
    }

    fn camera(
        &self,
        named: &Named<'_>,
        kinds: &[Kind],
        (motion, linked): (&Motion, Linked<'_>),
        ((clock, takeoff), start_s): (&(HostClock, Takeoff), f64),
        note: &mut dyn FnMut(String),
    ) -> Result<(Camera, Looking)> {
        let keys = named.keys;
        let path =
            named.file(self, keys.camera.as_ref(), |camera| Some(&camera.camera)).ok_or_else(|| {
                self.refuse(&format!("camera {}", keys.name), "it has no calibration", "add camera = \"...\"")
            })?;
        let number = self.keys.camera.iter().position(|other| other.name == keys.name).unwrap_or_default();
        let of_key = |key: &str, is_named: bool, error: Error| match is_named {
            true => self.of_key(&format!("camera[{number}].{key}"), error),
            false => error,
        };
        let calibration =
            read_camera(&path).map_err(|error| of_key("camera", keys.camera.is_some(), error))?;
        calibration.oddities.iter().for_each(|oddity| note(format!("{}: {oddity}", path.display())));
        let camera = calibration.camera;
        let mask = match named.file(self, keys.mask.as_ref(), |camera| camera.mask.as_ref()) {
            Some(path) => {
                let file = read_mask(&path).map_err(|error| of_key("mask", keys.mask.is_some(), error))?;
                file.check_size(camera.width(), camera.height())?;
                Some(file.mask)
            }
            None => None,
        };
        let mounting = match &keys.mounting {
            Some(path) => {
                let read = read_mounting(self.located(path));
                Some(read.map_err(|error| of_key("mounting", true, error))?)
            }
            None => named.of_dataset().and_then(|(_, camera)| camera.mounting),
        };
        let curve = match named.file(self, keys.spot_curve.as_ref(), |camera| camera.spot_curve.as_ref()) {
            Some(path) if path.ends_with("paper") => Some(SpotCurveFile::paper_1000_us().curve),
            Some(path) => Some(read_spot_curve(path)?.curve),
            None => None,
        };
        let settings = self.keys.locate.settings();
        let view = View::new(camera.clone(), kinds, curve, settings, mask.as_ref())
            .map_err(|error| self.refuse_settings(error.to_string()))?
            .mounted(mounting)
            .level(self.gravity()?)
            .under(self.sky()?.or_else(|| named.of_dataset()?.0.sky()));
        let exposure_us =
            keys.exposure_us.or_else(|| named.of_dataset().map(|(_, camera)| camera.exposure_us));
        let course = match named.of_dataset() {
            Some((dataset, camera)) => Course::of(dataset, camera.name.is_some(), mounting.as_ref())?,
            None => mounting
                .map_or_else(Course::default, |mounting| Course::Live { motion: motion.clone(), mounting }),
        };
        let source = match (&keys.source.v4l2, self.origin(keys, takeoff)) {
            (Some(path), _) => self.v4l2(named, path, [camera.width(), camera.height()], *clock)?,
            (_, Some(origin)) => linked(origin.clone(), keys.source.spots)
                .map_err(|error| match &keys.source {
                    SourceKeys { scene: Some(_), .. } => of_key("source.scene", true, error),
                    SourceKeys { recording: Some(_), .. } => of_key("source.recording", true, error),
                    _ => error,
                })?
                .ok_or_else(|| {
                    let (what, advice) = origin.wants();
                    self.refuse(&format!("camera {}", keys.name), &format!("nothing opens {what}"), advice)
                })?,
            _ => self.opener(named, exposure_us, (*clock, takeoff.clone(), start_s)),
        };
        let exposure = self.wanted_exposure().map(|wanted| Exposure::new(wanted).of_camera(camera.clone()));
        let looking = Looking { camera, mask, mounting, course, exposure_us };
        Ok((Camera { name: keys.name.clone(), source, view, exposure }, looking))
    }

    /// Where its frames come from, where others open it.
    fn origin<'a>(&self, keys: &'a CameraKeys, takeoff: &Takeoff) -> Option<Origin<'a>> {
        let SourceKeys { recording, scene, camera, repeat, ros2, zenoh, .. } = &keys.source;
        let recording = recording
            .as_ref()
            .map(|path| Origin::Recording { path: self.located(path), camera: camera.as_deref() });
        let topic = || ros2.as_deref().map(Origin::Ros2).or_else(|| zenoh.as_deref().map(Origin::Zenoh));
        let scene = scene.as_ref().map(|path| Origin::Scene {
            path: self.located(path),
            camera: camera.as_deref(),
            exposure_us: keys.exposure_us,
            takeoff: (self.pace() == Pace::Live).then(|| takeoff.clone()),
            repeat: *repeat,
        });
        recording.or(scene).or_else(topic)
    }

    fn gravity(&self) -> Result<Option<Unit<Vector3<f64>>>> {
        let Some(down) = self.keys.locate.gravity else { return Ok(None) };
        let direction =
            Unit::try_new(Vector3::from(down), 1e-9).filter(|down| down.iter().all(|part| part.is_finite()));
        let advice = "give three numbers, such as [0, 1, 0] for a level camera";
        direction
            .map(Some)
            .ok_or_else(|| self.refuse("locate.gravity", "these numbers have no direction", advice))
    }

    fn opener(
        &self,
        named: &Named<'_>,
        exposure_us: Option<f64>,
        (clock, takeoff, start_s): (HostClock, Takeoff, f64),
    ) -> Opener {
        if let Some((dataset, camera)) = named.recording.clone() {
            let (is_live, repeat) = (self.pace() == Pace::Live, named.keys.source.repeat);
            return Box::new(move || {
                let began = is_live.then(|| before(takeoff.at(), start_s));
                let recorded = Recorded::new(&dataset, camera, began);
                let recorded = if repeat { recorded.repeated(&dataset, camera) } else { recorded };
                Ok(Box::new(recorded) as Box<dyn Source>)
            });
        }
        let source = named.keys.source.clone();
        let carrier = self.carrier(&source);
        let format = match source.raw {
            _ if source.spots => StreamFormat::Spots,
            Some(raw) => StreamFormat::Raw(raw.into()),
            None => StreamFormat::Y4m,
        };
        // Whoever finds spots knows when they were seen.
        let is_arrival = self.pace() == Pace::Live && !source.spots;
        let times =
            match source.times.unwrap_or(if is_arrival { TimesKey::Arrival } else { TimesKey::Stream }) {
                TimesKey::Stream => Times::Stream,
                TimesKey::Arrival => Times::Arrival(clock, 1e-6 * exposure_us.unwrap_or(EXPOSURE_US)),
            };
        Box::new(move || Ok(Box::new(Stream::open(&carrier, format, times)?) as Box<dyn Source>))
    }

    #[cfg(all(feature = "v4l2", target_os = "linux"))]
    fn v4l2(&self, named: &Named<'_>, path: &Path, size: [usize; 2], clock: HostClock) -> Result<Opener> {
        use crate::source::{PixelFormat, V4l2, V4l2Wanted};
        let SourceKeys { format, rate_hz, gain, .. } = &named.keys.source;
        let wanted = V4l2Wanted {
            path: self.located(path),
            size,
            format: format.as_deref().and_then(PixelFormat::of_code),
            rate_hz: *rate_hz,
            exposure_us: named.keys.exposure_us,
            gain: *gain,
        };
        Ok(Box::new(move || Ok(Box::new(V4l2::open(wanted.clone(), clock, EXPOSURE_US)?) as Box<dyn Source>)))
    }

    #[cfg(not(all(feature = "v4l2", target_os = "linux")))]
    fn v4l2(&self, named: &Named<'_>, _path: &Path, _size: [usize; 2], _clock: HostClock) -> Result<Opener> {
        let advice = "build with --features v4l2 on Linux, or take its frames by a `command`";
        Err(self.refuse(
            &format!("camera {}", named.keys.name),
            "V4L2 cameras are not in this program",
            advice,
        ))
    }

    fn carrier(&self, source: &SourceKeys) -> Carrier {
        match source {
            SourceKeys { command: Some(words), .. } => Carrier::Command(words.clone()),
            SourceKeys { tcp: Some(address), .. } => Carrier::Tcp(address.clone()),
            SourceKeys { unix: Some(path), .. } => Carrier::Unix(self.located(path)),
            _ => Carrier::Standard,
        }
    }
}

/// When the clock of the recordings showed 0, whose first frame is due at a moment.
fn before(first: Instant, start_s: f64) -> Instant {
    let start = std::time::Duration::try_from_secs_f64(start_s.max(0.0)).unwrap_or_default();
    first.checked_sub(start).unwrap_or(first)
}

impl LocateKeys {
    fn settings(&self) -> locator::Settings {
        let mut settings = locator::Settings::default();
        settings.spots.brightness = match (self.threshold, self.contrast) {
            (Some(level), _) => Brightness::Threshold(level),
            (None, Some(step)) => Brightness::Contrast(step),
            (None, None) => Brightness::default(),
        };
        let of = |own: Option<f64>, default: f64| own.unwrap_or(default);
        settings.spots.shape.reflection_ratio =
            of(self.reflection_ratio, settings.spots.shape.reflection_ratio);
        settings.max_tilt_rad = of(self.max_tilt_deg.map(f64::to_radians), settings.max_tilt_rad);
        settings.min_probability = of(self.min_probability, settings.min_probability);
        settings.budget = self.budget.unwrap_or(settings.budget);
        let pose = &mut settings.pose;
        pose.tilt_sigma_rad = self.tilt_sigma_deg.unwrap_or(5.0).to_radians();
        pose.marker_sigma_m = of(self.marker_sigma_m, pose.marker_sigma_m);
        pose.unit_sigma = of(self.power_spread, pose.unit_sigma);
        pose.scale_sigma = of(self.scale_sigma, 0.01);
        pose.missed = of(self.miss_rate, 0.02);
        pose.use_brightness = self.brightness.unwrap_or(true);
        settings
    }

    /// What is believed of a kind of vehicle: by the configuration, or else by its file.
    fn kind(&self, AirframeFile { airframe, tolerances, .. }: AirframeFile) -> Kind {
        let all = self.settings().pose;
        Kind {
            airframe,
            marker_sigma_m: self.marker_sigma_m.or(tolerances.position_sigma_m).unwrap_or(all.marker_sigma_m),
            unit_sigma: self.power_spread.or(tolerances.power_sigma).unwrap_or(all.unit_sigma),
        }
    }
}
