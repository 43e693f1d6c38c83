//! A recorded flight: a table of poses over time, between whose rows it is interpolated.
//!
//! ```text
//! time_s,x_m,y_m,z_m,qx,qy,qz,qw
//! 0.0,1.0,2.0,3.0,0,0,0,1
//! ```
//! The quaternion is world_from_body. Before the first row and after the last one the robot stands still.

use std::path::Path;

use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion};
use photinus_io::{Error, Place, Result};

/// Poses over time; at least one, times growing.
#[derive(Clone, Debug, PartialEq)]
pub struct Recorded {
    rows: Vec<(f64, Isometry3<f64>)>,
}

const COLUMNS: &str = "time_s,x_m,y_m,z_m,qx,qy,qz,qw";

impl Recorded {
    /// Reads a table of poses.
    ///
    /// # Errors
    /// [`Error`] with the line for other columns, for what is no number, for times that do not grow, for a quaternion whose
    /// length is more than 1 % from 1, and for a table without rows; and when the file cannot be read.
    pub fn read(path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        let text = std::fs::read_to_string(path).map_err(|error| Error::io(path, error))?;
        Self::parse(&text, path)
    }

    /// Reads the text of a table; `path` is for the messages.
    ///
    /// # Errors
    /// As [`Recorded::read`].
    pub fn parse(text: &str, path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        let mut lines = text.lines().zip(1..).filter(|(line, _)| !line.trim().is_empty());
        let header = lines.next().map_or("", |(line, _)| line.trim().trim_start_matches('\u{feff}'));
        if header != COLUMNS {
            return Err(Error::format(path, format!("the columns are `{header}`"))
                .at(Place::Line(1))
                .advise(format!("they must be `{COLUMNS}`")));
        }
        let mut rows: Vec<(f64, Isometry3<f64>)> = Vec::new();
        for (line, number) in lines {
            let refuse = |reason: String| Error::format(path, reason).at(Place::Line(number));
            let row = parse_row(line).map_err(|reason| refuse(reason).advise(format!("give {COLUMNS}")))?;
            if rows.last().is_some_and(|last| last.0 >= row.0) {
                return Err(refuse(format!("{} s is no time after the row before", row.0))
                    .advise("list the poses in order of time"));
            }
            rows.push(row);
        }
        if rows.is_empty() {
            return Err(Error::format(path, "it lists no pose").advise("add a line per pose"));
        }
        Ok(Self { rows })
    }

    /// Poses world_from_body, each held for nine tenths of `period_s`, the first from time 0; `None` without a pose, or for a
    /// period that is not positive.
    pub fn held(poses: impl IntoIterator<Item = Isometry3<f64>>, period_s: f64) -> Option<Self> {
        let hold = |(number, pose): (usize, Isometry3<f64>)| {
            let from_s = number as f64 * period_s;
            [(from_s, pose), (from_s + 0.9 * period_s, pose)]
        };
        let rows: Vec<_> = poses.into_iter().enumerate().flat_map(hold).collect();
        (!rows.is_empty() && period_s.is_finite() && period_s > 0.0).then_some(Self { rows })
    }

    /// The pose world_from_body at a time.
    pub fn pose(&self, time_s: f64) -> Isometry3<f64> {
        let next = self.rows.partition_point(|row| row.0 <= time_s);
        let Some(before) = next.checked_sub(1) else { return self.rows[0].1 };
        let Some(after) = self.rows.get(next) else { return self.rows[before].1 };
        let (from_s, from) = &self.rows[before];
        let share = (time_s - from_s) / (after.0 - from_s);
        let place_m = from.translation.vector.lerp(&after.1.translation.vector, share);
        Isometry3::from_parts(Translation3::from(place_m), from.rotation.nlerp(&after.1.rotation, share))
    }
}

fn parse_row(line: &str) -> std::result::Result<(f64, Isometry3<f64>), String> {
    let values: Vec<f64> = line
        .split(',')
        .map(|word| word.trim().parse().ok().filter(|x: &f64| x.is_finite()).ok_or(word))
        .collect::<std::result::Result<_, _>>()
        .map_err(|word| format!("`{word}` is not a number"))?;
    let [time_s, x, y, z, qx, qy, qz, qw] = values[..] else {
        return Err(format!("{} values for 8 columns", values.len()));
    };
    let quaternion = Quaternion::new(qw, qx, qy, qz);
    if (quaternion.norm() - 1.0).abs() > 0.01 {
        return Err(format!("the quaternion has length {}, not 1", quaternion.norm()));
    }
    Ok((time_s, Isometry3::from_parts(Translation3::new(x, y, z), UnitQuaternion::new_normalize(quaternion))))
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;

    fn parse(rows: &str) -> Result<Recorded> {
        Recorded::parse(&format!("{COLUMNS}\n{rows}"), Path::new("poses.csv"))
    }

    #[test]
    fn poses_are_interpolated_and_held_at_the_ends() {
        let half = core::f64::consts::FRAC_1_SQRT_2;
        let recorded = parse(&format!("1,0,0,2,0,0,0,1\n3,4,0,2,0,0,{half},{half}\n")).unwrap();
        let middle = recorded.pose(2.0);
        assert!((middle.translation.vector - Vector3::new(2.0, 0.0, 2.0)).norm() < 1e-12);
        let ahead = middle * Vector3::x();
        assert!((libm::atan2(ahead.y, ahead.x).to_degrees() - 45.0).abs() < 1e-9);
        assert_eq!(recorded.pose(0.0), recorded.pose(1.0));
        assert_eq!(recorded.pose(9.0), recorded.pose(3.0));
    }

    #[test]
    fn a_bad_table_is_refused_with_its_line() {
        for (rows, message) in [
            ("", "poses.csv: it lists no pose"),
            ("0,1,2,3,0,0,0\n", "poses.csv, line 2: 7 values for 8 columns"),
            ("0,1,2,x,0,0,0,1\n", "poses.csv, line 2: `x` is not a number"),
            ("0,1,2,nan,0,0,0,1\n", "poses.csv, line 2: `nan` is not a number"),
            ("0,1,2,3,0,0,0,2\n", "poses.csv, line 2: the quaternion has length 2"),
            ("1,1,2,3,0,0,0,1\n1,1,2,3,0,0,0,1\n", "poses.csv, line 3: 1 s is no time after"),
        ] {
            let error = parse(rows).unwrap_err().to_string();
            assert!(error.starts_with(message), "{error}");
        }
        let error = Recorded::parse("t,x\n", Path::new("p.csv")).unwrap_err().to_string();
        assert!(error.starts_with("p.csv, line 1: the columns are `t,x`"), "{error}");
    }
}
