//! What frames with times allow: vehicles are followed from one to the next, and named where they blink.
//!
//! In: the dataset's book of words, its vehicles, its gyro or odometry. Out: [`Watch`], which completes the record of each frame.

use std::path::{Path, PathBuf};

use nalgebra::{Rotation3, Unit, UnitQuaternion, Vector3};
use photinus::airframe::Airframe;
use photinus::camera::Camera;
use photinus::frame::Mask;
use photinus::identity::CodeBook;
use photinus::locator::{Kind, Located, Settings};
use photinus::lookout::{Fleet, FleetError, Glance, Lookout, LookoutError, Name, Vehicle};
use photinus::tracking::{self, Placed, Turned};
use photinus_io::airframe::AirframeFile;
use photinus_io::calibration::MountingFile;
use photinus_io::dataset::{self, Dataset, OdometryRow};
use photinus_io::{Error, Result};

use crate::Entry;
use crate::disputes::Disputes;
use crate::motion::Motion;

/// The exposure of frames of which nobody says it, s.
const EXPOSURE_S: f64 = 1e-3;
/// What an odometry's attitude is off by from frame to frame, rad per axis.
const ODOMETRY_SIGMA_RAD: f64 = 3e-3;
/// Attitudes of an odometry that are this far apart, s, say nothing of what is between.
const LONGEST_GAP_S: f64 = 0.25;

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
    turns: Turns,
    last_s: Option<f64>,
    /// Said once of each kind.
    told: Vec<&'static str>,
    contested: Vec<u32>,
    remarks: Vec<String>,
}

/// What tells how a camera turned.
pub enum Turns {
    /// Nothing does.
    Unknown,
    /// Rates in the camera's own frame.
    Gyro(Vec<(f64, Vector3<f64>)>),
    /// Attitudes odometry_from_camera.
    Attitudes(Vec<(f64, UnitQuaternion<f64>)>),
    /// Rates in the camera's own frame and attitudes world_from_camera, world with z up, of a recording.
    Recorded {
        /// Goes before attitudes.
        rates: Vec<(f64, Vector3<f64>)>,
        /// Says where down is, too.
        attitudes: Vec<(f64, UnitQuaternion<f64>)>,
    },
    /// What arrives while frames do, of the body that the camera sits on.
    Live {
        /// What the vehicle says of its motion.
        motion: Motion,
        /// How the camera sits on it.
        body_from_camera: UnitQuaternion<f64>,
    },
}

impl Turns {
    /// What a dataset says of a camera that is mounted so: its gyro, or else its odometry. A dataset without mountings has its gyro in the camera's frame.
    ///
    /// # Errors
    /// As [`Dataset::imu`] and [`Dataset::odometry`].
    pub fn of(dataset: &Dataset, is_rig: bool, mounting: Option<&MountingFile>) -> Result<Self> {
        let body_from_camera = mounting.map(|mounting| mounting.body_from_camera);
        if let Some(rows) = dataset.imu()? {
            let camera_from_part = match (is_rig, body_from_camera) {
                (true, Some(body_from_camera)) => body_from_camera.inverse(),
                (true, None) => return Ok(Self::Unknown),
                (false, _) => UnitQuaternion::identity(),
            };
            let rate = |row: &photinus_io::dataset::ImuRow| (row.time_s, camera_from_part * row.turn_rad_s);
            return Ok(Self::Gyro(rows.iter().map(rate).collect()));
        }
        let (Some(rows), Some(body_from_camera)) = (dataset.odometry()?, body_from_camera) else {
            return Ok(Self::Unknown);
        };
        let attitude = |row: &OdometryRow| (row.time_s, row.pose.rotation * body_from_camera);
        Ok(Self::Attitudes(rows.iter().map(attitude).collect()))
    }

    /// How the camera turned between two times.
    fn between(&self, from_s: f64, to_s: f64) -> Option<Turned> {
        match self {
            Self::Unknown => None,
            Self::Gyro(rates) => tracking::turned(rates, from_s, to_s),
            Self::Attitudes(attitudes) => turned_by(attitudes, from_s, to_s),
            Self::Recorded { rates, attitudes } => {
                tracking::turned(rates, from_s, to_s).or_else(|| turned_by(attitudes, from_s, to_s))
            }
            Self::Live { motion, body_from_camera } => {
                let camera_from_body = body_from_camera.inverse();
                let rate = |(time_s, rate): (f64, Vector3<f64>)| (time_s, camera_from_body * rate);
                let rates: Vec<_> = motion.rates().into_iter().map(rate).collect();
                let turned = tracking::turned(&rates, from_s, to_s);
                turned.or_else(|| turned_by(&attitudes_of(motion, body_from_camera), from_s, to_s))
            }
        }
    }

