//! What frames with times allow: vehicles are followed from one to the next, and named where they blink.
//!
//! In: the dataset's book of words, its vehicles, and how the cameras moved. Out: [`Watch`], which completes the record of each frame. Cameras on one vehicle
//! share what is followed, whichever thread hands their frames in: one after the other, in whatever order they come.

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use nalgebra::{Unit, Vector3};
use photinus::airframe::Airframe;
use photinus::camera::{Camera, Mounted, Mounting, Rig};
use photinus::frame::Mask;
use photinus::identity::CodeBook;
use photinus::locator::{Kind, Located, Settings};
use photinus::lookout::{Fleet, FleetError, Glance, Lookout, LookoutError, Name, Vehicle};
use photinus::tracking::{self, Placed, Tracker};
use photinus_io::airframe::AirframeFile;
use photinus_io::calibration::MountingFile;
use photinus_io::dataset::{self, Dataset};
use photinus_io::frames::{self, Moved};
use photinus_io::{Error, Result};

use crate::Entry;
use crate::course::Course;
use crate::disputes::Disputes;

/// The exposure of frames of which nobody says it, s.
const EXPOSURE_S: f64 = 1e-3;

/// The vehicles of a dataset that blink, by kind; `None` where nobody of a kind does.
///
/// # Errors
/// [`Error`] when their words or rates make no fleet.
pub fn fleets(
    dataset: Option<&Dataset>,
    kinds: &[Kind],
    mut warn: impl FnMut(String),
) -> Result<Vec<Option<Fleet>>> {
    let nobody = || Ok(kinds.iter().map(|_| None).collect());
    let Some(dataset) = dataset else { return nobody() };
    let Some(book) = dataset.codes() else { return nobody() };
    if dataset.vehicles().is_empty() {
        warn(
            "codes are given, but no vehicles: nobody can be named; list who blinks what in a vehicles.toml"
                .to_owned(),
        );
        return nobody();
    }
    let file = dataset.info().vehicles.as_deref().map(|named| dataset.path(named)).unwrap_or_default();
    fleets_of(book, dataset.vehicles(), &file, kinds, warn)
}

/// Those of `all` that blink words of the book, by kind; `file` is for the messages.
///
/// # Errors
/// [`Error`] when their words or rates make no fleet.
pub fn fleets_of(
    book: &CodeBook,
    all: &[dataset::Vehicle],
    file: &Path,
    kinds: &[Kind],
    mut warn: impl FnMut(String),
) -> Result<Vec<Option<Fleet>>> {
    let mut vehicles = vec![Vec::new(); kinds.len()];
    for vehicle in all {
        let Some(blink) = &vehicle.blink else { continue };
        let Some(kind) = kinds.iter().position(|kind| is_built_like(&vehicle.airframe, &kind.airframe))
        else {
            let file = vehicle.airframe_file.display();
            warn(format!(
                "vehicle {} is not looked for: it is built as {file}, which is none of the airframes given",
                vehicle.id
            ));
            continue;
        };
        vehicles[kind].push((Vehicle { id: vehicle.id, words: blink.words.clone() }, blink.bit_rate_hz));
    }
    let refuse =
        |error: FleetError| Error::format(file, error.to_string()).advise("or locate with --no-time");
    let fleet = |vehicles: Vec<_>| match vehicles.is_empty() {
        true => Ok(None),
        false => Fleet::new(book.clone(), vehicles).map(Some).map_err(refuse),
    };
    vehicles.into_iter().map(fleet).collect()
}

/// The airframes that are told apart: those built alike are one kind.
///
/// # Errors
/// [`Error`] for two kinds of one name: results tell them by it.
pub fn told_apart(files: Vec<(PathBuf, AirframeFile)>) -> Result<Vec<AirframeFile>> {
    let mut kinds: Vec<AirframeFile> = Vec::new();
    for (path, file) in files {
        if kinds.iter().any(|kind| is_built_like(&kind.airframe, &file.airframe)) {
            continue;
        }
        let name = file.airframe.name();
        if kinds.iter().any(|kind| kind.airframe.name() == name) {
            let reason = format!("another kind of airframe is called `{name}`, too");
            return Err(Error::format(path, reason).advise("give each a name of its own: results have them"));
        }
        kinds.push(file);
    }
    Ok(kinds)
}

/// Names of airframes are for people: LEDs count.
fn is_built_like(one: &Airframe, other: &Airframe) -> bool {
    one.leds() == other.leds()
}

/// A camera whose frames are followed, and what is known beside them.
pub struct Looking {
    /// The camera.
    pub camera: Camera,
    /// Where nobody looks in its image.
    pub mask: Option<Mask>,
    /// How it sits on its vehicle, where that is known.
    pub mounting: Option<MountingFile>,
    /// How it moves.
    pub course: Course,
    /// How long its frames are exposed, us, where somebody says it.
    pub exposure_us: Option<f64>,
}

