//! Numbers as files have them: finite or refused, with the line from whichever parser reads them.

use serde::{Deserialize, Deserializer, Serialize};

/// A number that is neither NaN nor infinite.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(transparent)]
pub(super) struct Finite(pub(super) f64);

impl<'de> Deserialize<'de> for Finite {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let value = f64::deserialize(deserializer)?;
        if value.is_finite() {
            return Ok(Self(value));
        }
        Err(serde::de::Error::custom(format_args!("{value} where a finite number is expected")))
    }
}

/// The bare numbers.
pub(super) fn values(numbers: &[Finite]) -> Vec<f64> {
    numbers.iter().map(|number| number.0).collect()
}

/// Exactly `N` numbers, or how many there were.
pub(super) fn exactly<const N: usize>(numbers: &[Finite]) -> Option<[f64; N]> {
    values(numbers).try_into().ok()
}

/// The angle in degrees that a reader turns into exactly this one, rad, or the nearest there is.
pub(super) fn degrees(angle_rad: f64) -> f64 {
    let near = angle_rad.to_degrees();
    let exact = [near, near.next_down(), near.next_up()];
    exact.into_iter().find(|deg| deg.to_radians().to_bits() == angle_rad.to_bits()).unwrap_or(near)
}
