//! A table with named columns.

use std::path::Path;
use std::str::FromStr;

use crate::{Error, Place, Result};

/// A row, its cells in the order of the columns that were asked for.
pub(super) struct Row<'a> {
    path: &'a Path,
    names: &'a [&'a str],
    /// The line of the file, counted from 1.
    pub(super) line: usize,
    /// `None` where the table has no such column.
    cells: Vec<Option<&'a str>>,
}

/// Reads the rows of a table whose columns are all of `needed` and any of `names`.
///
/// # Errors
/// [`Error`] with the line for columns that are missing, unknown or named twice, for rows of another length, and for a
/// table without rows.
pub(super) fn rows<'a>(
    text: &'a str,
    path: &'a Path,
    names: &'a [&'a str],
    needed: &[&str],
) -> Result<Vec<Row<'a>>> {
    let says_something = |line: &&str| !line.trim().is_empty() && !line.trim_start().starts_with('#');
    let mut lines = text.lines().zip(1..).filter(|(line, _)| says_something(line));
    let (header, header_line) = lines.next().unwrap_or(("", 1));
    let given: Vec<&str> = header.split(',').map(str::trim).collect();
    let refuse_header = |reason: String| {
        let columns = names
            .iter()
            .map(|name| if needed.contains(name) { (*name).to_owned() } else { format!("[{name}]") });
        let advice =
            format!("name the columns in the first line: {}", columns.collect::<Vec<_>>().join(", "));
        Err(Error::format(path, reason).at(Place::Line(header_line)).advise(advice))
    };
    if let Some(unknown) = given.iter().find(|name| !names.contains(name)) {
        return refuse_header(format!("unknown column `{unknown}`"));
    }
    if let Some(missing) = needed.iter().find(|name| !given.contains(name)) {
        return refuse_header(format!("there is no column `{missing}`"));
    }
    if let Some(twice) = names.iter().find(|name| given.iter().filter(|given| given == name).count() > 1) {
        return refuse_header(format!("there are two columns `{twice}`"));
    }
    let places: Vec<Option<usize>> = names.iter().map(|name| given.iter().position(|g| g == name)).collect();
    let rows: Vec<Row<'a>> = lines
        .map(|(text, line)| {
            let cells: Vec<&str> = text.split(',').map(str::trim).collect();
            if cells.len() != given.len() {
                let reason = format!("{} values for {} columns", cells.len(), given.len());
                return Err(Error::format(path, reason)
                    .at(Place::Line(line))
                    .advise("write one value per column"));
            }
            let cells = places.iter().map(|place| place.map(|place| cells[place])).collect();
            Ok(Row { path, names, line, cells })
        })
        .collect::<Result<_>>()?;
    match rows.is_empty() {
        true => Err(Error::format(path, "it holds no measurement").advise("add a line per measurement")),
        false => Ok(rows),
    }
}

impl<'a> Row<'a> {
    /// The cell of a column; empty where the table has no such column.
    pub(super) fn cell(&self, name: &str) -> &'a str {
        let column = self.names.iter().position(|known| *known == name);
        column.and_then(|column| self.cells[column]).unwrap_or("")
    }

    /// A whole number.
    pub(super) fn whole<T: FromStr>(&self, name: &str) -> Result<T> {
        self.cell(name).parse().map_err(|_| self.no_number(name, "give a whole number, 0 or more"))
    }

    /// A finite number.
    pub(super) fn number(&self, name: &str) -> Result<f64> {
        let number: Option<f64> = self.cell(name).parse().ok().filter(|number: &f64| number.is_finite());
        number.ok_or_else(|| self.no_number(name, "give a number"))
    }

    /// A number above 0.
    pub(super) fn positive(&self, name: &str) -> Result<f64> {
        match self.number(name)? {
            number if number > 0.0 => Ok(number),
            _ => Err(self.no_number(name, "give a number above 0")),
        }
    }

    /// A number above 0, or nothing where the cell is empty.
    pub(super) fn optional(&self, name: &str) -> Result<Option<f64>> {
        match self.cell(name).is_empty() {
            true => Ok(None),
            false => self.positive(name).map(Some),
        }
    }

    /// What is wrong with this row.
    pub(super) fn refuse(&self, reason: impl Into<String>, advice: &str) -> Error {
        Error::format(self.path, reason).at(Place::Line(self.line)).advise(advice)
    }

    fn no_number(&self, name: &str, advice: &str) -> Error {
        self.refuse(format!("{name} is `{}`", self.cell(name)), advice)
    }
}
