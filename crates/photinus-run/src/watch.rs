//! What frames with times allow: vehicles are followed from one to the next, and named where they blink.
//!
//! In: the dataset's book of words, its vehicles, and how the camera moved. Out: [`Watch`], which completes the record of each frame.

use std::path::{Path, PathBuf};

use nalgebra::{Unit, Vector3};
use photinus::airframe::Airframe;
use photinus::camera::Camera;
use photinus::frame::Mask;
use photinus::identity::CodeBook;
use photinus::locator::{Kind, Located, Settings};
use photinus::lookout::{Fleet, FleetError, Glance, Lookout, LookoutError, Name, Vehicle};
use photinus::tracking::{self, Placed};
use photinus_io::airframe::AirframeFile;
use photinus_io::dataset::{self, Dataset};
use photinus_io::frames::Moved;
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

/// What follows the vehicles that one camera sees.
pub struct Watch {
    /// By kind.
    lookouts: Vec<(Lookout, bool)>,
    airframes: Vec<String>,
    disputes: Disputes,
    exposure_s: f64,
    course: Course,
    last_s: Option<f64>,
    /// Said once of each kind.
    told: Vec<&'static str>,
    contested: Vec<u32>,
    remarks: Vec<String>,
}

impl Watch {
    /// For frames of a camera that are exposed so long.
    ///
    /// # Errors
    /// [`LookoutError`] when a setting has no meaning.
    pub fn new(
        camera: &Camera,
        kinds: &[Kind],
        settings: &Settings,
        mask: Option<&Mask>,
        (fleets, course, exposure_us): (&[Option<Fleet>], Course, Option<f64>),
    ) -> std::result::Result<Self, LookoutError> {
        let lookout = |(number, (kind, fleet)): (usize, (&Kind, &Option<Fleet>))| {
            let followed = tracking::Settings { kind: number, ..Default::default() };
            let settings = Settings { pose: kind.believed(&settings.pose), ..*settings };
            let mut lookout =
                Lookout::new(camera.clone(), &kind.airframe, &settings, followed, fleet.as_ref())?;
            lookout.set_mask(mask.cloned())?;
            Ok((lookout, fleet.is_some()))
        };
        Ok(Self {
            lookouts: kinds
                .iter()
                .zip(fleets)
                .enumerate()
                .map(lookout)
                .collect::<std::result::Result<_, LookoutError>>()?,
            disputes: Disputes::default(),
            airframes: kinds.iter().map(|kind| kind.airframe.name().to_owned()).collect(),
            exposure_s: exposure_us.map_or(EXPOSURE_S, |us| us * 1e-6),
            course,
            last_s: None,
            told: Vec::new(),
            contested: Vec::new(),
            remarks: Vec::new(),
        })
    }

    /// Down in the camera frame in the middle of a frame's exposure, where the vehicle says so.
    pub fn down(&self, entry: &Entry) -> Option<Unit<Vector3<f64>>> {
        let exposure_s = entry.exposure_s.unwrap_or(self.exposure_s);
        self.course.down(entry.record.time_s? + 0.5 * exposure_s)
    }

    /// Completes the record of a frame that was located, if it has a time that comes after the one before.
    pub fn follow(&mut self, entry: &mut Entry, located: &Located) {
        let Some(time_s) = entry.record.time_s else { return };
        // What a recording of a run says goes before: it was told then.
        let Moved { turned, moving } = &mut entry.moved;
        *turned = turned.or_else(|| self.course.turned(self.last_s?, time_s));
        *moving = moving.or_else(|| self.course.moving(time_s));
        let (turned, moving) = (*turned, *moving);
        let exposure_s = entry.exposure_s.unwrap_or(self.exposure_s);
        let glance = Glance { time_s, exposure_s, turned, moving, gravity: entry.gravity, located };
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
        if placed != Placed::Late {
            self.last_s = Some(time_s);
        }
        if placed == Placed::Reset {
            self.remark("reset", || {
                format!("frame {frame}: its time is of another clock, all tracks begin anew")
            });
        }
        self.tell_contested(frame);
    }

    /// What a user should know, since it was asked for last.
    pub fn remarks(&mut self) -> Vec<String> {
        std::mem::take(&mut self.remarks)
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