    /// Down in the camera frame at a time, where attitudes are known against the world.
    fn down(&self, time_s: f64) -> Option<Unit<Vector3<f64>>> {
        let world_from_camera = match self {
            Self::Live { motion, body_from_camera } => {
                attitude_at(&attitudes_of(motion, body_from_camera), time_s)
            }
            Self::Recorded { attitudes, .. } => attitude_at(attitudes, time_s),
            Self::Unknown | Self::Gyro(_) | Self::Attitudes(_) => None,
        }?;
        Some(world_from_camera.inverse() * -Vector3::z_axis())
    }
}

fn attitudes_of(motion: &Motion, body_from_camera: &UnitQuaternion<f64>) -> Vec<(f64, UnitQuaternion<f64>)> {
    motion.attitudes().into_iter().map(|(time_s, attitude)| (time_s, attitude * body_from_camera)).collect()
}

/// How a camera with these attitudes turned between two times.
fn turned_by(attitudes: &[(f64, UnitQuaternion<f64>)], from_s: f64, to_s: f64) -> Option<Turned> {
    let [before, now] = [attitude_at(attitudes, from_s)?, attitude_at(attitudes, to_s)?];
    let now_from_before: Rotation3<f64> = (now.inverse() * before).to_rotation_matrix();
    Some(Turned { now_from_before, sigma_rad: ODOMETRY_SIGMA_RAD })
}

/// The attitude at a time, turned evenly between those before and after it.
fn attitude_at(attitudes: &[(f64, UnitQuaternion<f64>)], time_s: f64) -> Option<UnitQuaternion<f64>> {
    let after = attitudes.partition_point(|attitude| attitude.0 < time_s);
    let (end_s, end) = *attitudes.get(after)?;
    if end_s <= time_s {
        return Some(end);
    }
    let (begin_s, begin) = *attitudes.get(after.checked_sub(1)?)?;
    let share = (time_s - begin_s) / (end_s - begin_s);
    let turn = (begin.inverse() * end).scaled_axis() * share;
    (end_s - begin_s <= LONGEST_GAP_S).then(|| begin * UnitQuaternion::from_scaled_axis(turn))
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
        (fleets, turns, exposure_us): (&[Option<Fleet>], Turns, Option<f64>),
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
            turns,
            last_s: None,
            told: Vec::new(),
            contested: Vec::new(),
            remarks: Vec::new(),
        })
    }

    /// Down in the camera frame in the middle of a frame's exposure, where the vehicle says so.
    pub fn down(&self, entry: &Entry) -> Option<Unit<Vector3<f64>>> {
        let exposure_s = entry.exposure_s.unwrap_or(self.exposure_s);
        self.turns.down(entry.record.time_s? + 0.5 * exposure_s)
    }

    /// Completes the record of a frame that was located, if it has a time that comes after the one before.
    pub fn follow(&mut self, entry: &mut Entry, located: &Located) {
        let Some(time_s) = entry.record.time_s else { return };
        let turned = self.last_s.and_then(|last_s| self.turns.between(last_s, time_s));
        let exposure_s = entry.exposure_s.unwrap_or(self.exposure_s);
        let glance = Glance { time_s, exposure_s, turned, gravity: entry.gravity, located };
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_recording_says_where_down_is_and_how_the_camera_turned_by_rates_or_else_by_attitudes() {
        // It turns at 1 rad/s about its x axis, from level (z up) on.
        let at = |time_s: f64| (time_s, UnitQuaternion::from_euler_angles(time_s, 0.0, 0.0));
        let attitudes: Vec<_> = (0..=10).map(|step| at(0.1 * f64::from(step))).collect();
        let of = |rates| Turns::Recorded { rates, attitudes: attitudes.clone() };
        // Between two attitudes it turns evenly.
        let down = of(Vec::new()).down(0.55).unwrap();
        assert!((down.into_inner() - Vector3::new(0.0, -libm::sin(0.55), -libm::cos(0.55))).norm() < 1e-9);
        assert!(of(Vec::new()).down(1.5).is_none() && of(Vec::new()).down(-0.1).is_none());
        let turned = of(Vec::new()).between(0.2, 0.25).unwrap().now_from_before;
        assert!((turned.scaled_axis() + Vector3::x() * 0.05).norm() < 1e-9, "{turned}");
        let rates: Vec<_> =
            (0..=100).map(|step| (0.01 * f64::from(step), Vector3::new(2.0, 0.0, 0.0))).collect();
        let turned = of(rates).between(0.2, 0.25).unwrap().now_from_before;
        assert!((turned.scaled_axis() + Vector3::x() * 0.1).norm() < 1e-9, "rates go before: {turned}");
    }
}
