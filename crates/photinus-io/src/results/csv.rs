//! Results for a spreadsheet: a row per neighbour.

use std::io::Write;
use std::path::{Path, PathBuf};

use super::{FrameRecord, NeighbourRecord};
use crate::{Error, Result};

#[rustfmt::skip]
const COLUMNS: [&str; 36] = [
    "frame", "time_s", "source", "track", "id", "airframe", "spots", "bearing_x", "bearing_y", "bearing_z",
    "distance_m", "distance_sigma_m", "distance_min_m", "distance_max_m", "perpendicular_m", "inline_m",
    "x_m", "y_m", "z_m", "var_xx_m2", "var_xy_m2", "var_xz_m2", "var_yy_m2", "var_yz_m2", "var_zz_m2",
    "qx", "qy", "qz", "qw", "modes", "camera", "x_body_m", "y_body_m", "z_body_m",
    "probability", "misfit_p",
];

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
        writer.row(&COLUMNS.map(str::to_owned))?;
        Ok(writer)
    }

    /// Writes the neighbours of a frame and hands them on.
    ///
    /// # Errors
    /// [`Error`] when the sink refuses.
    pub fn write(&mut self, record: &FrameRecord) -> Result<()> {
        for neighbour in &record.neighbours {
            self.row(&cells(record, neighbour))?;
        }
        self.table.flush().map_err(|error| Error::io(&self.name, error))
    }

    fn row(&mut self, cells: &[String]) -> Result<()> {
        self.table.write_record(cells).map_err(|error| match error.into_kind() {
            csv::ErrorKind::Io(error) => Error::io(&self.name, error),
            kind => Error::format(&self.name, format!("{kind:?}")),
        })
    }
}

#[rustfmt::skip]
fn cells(record: &FrameRecord, neighbour: &NeighbourRecord) -> [String; COLUMNS.len()] {
    let n = neighbour;
    let [bx, by, bz] = n.bearing.map(number);
    let [x, y, z] = n.position_m.unwrap_or([f64::NAN; 3]).map(number);
    let [[xx, xy, xz], [_, yy, yz], [_, _, zz]] =
        n.position_covariance_m2.unwrap_or([[f64::NAN; 3]; 3]).map(|row| row.map(number));
    let [xb, yb, zb] = n.position_body_m.unwrap_or([f64::NAN; 3]).map(number);
    let [qx, qy, qz, qw] = n.orientation_xyzw.unwrap_or([f64::NAN; 4]).map(number);
    let d = &n.distance_m;
    [
        text(record.frame), known(record.time_s), record.source.clone(), text(n.track), text(n.id),
        n.airframe.clone(), n.spots.len().to_string(), bx, by, bz,
        known(d.estimate), known(d.sigma), number(d.min), known(d.max), known(d.perpendicular), known(d.inline),
        x, y, z, xx, xy, xz, yy, yz, zz, qx, qy, qz, qw, n.modes.len().to_string(),
        text(record.camera.as_deref()), xb, yb, zb,
        known(n.probability), known(n.misfit.map(|misfit| misfit.p)),
    ]
}

fn number(value: f64) -> String {
    if value.is_finite() { value.to_string() } else { String::new() }
}

fn known(value: Option<f64>) -> String {
    value.map(number).unwrap_or_default()
}

fn text(value: Option<impl ToString>) -> String {
    value.map(|value| value.to_string()).unwrap_or_default()
}
