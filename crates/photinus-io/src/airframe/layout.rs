//! The LED layout text: `X Y Z Type Pitch Yaw signal_id` per line, metres and radians in the body frame.
//!
//! The axis of an LED is Rz(yaw) Ry(pitch) applied to +x, so that a positive pitch points down. Type 0 is
//! directional, 1 a ring and 2 omnidirectional; the latter two both shine the same in every direction here.

use std::fmt::Write;
use std::path::Path;

use nalgebra::{Unit, Vector3};
use photinus::airframe::{Airframe, Led, Lobe};

use super::{AirframeFile, Tolerances, refuse};
use crate::{Error, Place, Result};

const COLUMNS: [&str; 7] = ["X", "Y", "Z", "Type", "Pitch", "Yaw", "signal_id"];

pub(super) fn parse(text: &str, path: &Path) -> Result<AirframeFile> {
    let (mut leds, mut lines, mut rings) = (Vec::new(), Vec::new(), 0);
    for (text, line) in text.lines().zip(1..) {
        let row = text.split('#').next().unwrap_or_default();
        if row.trim().is_empty() {
            continue;
        }
        let (led, is_ring) = parse_row(row)
            .map_err(|(reason, advice)| Error::format(path, reason).at(Place::Line(line)).advise(advice))?;
        leds.push(led);
        lines.push(line);
        rings += usize::from(is_ring);
    }
    let name = path.file_stem().map_or("airframe".into(), |stem| stem.to_string_lossy());
    let airframe =
        Airframe::new(name, leds).map_err(|error| refuse(path, error, |led, _| Place::Line(lines[led])))?;
    let ring_note =
        || format!("{rings} LED(s) of type 1 (ring) are taken as shining the same in every direction");
    let turned = rows_in_degrees(text);
    let degrees_note = || {
        format!(
            "{turned} LED(s) have a pitch or yaw beyond a whole turn of 6.28: angles are taken as radians; if they are degrees, \
                 divide them by 57.296"
        )
    };
    let notes = (rings > 0).then(ring_note).into_iter().chain((turned > 0).then(degrees_note)).collect();
    Ok(AirframeFile { airframe, tolerances: Tolerances::default(), notes })
}

/// How many rows turn an LED by more than a whole turn, as nobody writes in radians.
fn rows_in_degrees(text: &str) -> usize {
    let is_turned = |row: &&str| {
        let angles = row.split_whitespace().skip(4).take(2).filter_map(|word| word.parse::<f64>().ok());
        angles.into_iter().any(|angle| angle.abs() > core::f64::consts::TAU + 0.01)
    };
    text.lines().map(|line| line.split('#').next().unwrap_or_default()).filter(is_turned).count()
}

/// What is wrong, and what to do.
type Wrong = (String, &'static str);

/// An LED, and whether it was of type 1.
fn parse_row(row: &str) -> std::result::Result<(Led, bool), Wrong> {
    let words: Vec<&str> = row.split_whitespace().collect();
    let [x, y, z, kind, pitch, yaw, signal] = words.as_slice() else {
        let reason = format!("{} values where 7 must stand", words.len());
        return Err((reason, "give X Y Z Type Pitch Yaw signal_id"));
    };
    let lobe = match *kind {
        "0" => Lobe::Lambertian,
        "1" | "2" => Lobe::Omni,
        _ => {
            return Err((
                format!("there is no type `{kind}`"),
                "give 0 directional, 1 ring or 2 omnidirectional",
            ));
        }
    };
    let signal = signal.parse().map_err(|_| wrong_number(6, signal))?;
    let axis = axis(number(4, pitch)?, number(5, yaw)?);
    let position_m = Vector3::new(number(0, x)?, number(1, y)?, number(2, z)?);
    Ok((Led { position_m, axis, lobe, power: 1.0, signal: Some(signal) }, *kind == "1"))
}

/// Rz(yaw) Ry(pitch) applied to +x.
fn axis(pitch_rad: f64, yaw_rad: f64) -> Unit<Vector3<f64>> {
    let (sin_pitch, cos_pitch) = libm::sincos(pitch_rad);
    let (sin_yaw, cos_yaw) = libm::sincos(yaw_rad);
    Unit::new_normalize(Vector3::new(cos_pitch * cos_yaw, cos_pitch * sin_yaw, -sin_pitch))
}

fn number(column: usize, word: &str) -> std::result::Result<f64, Wrong> {
    word.parse().ok().filter(|value: &f64| value.is_finite()).ok_or_else(|| wrong_number(column, word))
}

fn wrong_number(column: usize, word: &str) -> Wrong {
    let advice = match column {
        0..3 => "give metres in the body frame",
        6 => "give a whole number, 0 or more",
        _ => "give radians",
    };
    (format!("{} `{word}` is not a number", COLUMNS[column]), advice)
}

/// The airframe as the text of a layout file; `path` is for the messages. An LED without a signal gets signal 0, since the
/// format has no other way; powers are left out; a lobe becomes type 0 or 2. The name is that of the file.
///
/// # Errors
/// [`Error`] names the first LED whose lobe has no type in a layout.
pub fn layout_text(airframe: &Airframe, path: impl AsRef<Path>) -> Result<String> {
    let mut text = format!("# {}\n", COLUMNS.join(" "));
    for (number, led) in airframe.leds().iter().enumerate() {
        let kind = match led.lobe {
            Lobe::Lambertian => 0,
            Lobe::Omni => 2,
            Lobe::Cosine { .. } | Lobe::Table(_) => {
                let reason = format!(
                    "LED {number} shines by a power of the cosine or by a table: a layout knows only the cosine and every \
                     direction alike"
                );
                return Err(
                    Error::format(path.as_ref(), reason).advise("write TOML, which knows lobes of all kinds")
                );
            }
        };
        let pitch_rad = libm::atan2(-led.axis.z, libm::hypot(led.axis.x, led.axis.y));
        let yaw_rad = libm::atan2(led.axis.y, led.axis.x);
        let [x, y, z]: [f64; 3] = led.position_m.into();
        let signal = led.signal.unwrap_or(0);
        // Writing to a String cannot fail.
        let _ = writeln!(text, "{x} {y} {z} {kind} {pitch_rad} {yaw_rad} {signal}");
    }
    Ok(text)
}