/// What follows the vehicles that a camera sees, or cameras together, as one of these cameras reaches it.
pub struct Watch {
    all: Arc<Mutex<Together>>,
    camera: usize,
    course: Course,
    exposure_s: f64,
}

impl Watch {
    /// For the frames of each of these cameras: those whose places on the vehicle are known are followed together, any other by itself.
    ///
    /// # Errors
    /// [`LookoutError`] when a setting has no meaning.
    pub fn of(
        cameras: Vec<Looking>,
        kinds: &[Kind],
        settings: &Settings,
        fleets: &[Option<Fleet>],
    ) -> std::result::Result<Vec<Self>, LookoutError> {
        let is_placed = |looking: &Looking| looking.mounting.is_some_and(|own| own.position_m.is_some());
        let rig: Vec<&Looking> = cameras.iter().filter(|looking| is_placed(looking)).collect();
        let are_together = (2..=Rig::MOST).contains(&rig.len());
        let all = are_together.then(|| Together::of(&rig, kinds, settings, fleets)).transpose()?;
        let mut numbers = 0..Rig::MOST;
        let watch = |looking: Looking| {
            let together = all.as_ref().filter(|_| is_placed(&looking));
            match together.and_then(|all| Some((all, numbers.next()?))) {
                Some((all, camera)) => {
                    // The tracker of a rig swings its cameras about the vehicle itself.
                    let course = looking.course.of_middle();
                    Ok(Self::with(all.clone(), camera, course, looking.exposure_us))
                }
                None => Self::alone(looking, kinds, settings, fleets),
            }
        };
        cameras.into_iter().map(watch).collect()
    }

    /// For the frames of one camera.
    ///
    /// # Errors
    /// As [`Self::of`].
    pub fn alone(
        looking: Looking,
        kinds: &[Kind],
        settings: &Settings,
        fleets: &[Option<Fleet>],
    ) -> std::result::Result<Self, LookoutError> {
        let all = Together::of(&[&looking], kinds, settings, fleets)?;
        Ok(Self::with(all, 0, looking.course, looking.exposure_us))
    }

    fn with(all: Arc<Mutex<Together>>, camera: usize, course: Course, exposure_us: Option<f64>) -> Self {
        Self { all, camera, course, exposure_s: exposure_us.map_or(EXPOSURE_S, |us| us * 1e-6) }
    }

    /// Down in the camera frame in the middle of a frame's exposure, where the vehicle says so.
    pub fn down(&self, entry: &Entry) -> Option<Unit<Vector3<f64>>> {
        self.course.down(entry.record.time_s? + 0.5 * entry.exposure_s.unwrap_or(self.exposure_s))
    }

    /// Completes the record of a frame that was located, if it has a time that comes after the one before.
    pub fn follow(&self, entry: &mut Entry, located: &Located) {
        self.all().follow(self, entry, located);
    }

    /// What a user should know, since it was asked for last.
    pub fn remarks(&self) -> Vec<String> {
        std::mem::take(&mut self.all().remarks)
    }

    fn all(&self) -> MutexGuard<'_, Together> {
        // A frame on which the method panics is an error of that frame; the next ones are followed all the same.
        self.all.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// What follows the vehicles that cameras see together.
struct Together {
    /// When the last frame of each camera was, s.
    last_s: Vec<Option<f64>>,
    /// By kind.
    lookouts: Vec<(Lookout, bool)>,
    airframes: Vec<String>,
    disputes: Disputes,
    /// How many frames were handed in.
    order: u64,
    /// Times of the last ones that were taken in, ascending, s.
    taken_s: Vec<f64>,
    /// Said once of each kind.
    told: Vec<&'static str>,
    contested: Vec<u32>,
    remarks: Vec<String>,
}

impl Together {
    fn of(
        cameras: &[&Looking],
        kinds: &[Kind],
        settings: &Settings,
        fleets: &[Option<Fleet>],
    ) -> std::result::Result<Arc<Mutex<Self>>, LookoutError> {
        let is_rig = cameras.len() > 1;
        let mounted = |looking: &&Looking| Mounted {
            camera: looking.camera.clone(),
            mask: looking.mask.clone(),
            mounting: looking.mounting.filter(|_| is_rig).map(Mounting::from).unwrap_or_default(),
        };
        let rig = Rig::new(cameras.iter().map(mounted).collect())?;
        let lookout = |(number, (kind, fleet)): (usize, (&Kind, &Option<Fleet>))| {
            let mut followed = tracking::Settings::default();
            followed.kind = number;
            let mut settings = *settings;
            settings.pose = kind.believed(&settings.pose);
            let lookout = Lookout::new(rig.clone(), &kind.airframe, &settings, followed, fleet.as_ref())?;
            Ok((lookout, fleet.is_some()))
        };
        let lookouts = kinds.iter().zip(fleets).enumerate().map(lookout);
        let lookouts = lookouts.collect::<std::result::Result<_, LookoutError>>()?;
        Ok(Arc::new(Mutex::new(Self {
            last_s: vec![None; cameras.len()],
            lookouts,
            airframes: kinds.iter().map(|kind| kind.airframe.name().to_owned()).collect(),
            disputes: Disputes::default(),
            order: 0,
            taken_s: Vec::new(),
            told: Vec::new(),
            contested: Vec::new(),
            remarks: Vec::new(),
        })))
    }

