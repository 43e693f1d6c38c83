//! Results as Parquet: a file of JSON lines in, a row per neighbour out by the columns of the CSV table, for DuckDB, Polars, pandas and Spark.

use std::io::Write;
use std::path::Path;
use std::sync::Arc;

use parquet::basic::Compression;
use parquet::data_type::{ByteArray, ByteArrayType, DoubleType, Int64Type};
use parquet::errors::{ParquetError, Result as ParquetResult};
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedColumnWriter, SerializedFileWriter};
use parquet::schema::parser::parse_message_type;
use photinus_io::results::{Cells, Column, FrameRecord, neighbour_columns, read_results};
use photinus_io::whole::{Existing, WholeFile};
use photinus_io::{Error, Result};

/// Frames whose neighbours are a group of rows: some MB.
const GROUP_FRAMES: usize = 4096;

/// Makes the table of results that are whole, in place of one that is there. The same results give the same bytes.
///
/// # Errors
/// [`Error`] when results are no results, or the table cannot be written.
pub(super) fn tabulate(results: &Path, path: &Path) -> Result<()> {
    let refused = |error: ParquetError| {
        Error::format(path, error.to_string()).advise("free some space, or write elsewhere")
    };
    let mut records = read_results(results)?;
    let mut table =
        begin(WholeFile::create(path, Existing::Replace)?, &neighbour_columns([].iter())).map_err(refused)?;
    loop {
        let group = records.by_ref().take(GROUP_FRAMES).collect::<Result<Vec<FrameRecord>>>()?;
        if group.is_empty() {
            return table.into_inner().map_err(refused)?.keep();
        }
        let columns = neighbour_columns(group.iter());
        if columns.iter().any(|column| !column.is_empty()) {
            write(&mut table, &columns).map_err(refused)?;
        }
    }
}

fn begin<W: Write + Send>(sink: W, columns: &[Column]) -> ParquetResult<SerializedFileWriter<W>> {
    let fields: Vec<String> = columns.iter().map(field).collect();
    let schema = parse_message_type(&format!("message neighbours {{ {} }}", fields.join(" ")))?;
    let properties = WriterProperties::builder()
        .set_compression(Compression::SNAPPY)
        .set_created_by(concat!("photinus ", env!("CARGO_PKG_VERSION")).to_owned())
        .build();
    SerializedFileWriter::new(sink, Arc::new(schema), Arc::new(properties))
}

fn field(column: &Column) -> String {
    let name = column.name();
    match column.cells() {
        Cells::Number(_) => format!("optional double {name};"),
        Cells::Count(_) => format!("optional int64 {name} (INTEGER(64,false));"),
        Cells::Text { .. } => format!("optional binary {name} (UTF8);"),
    }
}

/// Writes a group of rows.
fn write<W: Write + Send>(table: &mut SerializedFileWriter<W>, columns: &[Column]) -> ParquetResult<()> {
    let mut group = table.next_row_group()?;
    for column in columns {
        let Some(mut place) = group.next_column()? else { break };
        put(column, &mut place)?;
        place.close()?;
    }
    group.close().map(drop)
}

/// Writes the values that are known, and which rows they are of.
fn put(column: &Column, place: &mut SerializedColumnWriter<'_>) -> ParquetResult<usize> {
    let levels: Vec<i16> = (0..column.len()).map(|row| i16::from(column.is_known(row))).collect();
    let known = (0..column.len()).filter(|&row| column.is_known(row));
    match column.cells() {
        Cells::Number(values) => {
            let values: Vec<f64> = known.map(|row| values[row]).collect();
            place.typed::<DoubleType>().write_batch(&values, Some(&levels), None)
        }
        Cells::Count(values) => {
            // Parquet has unsigned numbers as their bits.
            let values: Vec<i64> = known.map(|row| values[row].cast_signed()).collect();
            place.typed::<Int64Type>().write_batch(&values, Some(&levels), None)
        }
        Cells::Text { offsets, bytes } => {
            let text = |row: usize| &bytes[offsets[row] as usize..offsets[row + 1] as usize];
            let values: Vec<ByteArray> = known.map(|row| ByteArray::from(text(row).to_vec())).collect();
            place.typed::<ByteArrayType>().write_batch(&values, Some(&levels), None)
        }
    }
}
