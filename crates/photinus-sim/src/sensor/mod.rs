//! The sensor: photo-electrons in, 8-bit grey levels out.
//!
//! ```text
//! light -> smear along columns (smear.rs) -> pattern of gain (pattern.rs) -> photo-electrons with shot noise
//!       -> overflow (charge.rs, overflow.rs) -> full well -> read noise -> gain, dark offset (readout.rs, pixel.rs)
//!       -> bits (converter.rs)
//! ```
//! The order and the terms are those of EMVA 1288 (linear model); overflow is what the paper calls blooming. A sensor without
//! pattern, noise of its well and bits of its own takes a shorter way through the readout.

mod background;
mod charge;
mod converter;
mod noise;
mod overflow;
mod pattern;
mod pixel;
mod readout;
mod smear;

#[cfg(test)]
mod tests;

pub use background::Background;
pub use charge::Charge;
pub use converter::Converter;
pub use noise::NoiseTable;
pub(crate) use noise::hash;
pub use overflow::{Overflow, Overflown};
pub use pattern::Pattern;
pub use readout::Readout;
pub use smear::ColumnSmear;

/// How the rows of a frame are exposed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shutter {
    /// All at once.
    Global,
    /// One after the other.
    Rolling {
        /// From the start of one row's exposure to that of the next, s.
        line_s: f64,
    },
}

/// How grey levels grow with charge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Response {
    /// In proportion.
    Linear,
    /// In proportion when dark, towards a ceiling when bright: C (1 - exp(-x / C)), the tone curve of a camera driver.
    Soft {
        /// The ceiling C above the dark offset, grey levels; below 0 levels grow faster the brighter it is.
        ceiling_dn: f64,
    },
}

/// A sensor.
#[derive(Clone, Debug, PartialEq)]
pub struct Sensor {
    /// Quantum efficiency at the markers' wavelength.
    pub quantum_efficiency: f64,
    /// How grey levels grow with charge.
    pub response: Response,
    /// Photo-electrons that make a grey level, in the dark.
    pub electrons_per_dn: f64,
    /// Charge at which a pixel overflows, electrons; more than 255 levels' worth where the converter saturates first.
    pub full_well_e: f64,
    /// Noise of a full pixel from frame to frame, electrons: that of its reset, in place of shot noise.
    pub well_noise_e: f64,
    /// What becomes of charge above the full well.
    pub overflow: Overflow,
    /// Light that rows pick up on their way through a column.
    pub smear: ColumnSmear,
    /// Noise of reading a pixel, electrons.
    pub read_noise_e: f64,
    /// Grey level of a pixel without light.
    pub dark_offset_dn: f64,
    /// By how much the offset is higher in the corners of the image: what a driver's shading correction leaves of it.
    pub corner_offset_dn: f64,
    /// Dark current of an ordinary pixel, electrons per second.
    pub dark_current_e_per_s: f64,
    /// Share of pixels that are hot.
    pub hot_pixel_share: f64,
    /// Mean dark current of a hot pixel, electrons per second; its distribution is exponential.
    pub hot_pixel_e_per_s: f64,
    /// How unequal the pixels are.
    pub pattern: Pattern,
    /// How many levels the converter tells apart.
    pub converter: Converter,
    /// How the rows are exposed.
    pub shutter: Shutter,
}

impl Sensor {
    /// Photo-electrons from a power on the sensor over a time: P t / (h c / lambda) QE.
    pub fn photo_electrons(&self, power_w: f64, time_s: f64, photon_j: f64) -> f64 {
        power_w * time_s / photon_j * self.quantum_efficiency
    }

    /// Charge that reads as `level_dn`, electrons, without noise; infinite for a level that none reads as.
    pub fn electrons_at(&self, level_dn: f64) -> f64 {
        let above_dn = level_dn - self.dark_offset_dn;
        let linear_dn = match self.response {
            Response::Linear => above_dn,
            Response::Soft { ceiling_dn } if ceiling_dn < 0.0 || above_dn < ceiling_dn => {
                -ceiling_dn * libm::log1p(-above_dn / ceiling_dn)
            }
            Response::Soft { .. } => f64::INFINITY,
        };
        linear_dn * self.electrons_per_dn
    }
}
