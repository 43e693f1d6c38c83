//! frames.csv: which image was taken when, and where down was.

use std::path::{Path, PathBuf};
use std::str::FromStr;

use nalgebra::{Unit, Vector3};

use crate::{Error, Place, Result, physics};

pub(super) const COLUMNS: [&str; 6] = ["frame", "time_s", "image", "gx", "gy", "gz"];

/// A line of frames.csv.
#[derive(Clone, Debug, PartialEq)]
pub struct FrameRow {
    /// Number of the frame, growing.
    pub frame: u64,
    /// When it was taken, s, growing.
    pub time_s: f64,
    /// The image, relative to the folder.
    pub image: PathBuf,
    /// Direction of gravity (down) in the camera frame, where known.
    pub gravity: Option<Unit<Vector3<f64>>>,
    /// The line of the file, counted from 1.
    pub line: usize,
}

/// Reads the text of a frames.csv; `path` is for the messages.
///
/// # Errors
/// [`Error`] with the line for other columns, bad numbers, times or frame numbers that do not grow, no rows.
pub fn parse_frames_csv(text: &str, path: impl AsRef<Path>) -> Result<Vec<FrameRow>> {
    let path = path.as_ref();
    let mut lines = text.lines().zip(1..).filter(|(line, _)| !line.trim().is_empty());
    let header = lines.next().map_or("", |(line, _)| line.trim());
    if !values(header).eq(COLUMNS) {
        return Err(Error::format(path, format!("the columns are `{header}`"))
            .at(Place::Line(1))
            .advise(format!("they must be `{}`", COLUMNS.join(","))));
    }
    let mut rows: Vec<FrameRow> = Vec::new();
    for (text, line) in lines {
        let at_line =
            |(reason, advice): Wrong| Error::format(path, reason).at(Place::Line(line)).advise(advice);
        let row = parse_row(text, line).map_err(at_line)?;
        if rows.last().is_some_and(|last| last.frame >= row.frame || last.time_s >= row.time_s) {
            let reason =
                format!("frame {} at {} s does not come after the line before", row.frame, row.time_s);
            return Err(at_line((reason, "list the frames in the order in which they were taken")));
        }
        rows.push(row);
    }
    if rows.is_empty() {
        return Err(Error::format(path, "it lists no frame").advise("add a line per frame"));
    }
    Ok(rows)
}

/// What is wrong, and what to do.
type Wrong = (String, &'static str);

fn values(line: &str) -> impl Iterator<Item = &str> {
    line.split(',').map(str::trim)
}

fn parse_row(text: &str, line: usize) -> std::result::Result<FrameRow, Wrong> {
    let record: Vec<&str> = values(text).collect();
    let [_, _, image, down @ ..] = record.as_slice() else { return Err(wrong_count(&record)) };
    if record.len() != COLUMNS.len() {
        return Err(wrong_count(&record));
    }
    if image.is_empty() {
        return Err(("the image is empty".to_owned(), "name the image file of the frame"));
    }
    let gravity = match down.iter().all(|value| value.is_empty()) {
        true => None,
        false => Some(unit([finite(&record, 3)?, finite(&record, 4)?, finite(&record, 5)?])?),
    };
    Ok(FrameRow { frame: number(&record, 0)?, time_s: time(&record, 1)?, image: image.into(), gravity, line })
}

fn wrong_count(record: &[&str]) -> Wrong {
    let reason = format!("{} values for {} columns", record.len(), COLUMNS.len());
    (reason, "write one value per column, empty where gravity is unknown; names without commas")
}

fn unit(values: [f64; 3]) -> std::result::Result<Unit<Vector3<f64>>, Wrong> {
    let vector = Vector3::from(values);
    let length = vector.norm();
    if !physics::is_unit(length) {
        let advice = "divide an accelerometer's reading by its length; gravity points down";
        return Err((format!("the gravity vector has length {length}, not 1"), advice));
    }
    // What is a unit vector to the last digits stays as it is written.
    let is_unit = (length - 1.0).abs() < 1e-12;
    Ok(if is_unit { Unit::new_unchecked(vector) } else { Unit::new_unchecked(vector / length) })
}

fn time(record: &[&str], column: usize) -> std::result::Result<f64, Wrong> {
    let time_s = finite(record, column)?;
    match physics::TIME_S.contains(&time_s) {
        true => Ok(time_s),
        false => Err((format!("time_s {time_s:?} is out of range"), "give seconds")),
    }
}

fn finite(record: &[&str], column: usize) -> std::result::Result<f64, Wrong> {
    let value: f64 = number(record, column)?;
    match value.is_finite() {
        true => Ok(value),
        false => Err(not_a_number(record, column)),
    }
}

fn number<T: FromStr>(record: &[&str], column: usize) -> std::result::Result<T, Wrong> {
    record[column].parse().map_err(|_| not_a_number(record, column))
}

fn not_a_number(record: &[&str], column: usize) -> Wrong {
    let advice = match COLUMNS[column] {
        "frame" => "give a whole number, 0 or more",
        "time_s" => "give seconds",
        _ => "give a number, or leave gx, gy and gz empty",
    };
    (format!("{} `{}` is not a number", COLUMNS[column], record[column]), advice)
}
