//! What numbers of a recording or a scene can be: one place for all ranges.
//!
//! They are wide: what is outside is a slip of the pen or of a unit, never a camera or a vehicle.

use std::ops::RangeInclusive;
use std::path::Path;

use crate::{Error, Place, Result};

/// Frames, bits or samples per second.
pub const RATE_HZ: RangeInclusive<f64> = 1e-3..=1e6;
/// How long a frame is exposed, us: to a minute.
pub const EXPOSURE_US: RangeInclusive<f64> = 0.1..=60e6;
/// A time, s: also one since 1970.
pub const TIME_S: RangeInclusive<f64> = -1e11..=1e11;
/// A coordinate, m: to a thousand kilometres.
pub const PLACE_M: RangeInclusive<f64> = -1e6..=1e6;
/// A component of a velocity, m/s.
pub const SPEED_M_S: RangeInclusive<f64> = -1e5..=1e5;
/// A component of a rate of turn, rad/s.
pub const TURN_RAD_S: RangeInclusive<f64> = -1e4..=1e4;
/// By how many millionths a clock is fast: to a tenth of all time.
pub const CLOCK_PPM: RangeInclusive<f64> = -1e5..=1e5;
/// How far the length of a unit vector or quaternion may be from 1: what rounding to a few digits does.
pub const UNIT_TOLERANCE: f64 = 0.01;

/// The value of a key, when it lies in its range; NaN never does.
///
/// # Errors
/// [`Error`] with the key and the range.
pub fn within(path: &Path, key: &str, value: f64, range: &RangeInclusive<f64>) -> Result<f64> {
    if range.contains(&value) {
        return Ok(value);
    }
    Err(Error::format(path, format!("{value:?} is out of range"))
        .at(Place::Key(key.to_owned()))
        .advise(advice(range)))
}

/// What to give instead.
pub(crate) fn advice(range: &RangeInclusive<f64>) -> String {
    format!("give {} to {}", range.start(), range.end())
}

/// Whether the length of something that must have length 1 is near enough to it; NaN is not.
pub(crate) fn is_unit(length: f64) -> bool {
    (length - 1.0).abs() <= UNIT_TOLERANCE
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ends_are_inside_and_what_is_no_number_is_not() {
        let try_rate = |value| within(Path::new("t.toml"), "rate_hz", value, &RATE_HZ);
        assert!(try_rate(1e-3).is_ok() && try_rate(1e6).is_ok());
        for value in [0.0, 1e-308, 1.1e6, -60.0, f64::INFINITY, f64::NAN] {
            let message = try_rate(value).unwrap_err().to_string();
            assert!(
                message.starts_with("t.toml, `rate_hz`: ") && message.ends_with("; give 0.001 to 1000000")
            );
        }
    }
}
