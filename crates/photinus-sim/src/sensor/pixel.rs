//! Reading pixels that are not all alike: pattern, noise of the full well, bits of the converter.
//!
//! In: the electrons of a lane of pixels and two standard normal numbers for each. Out: grey levels. A full pixel holds what its
//! well holds, whatever came, so that shot noise is gone from it and the noise of its reset stands in its place.

use super::pattern::Map;
use super::readout::LANE;
use super::{Converter, Sensor};

/// The pixels of a unit.
#[derive(Clone, Debug)]
pub(super) struct Pixels {
    map: Map,
    well_noise_e2: f32,
    converter: Converter,
}

/// What a lane of pixels has in common.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reading {
    /// Background at the lane's first pixel and at that of the next lane.
    pub(super) background_e: [f32; 2],
    pub(super) read_variance_e2: f32,
    pub(super) dn_per_electron: f32,
    pub(super) well_dn: f32,
    pub(super) offset_dn: f32,
}

impl Pixels {
    /// The pixels of a sensor; `None` where they are all alike and plain.
    pub(super) fn new(sensor: &Sensor, map: impl FnOnce() -> Map) -> Option<Self> {
        let is_plain = sensor.pattern.is_none()
            && sensor.well_noise_e <= 0.0
            && sensor.converter == Converter::EIGHT_BITS;
        (!is_plain).then(|| Self::unequal(sensor, map()))
    }

    /// Pixels that are read one by one.
    pub(super) fn unequal(sensor: &Sensor, map: Map) -> Self {
        Self {
            map,
            well_noise_e2: (sensor.well_noise_e * sensor.well_noise_e) as f32,
            converter: sensor.converter,
        }
    }

    pub(super) fn map_mut(&mut self) -> &mut Map {
        &mut self.map
    }

    pub(super) fn map(&self) -> &Map {
        &self.map
    }

    /// Reads a lane that begins at column and row `place`: markers' light in grey levels, and normal numbers for the noise of
    /// reading and of the well.
    pub(super) fn read(
        &self,
        common: &Reading,
        (first, v): (usize, usize),
        (lit_dn, normal, second): (&[f32; LANE], &[f32], &[f32]),
        onto: &mut [u8],
    ) {
        let pattern = self.map.row(first, v);
        let step_e = (common.background_e[1] - common.background_e[0]) / LANE as f32;
        for (i, (grey, pixel)) in onto.iter_mut().zip(pattern).enumerate() {
            let background_e = (common.background_e[0] + step_e * i as f32).max(0.0) * pixel.background;
            let well_dn = common.well_dn * pixel.well;
            let level_dn = background_e * common.dn_per_electron + lit_dn[i];
            let read_dn = common.dn_per_electron * normal[i];
            let level_dn = if level_dn < 0.9999 * well_dn {
                level_dn.min(well_dn) + (background_e + common.read_variance_e2).sqrt() * read_dn
            } else {
                let reset_dn = self.well_noise_e2.sqrt() * common.dn_per_electron * second[i];
                well_dn + reset_dn + common.read_variance_e2.sqrt() * read_dn
            };
            let code = self.converter.code(level_dn + common.offset_dn + pixel.offset_dn);
            *grey = self.converter.grey(code);
        }
    }
}
