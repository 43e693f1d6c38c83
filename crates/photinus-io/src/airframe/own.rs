//! The airframe TOML: a list of LEDs, or a ring that stands for one.

use std::path::Path;

use nalgebra::{Unit, Vector3};
use photinus::airframe::{Airframe, AirframeError, Led, Ring};
use serde::{Deserialize, Serialize};

use super::lobe::LobeEntry;
use super::{AirframeFile, Part, Tolerances, refuse};
use crate::{Error, Place, Result, table};

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Table {
    name: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    position_sigma_m: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    power_sigma: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    ring: Option<RingTable>,
    #[serde(skip_serializing_if = "Option::is_none")]
    led: Option<Vec<LedTable>>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct RingTable {
    arms: usize,
    radius_m: f64,
    leds_per_arm: usize,
    splay_deg: f64,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct LedTable {
    position_m: [f64; 3],
    axis: [f64; 3],
    lobe: LobeEntry,
    #[serde(skip_serializing_if = "Option::is_none")]
    signal: Option<u32>,
    #[serde(default = "mean_power", skip_serializing_if = "is_mean_power")]
    power: f64,
}

fn mean_power() -> f64 {
    1.0
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde passes a reference")]
fn is_mean_power(power: &f64) -> bool {
    (power - mean_power()).abs() <= 0.0
}

pub(super) fn parse(text: &str, path: &Path) -> Result<AirframeFile> {
    let Table { name, position_sigma_m, power_sigma, ring, led } = table::parse(text, path)?;
    let tolerances = Tolerances { position_sigma_m, power_sigma };
    tolerances.check(path)?;
    if name.trim().is_empty() {
        return Err(Error::format(path, "the name is empty")
            .at(Place::Key("name".to_owned()))
            .advise("name the airframe: results refer to it"));
    }
    let airframe = match (ring, led) {
        (Some(ring), None) => {
            let RingTable { arms, radius_m, leds_per_arm, splay_deg } = ring;
            let ring = Ring { arms, radius_m, leds_per_arm, splay_rad: splay_deg.to_radians() };
            Airframe::from_ring(name, ring)
                .map_err(|error| refuse(path, error, key).at(Place::Key("ring".to_owned())))?
        }
        (None, Some(leds)) => {
            let leds = leds
                .into_iter()
                .zip(0..)
                .map(|(led, index)| to_led(led, index, path))
                .collect::<Result<_>>()?;
            Airframe::new(name, leds).map_err(|error| refuse(path, error, key))?
        }
        (Some(_), Some(_)) => {
            return Err(
                Error::format(path, "it gives both a ring and a list of LEDs").advise("keep one of them")
            );
        }
        (None, None) => {
            return Err(Error::format(path, "it gives no LED").advise("add [[led]] tables, or a ring"));
        }
    };
    Ok(AirframeFile { airframe, tolerances, notes: Vec::new() })
}

fn key(led: usize, part: Part) -> Place {
    Place::Key(match part {
        Part::Position => format!("led[{led}].position_m"),
        Part::Axis => format!("led[{led}].axis"),
        Part::Lobe => format!("led[{led}].lobe"),
        Part::Power => format!("led[{led}].power"),
        Part::Whole => format!("led[{led}]"),
    })
}

fn to_led(led: LedTable, index: usize, path: &Path) -> Result<Led> {
    let axis = unit(Vector3::from(led.axis)).ok_or_else(|| {
        Error::format(path, format!("{:?} points nowhere", led.axis))
            .at(key(index, Part::Axis))
            .advise("give the direction in which the LED shines, such as [1.0, 0.0, 0.0]")
    })?;
    let lobe =
        led.lobe.read().map_err(|error| refuse(path, AirframeError::Lobe { led: index, error }, key))?;
    Ok(Led { position_m: led.position_m.into(), axis, lobe, power: led.power, signal: led.signal })
}

/// The direction of a vector of any length; one of length 1 to the last digits stays as it is written.
fn unit(vector: Vector3<f64>) -> Option<Unit<Vector3<f64>>> {
    let length = vector.norm();
    if (length - 1.0).abs() < 1e-12 {
        return Some(Unit::new_unchecked(vector));
    }
    let has_direction = length.is_finite() && length > 1e-9;
    has_direction.then(|| Unit::new_unchecked(vector / length))
}

/// The airframe as the text of a TOML file, its LEDs as a list.
pub fn toml_text(airframe: &Airframe, tolerances: &Tolerances) -> String {
    let led = |led: &Led| LedTable {
        position_m: led.position_m.into(),
        axis: led.axis.into_inner().into(),
        lobe: LobeEntry::of(&led.lobe),
        signal: led.signal,
        power: led.power,
    };
    let Tolerances { position_sigma_m, power_sigma } = *tolerances;
    let table = Table {
        name: airframe.name().to_owned(),
        position_sigma_m,
        power_sigma,
        ring: None,
        led: Some(airframe.leds().iter().map(led).collect()),
    };
    toml::to_string(&table).expect("numbers and strings are TOML")
}
