//! odometry.csv: where the vehicle that carries the cameras believes to be.

use std::path::Path;

use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion, Vector3};

use super::timed::{self, Column};
use crate::{Error, Place, Result, physics, whole};

const COMPONENT: std::ops::RangeInclusive<f64> = -1.01..=1.01;
const COLUMNS: [Column; 12] = [
    ("time_s", physics::TIME_S),
    ("x_m", physics::PLACE_M),
    ("y_m", physics::PLACE_M),
    ("z_m", physics::PLACE_M),
    ("qx", COMPONENT),
    ("qy", COMPONENT),
    ("qz", COMPONENT),
    ("qw", COMPONENT),
    ("vx_m_s", physics::SPEED_M_S),
    ("vy_m_s", physics::SPEED_M_S),
    ("vz_m_s", physics::SPEED_M_S),
    ("velocity_sigma_m_s", 1e-6..=1e5),
];
const POSE: usize = 8;
const WITH_VELOCITY: usize = 11;

/// A line of odometry.csv. The odometry frame has z up; its origin and its heading are the odometry's own, and drift.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OdometryRow {
    /// When it was measured, s.
    pub time_s: f64,
    /// The pose odometry_from_body.
    pub pose: Isometry3<f64>,
    /// Velocity in the odometry frame, m/s.
    pub velocity_m_s: Vector3<f64>,
    /// Standard deviation of its error, per axis, m/s, where that is told.
    pub velocity_sigma_m_s: Option<f64>,
}

/// Reads an odometry.csv. Where it has no velocities, they are the slope of its places.
///
/// # Errors
/// As [`parse_odometry`], and when the file cannot be read.
pub fn read_odometry(path: impl AsRef<Path>) -> Result<Vec<OdometryRow>> {
    parse_odometry(&whole::read_text(path.as_ref())?, path)
}

/// Reads the text of an odometry.csv; `path` is for the messages.
///
/// # Errors
/// [`Error`] with the line for other columns, what is no number, places and speeds that nothing has, a quaternion whose length
/// is more than 1 % from 1, and times that do not grow.
pub fn parse_odometry(text: &str, path: impl AsRef<Path>) -> Result<Vec<OdometryRow>> {
    let path = path.as_ref();
    let row = |(line, row): (usize, [f64; WITH_VELOCITY]), velocity_sigma_m_s: Option<f64>| {
        let [time_s, x, y, z, qx, qy, qz, qw, vx, vy, vz] = row;
        let TimedPose { pose, .. } = pose_of([time_s, x, y, z, qx, qy, qz, qw], path, line)?;
        Ok(OdometryRow { time_s, pose, velocity_m_s: Vector3::new(vx, vy, vz), velocity_sigma_m_s })
    };
    if has(text, WITH_VELOCITY) {
        let rows = timed::rows(text, path, &COLUMNS)?.into_iter();
        return rows
            .map(|(line, [own @ .., sigma]): (usize, [f64; COLUMNS.len()])| row((line, own), Some(sigma)))
            .collect();
    }
    if has(text, POSE) {
        return timed::rows(text, path, first::<WITH_VELOCITY>())?
            .into_iter()
            .map(|own| row(own, None))
            .collect();
    }
    Ok(with_slopes(&parse_poses(text, path)?))
}

/// Where a vehicle was at a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimedPose {
    /// When, s.
    pub time_s: f64,
    /// The pose world_from_body.
    pub pose: Isometry3<f64>,
}

/// Why numbers are no pose at a time.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum PoseError {
    /// No clock tells this time.
    #[error("the time {0:?} s is out of range")]
    Time(f64),
    /// No vehicle is there.
    #[error("the coordinate {0:?} m is out of range")]
    Place(f64),
    /// The quaternion does not turn.
    #[error("the quaternion has length {0}, not 1")]
    Length(f64),
}

