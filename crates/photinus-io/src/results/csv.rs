//! Results for a spreadsheet: a row per neighbour.

use std::io::Write;
use std::path::{Path, PathBuf};

use super::FrameRecord;
use super::columns::{Cell, NEIGHBOUR_COLUMNS, neighbour_rows};
use crate::{Error, Result};

/// Writes a row per neighbour under a header with units; a frame without neighbours gives none. What is not known, or
/// not finite, is an empty cell. `spots` and `modes` are counts.
pub struct CsvWriter<W: Write> {
    table: csv::Writer<W>,
    name: PathBuf,
}

impl<W: Write> CsvWriter<W> {
    /// Writes the header to `sink`; `name` is for the messages.
    ///
    /// # Errors
    /// [`Error`] when the sink refuses.
    pub fn new(sink: W, name: impl AsRef<Path>) -> Result<Self> {
        let mut writer = Self { table: csv::Writer::from_writer(sink), name: name.as_ref().to_owned() };
        writer.row(&NEIGHBOUR_COLUMNS.map(|(name, _)| name.to_owned()))?;
        Ok(writer)
    }

    /// Writes the neighbours of a frame and hands them on.
    ///
    /// # Errors
    /// [`Error`] when the sink refuses.
    pub fn write(&mut self, record: &FrameRecord) -> Result<()> {
        neighbour_rows(record).try_for_each(|row| self.row(&row.map(text)))?;
        self.table.flush().map_err(|error| Error::io(&self.name, error))
    }

    fn row(&mut self, cells: &[String]) -> Result<()> {
        self.table.write_record(cells).map_err(|error| match error.into_kind() {
            csv::ErrorKind::Io(error) => Error::io(&self.name, error),
            kind => Error::format(&self.name, format!("{kind:?}")),
        })
    }
}

/// What stands in a cell: nothing, where nothing is known.
fn text(cell: Cell<'_>) -> String {
    match cell {
        Cell::Number(value) => {
            value.filter(|value| value.is_finite()).map_or(String::new(), |value| value.to_string())
        }
        Cell::Count(value) => value.map_or(String::new(), |value| value.to_string()),
        Cell::Text(value) => value.unwrap_or_default().to_owned(),
    }
}
