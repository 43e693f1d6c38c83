//! The curve of spot sizes: enters `paper` or a TOML file, leaves how large a spot can be at a distance.
//!
//! ```toml
//! limit_m = 20.0                                                      # optional: farther, no LED makes a spot
//! upper = { offset_px = 1.3398, scale_px_m2 = 31.4704, shift_m = -0.0154 }  # area = offset + scale / (distance + shift)^2
//! lower = { offset_px = 0.9, scale_px_m2 = 12.0, shift_m = 0.0 }      # optional: of an LED that faces the camera
//! ```

use std::path::Path;

use photinus::ranging::{Envelope, SpotCurve, SpotCurveError};
use photinus_io::{Error, Place, Result};
use serde::Deserialize;

const EXAMPLE: &str = "an example: upper = { offset_px = 1.3398, scale_px_m2 = 31.4704, shift_m = -0.0154 }";

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Table {
    upper: EnvelopeTable,
    lower: Option<EnvelopeTable>,
    limit_m: Option<f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct EnvelopeTable {
    offset_px: f64,
    scale_px_m2: f64,
    shift_m: f64,
}

impl From<EnvelopeTable> for Envelope {
    fn from(table: EnvelopeTable) -> Self {
        let EnvelopeTable { offset_px, scale_px_m2, shift_m } = table;
        Self { offset_px, scale_px_m2, shift_m }
    }
}

/// Reads a curve; the word `paper` stands for the paper's, equation (13), 1000 us and threshold 200.
///
/// # Errors
/// [`Error`] with the line for a file that is no curve.
pub(crate) fn read_spot_curve(path: &Path) -> Result<SpotCurve> {
    if path.as_os_str() == "paper" {
        return Ok(SpotCurve::paper_1000_us());
    }
    let text = std::fs::read_to_string(path).map_err(|error| Error::io(path, error))?;
    let table: Table = toml::from_str(&text).map_err(|error| {
        let refused = Error::format(path, error.message().replace('\n', ", ").replace(" field `", " key `"))
            .advise(EXAMPLE);
        match error.span().and_then(|span| text.get(..span.start)) {
            Some(before) => refused.at(Place::Line(1 + before.matches('\n').count())),
            None => refused,
        }
    })?;
    SpotCurve::new(table.upper.into(), table.lower.map(Envelope::from), table.limit_m)
        .map_err(|error| Error::format(path, in_plain_words(&error)).advise(EXAMPLE))
}

fn in_plain_words(error: &SpotCurveError) -> String {
    match error {
        SpotCurveError::Envelope(Envelope { offset_px, scale_px_m2, shift_m }) => format!(
            "an envelope of offset {offset_px} px, scale {scale_px_m2} px m^2 and shift {shift_m} m: \
             the numbers must be finite, the offset 0 or more, the scale above 0"
        ),
        other => other.to_string(),
    }
}