    fn follow(&mut self, watch: &Watch, entry: &mut Entry, located: &Located) {
        let (Some(time_s), camera) = (entry.record.time_s, watch.camera) else { return };
        self.complete(watch, entry, time_s);
        let Moved { turned, moving, together } = entry.moved;
        let turned_since_any = together.and_then(|together| together.turned);
        let exposure_s = entry.exposure_s.unwrap_or(watch.exposure_s);
        let gravity = entry.gravity;
        let glance =
            Glance { camera, time_s, exposure_s, turned, turned_since_any, moving, gravity, located };
        let frame = entry.record.frame.unwrap_or_default();
        let mut placed = Placed::Newest;
        for kind in 0..self.lookouts.len() {
            let (lookout, has_names) = &mut self.lookouts[kind];
            if let Err(error) = lookout.look(&glance) {
                self.remark("refused", || format!("frame {frame} tells nothing of tracks: {error}"));
                return;
            }
            let (tracked, names) = (lookout.tracked(), has_names.then(|| lookout.names()));
            entry.record.add_tracked(tracked, names, kind, &self.airframes);
            placed = tracked.placed;
        }
        self.disputes.settle(&mut entry.record.tracks);
        entry.record.name_neighbours();
        self.took(camera, time_s, placed);
        if placed == Placed::Reset {
            self.remark("reset", || {
                format!("frame {frame}: its time is of another clock, all tracks begin anew")
            });
        }
        self.tell_contested(frame);
    }

    /// Adds how the camera moved. What a recording of a run says goes before: it was told then.
    fn complete(&mut self, watch: &Watch, entry: &mut Entry, time_s: f64) {
        let Moved { turned, moving, together } = &mut entry.moved;
        *turned = turned.or_else(|| watch.course.turned(self.last_s[watch.camera]?, time_s));
        *moving = moving.or_else(|| watch.course.moving(time_s));
        if self.last_s.len() == 1 {
            *together = None;
            return;
        }
        // After a frame that a recording lost, its turns are since another frame than the one that is known.
        let recorded = together.filter(|recorded| recorded.order == self.order);
        self.order = together.map_or(self.order, |recorded| recorded.order);
        let place = self.taken_s.partition_point(|taken_s| *taken_s <= time_s);
        let before_s = place.checked_sub(1).map(|before| self.taken_s[before]);
        let turned = match recorded {
            Some(recorded) => recorded.turned,
            None => before_s.and_then(|before_s| watch.course.turned(before_s, time_s)),
        };
        *together = Some(frames::Together { order: self.order, turned });
        self.order += 1;
    }

    /// Remembers when frames were taken that others may come before or after.
    fn took(&mut self, camera: usize, time_s: f64, placed: Placed) {
        if placed == Placed::Reset {
            self.taken_s.clear();
            self.last_s.fill(None);
        }
        let last_s = &mut self.last_s[camera];
        *last_s = Some(last_s.map_or(time_s, |last_s| last_s.max(time_s)));
        self.taken_s.insert(self.taken_s.partition_point(|taken_s| *taken_s <= time_s), time_s);
        let oldest_s = self.taken_s.last().map_or(time_s, |newest_s| newest_s - 2.0 * Tracker::MOST_LATE_S);
        // One before all that may still come.
        let old = self.taken_s.partition_point(|taken_s| *taken_s < oldest_s).saturating_sub(1);
        self.taken_s.drain(..old);
    }

    fn remark(&mut self, kind: &'static str, text: impl FnOnce() -> String) {
        if !self.told.contains(&kind) {
            self.told.push(kind);
            self.remarks.push(format!("{} (said once)", text()));
        }
    }

    /// Two that blink the words of one.
    fn tell_contested(&mut self, frame: u64) {
        let is_new = |name: &&Name| name.is_contested && !self.contested.contains(&name.id);
        let mut names = self.lookouts.iter().flat_map(|(lookout, _)| lookout.names());
        let Some(name) = names.find(is_new) else { return };
        let id = name.id;
        self.contested.push(id);
        self.remarks.push(format!("frame {frame}: two tracks blink the words of vehicle {id}; none of them has its id meanwhile (said once)"));
    }
}
