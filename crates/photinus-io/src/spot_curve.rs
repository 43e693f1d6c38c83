//! The curve of spot sizes: enters a TOML file, leaves how large a spot can be at a distance, and for which exposure and
//! threshold that was measured.

use std::path::Path;

use photinus::ranging::{Envelope, SpotCurve, SpotCurveError};
use serde::{Deserialize, Serialize};

use crate::kind::Kind;
use crate::{Error, Place, Result, table, whole};

const EXAMPLE: &str = "an example: upper = { offset_px = 1.3398, scale_px_m2 = 31.4704, shift_m = -0.0154 }";

/// A curve and what it holds for: another exposure or threshold makes spots of other sizes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpotCurveFile {
    /// The curve.
    pub curve: SpotCurve,
    /// The exposure that it was measured with, us, where the file says so.
    pub exposure_us: Option<f64>,
    /// The fixed grey level from which on a pixel counted, where the file says so.
    pub threshold: Option<u8>,
}

impl SpotCurveFile {
    /// The paper's curve, equation (13), with the exposure and the threshold that it states.
    pub fn paper_1000_us() -> Self {
        Self { curve: SpotCurve::paper_1000_us(), exposure_us: Some(1000.0), threshold: Some(200) }
    }
}

/// Values stand before tables, as TOML wants them.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Table {
    #[serde(skip_serializing_if = "Option::is_none")]
    exposure_us: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    threshold: Option<u8>,
    #[serde(skip_serializing_if = "Option::is_none")]
    limit_m: Option<f64>,
    upper: EnvelopeTable,
    #[serde(skip_serializing_if = "Option::is_none")]
    lower: Option<EnvelopeTable>,
}

#[derive(Serialize, Deserialize)]
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

impl From<Envelope> for EnvelopeTable {
    fn from(envelope: Envelope) -> Self {
        let Envelope { offset_px, scale_px_m2, shift_m } = envelope;
        Self { offset_px, scale_px_m2, shift_m }
    }
}

/// Reads a spot curve.
///
/// # Errors
/// As [`parse_spot_curve`], and when the file cannot be read.
pub fn read_spot_curve(path: impl AsRef<Path>) -> Result<SpotCurveFile> {
    let path = path.as_ref();
    parse_spot_curve(&whole::read_text(path)?, path)
}

/// Reads the text of a spot curve; `path` is for the messages.
///
/// # Errors
/// [`Error`] with the line or the key for unknown and missing keys, for what is not a number, for envelopes that no
/// spots have, and for a lower one above the upper one.
pub fn parse_spot_curve(text: &str, path: impl AsRef<Path>) -> Result<SpotCurveFile> {
    let path = path.as_ref();
    Kind::of_content(text.as_bytes()).expect(Kind::SpotCurve, path, EXAMPLE)?;
    let Table { exposure_us, threshold, limit_m, upper, lower } = table::parse(text, path)?;
    let refuse = |key: &str, reason: String, advice: &str| {
        Error::format(path, reason).at(Place::Key(key.to_owned())).advise(advice)
    };
    if let Some(exposure_us) = exposure_us.filter(|us| !(us.is_finite() && *us > 0.0)) {
        let advice = "give the exposure that it was measured with, or leave it out";
        return Err(refuse("exposure_us", format!("{exposure_us} is not a positive number"), advice));
    }
    if threshold == Some(0) {
        let advice = "give the grey level that it was measured with, 1 to 255, or leave it out";
        return Err(refuse("threshold", "every pixel reaches 0".to_owned(), advice));
    }
    let (upper, lower) = (Envelope::from(upper), lower.map(Envelope::from));
    let refuse_curve = |key: &str, error: SpotCurveError| {
        let (key, advice) = match error {
            SpotCurveError::Limit(_) => ("limit_m", "give the distance past which no LED makes a spot"),
            SpotCurveError::Order { .. } => ("lower", "check which of the two is which"),
            _ => (key, EXAMPLE),
        };
        refuse(key, in_words(&error), advice)
    };
    SpotCurve::new(upper, None, None).map_err(|error| refuse_curve("upper", error))?;
    let curve = SpotCurve::new(upper, lower, limit_m).map_err(|error| refuse_curve("lower", error))?;
    Ok(SpotCurveFile { curve, exposure_us, threshold })
}

fn in_words(error: &SpotCurveError) -> String {
    match error {
        SpotCurveError::Envelope(Envelope { offset_px, scale_px_m2, shift_m }) => format!(
            "an envelope of offset {offset_px} px, scale {scale_px_m2} px m^2 and shift {shift_m} m: \
             the numbers must be finite, the offset 0 or more, the scale above 0"
        ),
        other => other.to_string(),
    }
}

/// A spot curve as the text of a file; it is read back bit for bit.
pub fn text(file: &SpotCurveFile) -> String {
    let SpotCurveFile { curve, exposure_us, threshold } = *file;
    let (upper, lower) = (curve.upper().into(), curve.lower().map(EnvelopeTable::from));
    let table = Table { exposure_us, threshold, limit_m: curve.limit_m(), upper, lower };
    toml::to_string(&table).expect("numbers are TOML")
}

#[cfg(test)]
mod tests {
    use super::*;

    const UPPER: &str = "upper = { offset_px = 1.3398, scale_px_m2 = 31.4704, shift_m = -0.0154 }\n";
    const LOWER: &str = "lower = { offset_px = 0.9, scale_px_m2 = 12.0, shift_m = 0.0 }\n";

    fn message(text: &str) -> String {
        parse_spot_curve(text, "spots.toml").unwrap_err().to_string()
    }

    #[test]
    fn the_papers_curve_needs_one_line_and_says_what_it_holds_for_in_two_more() {
        let file = parse_spot_curve(&format!("exposure_us = 1000\nthreshold = 200\n{UPPER}"), "t").unwrap();
        assert_eq!(file, SpotCurveFile::paper_1000_us());
        let bare = parse_spot_curve(UPPER, "t").unwrap();
        assert_eq!((bare.curve, bare.exposure_us, bare.threshold), (file.curve, None, None));
    }

    #[test]
    fn what_is_no_curve_is_refused_with_its_place() {
        for (text, start) in [
            (UPPER.replace("31.4704", "-3"), "`upper`: an envelope of offset 1.3398 px, scale -3 px m^2"),
            (UPPER.replace("31.4704", "inf"), "`upper`: an envelope"),
            (format!("{UPPER}{}", LOWER.replace("0.9", "nan")), "`lower`: an envelope of offset NaN px"),
            (format!("{UPPER}{}", LOWER.replace("12.0", "120.0")), "`lower`: at 0.1 m the lower envelope"),
            (format!("limit_m = -1\n{UPPER}"), "`limit_m`: a detection limit of -1 m"),
            (format!("exposure_us = nan\n{UPPER}"), "`exposure_us`: NaN is not a positive number"),
            (format!("threshold = 0\n{UPPER}"), "`threshold`: every pixel reaches 0"),
            (
                format!("threshold = 300\n{UPPER}"),
                "line 1: `300` where a whole number of 0 to 255 is expected",
            ),
            (LOWER.to_owned(), "line 1: missing key `upper`; add it"),
            (UPPER.replace("shift_m", "shift"), "line 1: unknown key `shift`"),
        ] {
            let message = message(&text);
            assert!(message.starts_with(&format!("spots.toml, {start}")), "{message}\nnot {start}");
            assert!(message.contains("; "), "{message}");
        }
    }
}
