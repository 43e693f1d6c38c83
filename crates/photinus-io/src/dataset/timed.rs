//! Tables of measurements over time: numbers in fixed columns, the first of them a time that grows.

use std::ops::RangeInclusive;
use std::path::Path;

use crate::{Error, Place, Result, physics};

/// A column: its name and what its numbers can be.
pub(super) type Column = (&'static str, RangeInclusive<f64>);

/// The first line of such a table.
pub(super) fn header(columns: &[Column]) -> String {
    columns.iter().map(|column| column.0).collect::<Vec<_>>().join(",")
}

/// The rows of a table, each with its line, counted from 1.
///
/// # Errors
/// [`Error`] with the line for other columns, for what is no number or out of range, for times that do not grow, and for a
/// table without rows.
pub(super) fn rows<const N: usize>(
    text: &str,
    path: &Path,
    columns: &[Column; N],
) -> Result<Vec<(usize, [f64; N])>> {
    let refuse = |line: usize, reason: String, advice: String| {
        Err(Error::format(path, reason).at(Place::Line(line)).advise(advice))
    };
    let mut lines = text.lines().zip(1..).filter(|(line, _)| !line.trim().is_empty());
    let (first, line) = lines.next().unwrap_or(("", 1));
    let names = header(columns);
    if !first.split(',').map(str::trim).eq(columns.iter().map(|column| column.0)) {
        return refuse(
            line,
            format!("the columns are `{}`", first.trim()),
            format!("they must be `{names}`"),
        );
    }
    let mut rows: Vec<(usize, [f64; N])> = Vec::new();
    for (text, line) in lines {
        let mut row = [0.0; N];
        let count = text.split(',').count();
        if count != N {
            return refuse(line, format!("{count} values for {N} columns"), format!("give {names}"));
        }
        for ((value, cell), (name, range)) in row.iter_mut().zip(text.split(',')).zip(columns) {
            *value = match cell.trim().parse() {
                Ok(value) if range.contains(&value) => value,
                Ok(value) if !f64::is_nan(value) => {
                    let reason = format!("{name} {value:?} is out of range");
                    return refuse(line, reason, physics::advice(range));
                }
                _ => {
                    let reason = format!("{name} `{}` is not a number", cell.trim());
                    return refuse(line, reason, "give a number".to_owned());
                }
            };
        }
        if rows.last().is_some_and(|(_, last)| last[0] >= row[0]) {
            let reason = format!("{} s does not come after the line before", row[0]);
            return refuse(line, reason, "list the measurements in order of time".to_owned());
        }
        rows.push((line, row));
    }
    match rows.is_empty() {
        true => Err(Error::format(path, "it holds no measurement").advise("add a line per measurement")),
        false => Ok(rows),
    }
}
