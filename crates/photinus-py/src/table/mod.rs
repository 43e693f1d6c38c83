//! Records of many frames -> a table that pandas, Polars, pyarrow and DuckDB take without copying: a row per neighbour or spot.

mod arrow;

use std::sync::Arc;

use photinus_io::results::{Column, FrameRecord, neighbour_columns, spot_columns};
use pyo3::prelude::*;
use pyo3::types::PyCapsule;

use crate::error::SettingError;
use crate::record::Record;

/// A table of columns by the Arrow C data interface: `pandas.DataFrame.from_arrow`, `polars.DataFrame`, `pyarrow.table` and DuckDB take it
/// without copying. What is not known is null.
#[pyclass(frozen, module = "photinus")]
pub(crate) struct Table {
    columns: Arc<[Column]>,
    rows: usize,
}

impl Table {
    /// # Errors
    /// `SettingError` when texts are longer than their 32-bit offsets can count: a table of more is made in parts.
    fn new(columns: Vec<Column>) -> PyResult<Self> {
        if columns.iter().any(Column::is_too_long) {
            return Err(SettingError::new_err(
                "more than 2 GiB of text in a column: make tables of fewer records",
            ));
        }
        let rows = columns.first().map_or(0, Column::len);
        debug_assert!(columns.iter().all(|column| column.len() == rows));
        Ok(Self { columns: columns.into(), rows })
    }
}

#[pymethods]
impl Table {
    /// The names of the columns, with their units.
    #[getter]
    fn column_names(&self) -> Vec<&'static str> {
        self.columns.iter().map(Column::name).collect()
    }

    fn __len__(&self) -> usize {
        self.rows
    }

    /// The table as a stream of one batch, which shares its memory: see the Arrow C stream interface. Types are those of the table,
    /// whatever is asked for.
    #[pyo3(signature = (requested_schema = None))]
    fn __arrow_c_stream__<'py>(
        &self,
        py: Python<'py>,
        requested_schema: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyCapsule>> {
        // The interface lets a producer answer with its own types.
        drop(requested_schema);
        PyCapsule::new_with_value(
            py,
            arrow::Stream::of(self.columns.clone(), self.rows),
            c"arrow_array_stream",
        )
    }

    /// The schema as the Arrow C data interface has it.
    fn __arrow_c_schema__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyCapsule>> {
        PyCapsule::new_with_value(py, arrow::Schema::of(&self.columns), c"arrow_schema")
    }

    fn __repr__(&self) -> String {
        format!("Table({} rows, {} columns)", self.rows, self.columns.len())
    }
}

/// A row per neighbour, by the columns of the CSV table of docs/file-formats.md.
#[pyfunction]
pub(crate) fn neighbours_table(records: Vec<Bound<'_, Record>>) -> PyResult<Table> {
    Table::new(neighbour_columns(told(&records)))
}

/// A row per spot; `spot` is its index in its record.
#[pyfunction]
pub(crate) fn spots_table(records: Vec<Bound<'_, Record>>) -> PyResult<Table> {
    Table::new(spot_columns(told(&records)))
}

fn told<'a>(records: &'a [Bound<'_, Record>]) -> impl Iterator<Item = &'a FrameRecord> {
    records.iter().map(|record| record.get().0.as_ref())
}
