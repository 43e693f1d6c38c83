//! Results: enters what was located in each frame, leaves a line of JSON per frame, or a table: for a spreadsheet, for programs
//! that read Arrow or Parquet.
//!
//! The same reader takes results back and takes spots found by another program in place of frames: a spot needs only
//! its place, see [`SpotRecord`].

mod body;
mod columns;
mod csv;
mod found;
mod json;
mod record;
mod spot;

pub use columns::{Cells, Column, neighbour_columns, spot_columns};
pub use csv::CsvWriter;
pub use json::{ResultsReader, ResultsWriter, read_results};
pub use record::{
    Distance, FrameRecord, IdRecord, Misfit, Mode, NeighbourRecord, RejectedRecord, RunnerUp, TrackRecord,
};
pub use spot::{DEFAULT_SIGMA_PX, SpotRecord};

#[cfg(test)]
mod tests;
