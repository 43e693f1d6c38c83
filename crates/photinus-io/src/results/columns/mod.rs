//! Results column by column, in Arrow's layout: records in, values side by side out, and a bit per row that says whether it is known.

mod neighbours;
mod spots;

use super::FrameRecord;

pub(super) use neighbours::{COLUMNS as NEIGHBOUR_COLUMNS, rows as neighbour_rows};

/// What a column holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Number,
    Count,
    Text,
}

/// The values of a column.
#[derive(Clone, Debug)]
pub enum Cells {
    /// Numbers; NaN where one is not known.
    Number(Vec<f64>),
    /// Counts, and names that are numbers; 0 where one is not known.
    Count(Vec<u64>),
    /// Texts one after the other.
    Text {
        /// Where each begins; the last number is where the last ends.
        offsets: Vec<i32>,
        /// UTF-8.
        bytes: Vec<u8>,
    },
}

/// The value of a cell; `None` is null.
#[derive(Clone, Copy, Debug)]
pub(super) enum Cell<'a> {
    Number(Option<f64>),
    Count(Option<u64>),
    Text(Option<&'a str>),
}

/// A number that is known.
fn number<'a>(value: f64) -> Cell<'a> {
    Cell::Number(Some(value))
}

/// Numbers of a vector, all known or none.
fn numbers<'a, const N: usize>(values: Option<[f64; N]>) -> [Cell<'a>; N] {
    values.map_or([Cell::Number(None); N], |values| values.map(number))
}

/// A count that is known.
fn count<'a>(value: usize) -> Cell<'a> {
    Cell::Count(Some(value as u64))
}

/// A column of a table.
#[derive(Clone, Debug)]
pub struct Column {
    name: &'static str,
    cells: Cells,
    known: Vec<u8>,
    rows: usize,
    nulls: usize,
}

/// A row per neighbour, by the columns of the CSV table.
pub fn neighbour_columns<'a>(records: impl Iterator<Item = &'a FrameRecord>) -> Vec<Column> {
    filled(records.flat_map(neighbours::rows), neighbours::COLUMNS)
}

/// A row per spot; `spot` is its index in its record.
pub fn spot_columns<'a>(records: impl Iterator<Item = &'a FrameRecord>) -> Vec<Column> {
    filled(records.flat_map(spots::rows), spots::COLUMNS)
}

/// Rows of cells as columns.
fn filled<'a, const N: usize>(
    rows: impl Iterator<Item = [Cell<'a>; N]>,
    kinds: [(&'static str, Kind); N],
) -> Vec<Column> {
    let mut columns = kinds.map(|(name, kind)| Column::new(name, kind));
    for row in rows {
        for (column, cell) in columns.iter_mut().zip(row) {
            column.push(cell);
        }
    }
    columns.into()
}

impl Column {
    /// A column without rows.
    fn new(name: &'static str, kind: Kind) -> Self {
        let cells = match kind {
            Kind::Number => Cells::Number(Vec::new()),
            Kind::Count => Cells::Count(Vec::new()),
            Kind::Text => Cells::Text { offsets: vec![0], bytes: Vec::new() },
        };
        Self { name, cells, known: Vec::new(), rows: 0, nulls: 0 }
    }

    /// Adds a row. A number that is not finite is not known, as in the other tables; a cell of another kind is not, either.
    fn push(&mut self, cell: Cell<'_>) {
        let is_known = match (&mut self.cells, cell) {
            (Cells::Number(values), Cell::Number(value)) => {
                let value = value.filter(|value| value.is_finite());
                values.push(value.unwrap_or(f64::NAN));
                value.is_some()
            }
            (Cells::Count(values), Cell::Count(value)) => {
                values.push(value.unwrap_or(0));
                value.is_some()
            }
            (Cells::Text { offsets, bytes }, Cell::Text(value)) => {
                bytes.extend_from_slice(value.unwrap_or_default().as_bytes());
                offsets.push(i32::try_from(bytes.len()).unwrap_or(i32::MAX));
                value.is_some()
            }
            (cells, cell) => unreachable!("{}: {cell:?} among {cells:?}", self.name),
        };
        if self.rows.is_multiple_of(8) {
            self.known.push(0);
        }
        self.known[self.rows / 8] |= u8::from(is_known) << (self.rows % 8);
        self.nulls += usize::from(!is_known);
        self.rows += 1;
    }

    /// Its name, with its unit.
    pub fn name(&self) -> &'static str {
        self.name
    }

    /// How many rows it has.
    pub fn len(&self) -> usize {
        self.rows
    }

    /// Whether it has no rows.
    pub fn is_empty(&self) -> bool {
        self.rows == 0
    }

    /// How many of them are not known.
    pub fn nulls(&self) -> usize {
        self.nulls
    }

    /// Its values.
    pub fn cells(&self) -> &Cells {
        &self.cells
    }

    /// A bit per row, the first one the lowest of the first byte.
    pub fn known(&self) -> &[u8] {
        &self.known
    }

    /// Whether the value of a row is known.
    pub fn is_known(&self, row: usize) -> bool {
        self.known[row / 8] >> (row % 8) & 1 == 1
    }

    /// Whether its text has more bytes than an offset can count.
    pub fn is_too_long(&self) -> bool {
        matches!(&self.cells, Cells::Text { bytes, .. } if i32::try_from(bytes.len()).is_err())
    }
}