impl TimedPose {
    /// A pose at a time: s, m, and the quaternion x, y, z, w of world_from_body.
    ///
    /// # Errors
    /// [`PoseError`] for times and places that nothing has, and for a quaternion whose length is more than 1 % from 1.
    pub fn new(
        time_s: f64,
        [x, y, z]: [f64; 3],
        [qx, qy, qz, qw]: [f64; 4],
    ) -> std::result::Result<Self, PoseError> {
        if !physics::TIME_S.contains(&time_s) {
            return Err(PoseError::Time(time_s));
        }
        if let Some(&place) = [x, y, z].iter().find(|place| !physics::PLACE_M.contains(place)) {
            return Err(PoseError::Place(place));
        }
        let quaternion = Quaternion::new(qw, qx, qy, qz);
        if !physics::is_unit(quaternion.norm()) {
            return Err(PoseError::Length(quaternion.norm()));
        }
        // What is a unit quaternion to the last digits stays as it is written.
        let rotation = match (quaternion.norm() - 1.0).abs() < 1e-12 {
            true => UnitQuaternion::new_unchecked(quaternion),
            false => UnitQuaternion::new_normalize(quaternion),
        };
        Ok(Self { time_s, pose: Isometry3::from_parts(Translation3::new(x, y, z), rotation) })
    }
}

/// Reads a log of poses: an odometry.csv, or the same without velocities.
///
/// # Errors
/// As [`parse_odometry`], and when the file cannot be read.
pub fn read_poses(path: impl AsRef<Path>) -> Result<Vec<TimedPose>> {
    let path = path.as_ref();
    parse_poses(&whole::read_text(path)?, path)
}

/// Reads the text of a log of poses; `path` is for the messages.
///
/// # Errors
/// As [`parse_odometry`].
pub fn parse_poses(text: &str, path: impl AsRef<Path>) -> Result<Vec<TimedPose>> {
    let path = path.as_ref();
    if has(text, POSE) {
        let rows = parse_odometry(text, path)?;
        return Ok(rows.into_iter().map(|row| TimedPose { time_s: row.time_s, pose: row.pose }).collect());
    }
    timed::rows(text, path, first::<POSE>())?
        .into_iter()
        .map(|(line, row)| pose_of(row, path, line))
        .collect()
}

/// Whether a table has the column of this number.
fn has(text: &str, column: usize) -> bool {
    let header = text.lines().find(|line| !line.trim().is_empty());
    header.is_some_and(|names| names.contains(COLUMNS[column].0))
}

/// The first columns, so many.
fn first<const N: usize>() -> &'static [Column; N] {
    const { assert!(N <= COLUMNS.len()) };
    static ALL: [Column; COLUMNS.len()] = COLUMNS;
    ALL.first_chunk().expect("there are more")
}

/// With the velocities that the places before and after each row tell; none where there is but one.
fn with_slopes(poses: &[TimedPose]) -> Vec<OdometryRow> {
    let row = |(place, pose): (usize, &TimedPose)| {
        let (before, after) = (&poses[place.saturating_sub(1)], &poses[(place + 1).min(poses.len() - 1)]);
        let moved_m = after.pose.translation.vector - before.pose.translation.vector;
        let span_s = after.time_s - before.time_s;
        let velocity_m_s = if span_s > 0.0 { moved_m / span_s } else { Vector3::zeros() };
        OdometryRow { time_s: pose.time_s, pose: pose.pose, velocity_m_s, velocity_sigma_m_s: None }
    };
    poses.iter().enumerate().map(row).collect()
}

/// The pose of a line.
fn pose_of([time_s, x, y, z, qx, qy, qz, qw]: [f64; 8], path: &Path, line: usize) -> Result<TimedPose> {
    let pose = TimedPose::new(time_s, [x, y, z], [qx, qy, qz, qw]);
    pose.map_err(|error| {
        Error::format(path, error.to_string()).at(Place::Line(line)).advise("give qx, qy, qz, qw")
    })
}

/// The first line of an odometry.csv, with or without what its velocities are off by.
pub(super) fn header(has_sigma: bool) -> String {
    timed::header(if has_sigma { &COLUMNS } else { first::<WITH_VELOCITY>() })
}

impl OdometryRow {
    /// As a line of the file, without its end; it is read back bit for bit.
    pub fn line(&self) -> String {
        let (p, q, v) = (&self.pose.translation, &self.pose.rotation, &self.velocity_m_s);
        let values = [p.x, p.y, p.z, q.i, q.j, q.k, q.w, v.x, v.y, v.z];
        values
            .iter()
            .chain(&self.velocity_sigma_m_s)
            .fold(self.time_s.to_string(), |line, value| format!("{line},{value}"))
    }
}
