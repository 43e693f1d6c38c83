//! A file of times with the direction of gravity, as an autopilot logs it: gives frames theirs.

use std::path::Path;

use nalgebra::{Unit, Vector3};

use super::timed::{self, Column};
use crate::{Error, Place, Result, physics, whole};

const COMPONENT: std::ops::RangeInclusive<f64> = -1.01..=1.01;
const COLUMNS: [Column; 4] =
    [("time_s", physics::TIME_S), ("gx", COMPONENT), ("gy", COMPONENT), ("gz", COMPONENT)];

/// A direction is told this long before the first and after the last measurement, s.
const BEYOND_S: f64 = 0.1;

/// The direction of gravity (down) in the camera frame over time.
#[derive(Clone, Debug, PartialEq)]
pub struct GravityLog(Vec<(f64, Vector3<f64>)>);

impl GravityLog {
    /// Reads such a file.
    ///
    /// # Errors
    /// As [`GravityLog::parse`], and when the file cannot be read.
    pub fn read(path: impl AsRef<Path>) -> Result<Self> {
        Self::parse(&whole::read_text(path.as_ref())?, path)
    }

    /// Reads its text: the columns time_s, gx, gy, gz; `path` is for the messages.
    ///
    /// # Errors
    /// [`Error`] with the line for other columns, what is no number, a vector whose length is more than 1 % from 1, and times
    /// that do not grow.
    pub fn parse(text: &str, path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        let row = |(line, [time_s, x, y, z]): (usize, [f64; 4])| {
            let down = Vector3::new(x, y, z);
            if !physics::is_unit(down.norm()) {
                let reason = format!("the gravity vector has length {}, not 1", down.norm());
                let advice = "divide an accelerometer's reading by its length; gravity points down";
                return Err(Error::format(path, reason).at(Place::Line(line)).advise(advice));
            }
            Ok((time_s, down))
        };
        timed::rows(text, path, &COLUMNS)?.into_iter().map(row).collect::<Result<_>>().map(Self)
    }

    /// When it was measured, s.
    pub fn times_s(&self) -> impl Iterator<Item = f64> {
        self.0.iter().map(|(time_s, _)| *time_s)
    }

    /// The direction at a time, s, between the measurements around it; nothing where there are none.
    pub fn at(&self, time_s: f64) -> Option<Unit<Vector3<f64>>> {
        let (first, last) = (self.0.first()?, self.0.last()?);
        if !(first.0 - BEYOND_S..=last.0 + BEYOND_S).contains(&time_s) {
            return None;
        }
        let after = self.0.partition_point(|(at_s, _)| *at_s < time_s).clamp(1, self.0.len().max(2) - 1);
        let (Some((from_s, from)), to) = (self.0.get(after - 1), self.0.get(after)) else { return None };
        let Some((to_s, to)) = to else { return Unit::try_new(*from, 0.5) };
        let share = ((time_s - from_s) / (to_s - from_s)).clamp(0.0, 1.0);
        Unit::try_new(from * (1.0 - share) + to * share, 0.5)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gravity_is_told_between_measurements_and_not_far_from_them() {
        let log = GravityLog::parse("time_s,gx,gy,gz\n1,0,1,0\n2,1,0,0\n", "g.csv").unwrap();
        assert_eq!(log.at(1.0).unwrap().into_inner(), Vector3::y());
        assert!((log.at(1.5).unwrap().into_inner() - Vector3::new(1.0, 1.0, 0.0).normalize()).norm() < 1e-12);
        assert_eq!(log.at(2.05).unwrap().into_inner(), Vector3::x());
        assert_eq!((log.at(0.8), log.at(2.2)), (None, None));
        let one = GravityLog::parse("time_s,gx,gy,gz\n1,0,0,1\n", "g.csv").unwrap();
        assert_eq!((one.at(1.05).unwrap().into_inner(), one.at(1.2)), (Vector3::z(), None));
        let error = GravityLog::parse("time_s,gx,gy,gz\n1,0,0,0.5\n", "g.csv").unwrap_err().to_string();
        assert!(error.starts_with("g.csv, line 2: the gravity vector has length 0.5"), "{error}");
    }
}
