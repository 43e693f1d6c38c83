//! The sensor: photo-electrons in, 8-bit grey levels out.
//!
//! ```text
//! light -> photo-electrons with shot noise -> overflow (charge.rs, overflow.rs) -> full well
//!       -> read noise -> gain, dark offset, 8 bits (readout.rs)
//! ```
//! The order and the terms are those of EMVA 1288 (linear model); overflow is what the paper calls blooming.

mod charge;
mod noise;
mod overflow;
mod readout;

pub use charge::Charge;
pub use noise::NoiseTable;
pub(crate) use noise::hash;
pub use overflow::{Overflow, Overflown};
pub use readout::{Background, Readout};

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
        /// The ceiling C above the dark offset, grey levels.
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
    /// What becomes of charge above the full well.
    pub overflow: Overflow,
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
            Response::Soft { ceiling_dn } if above_dn < ceiling_dn => {
                -ceiling_dn * libm::log1p(-above_dn / ceiling_dn)
            }
            Response::Soft { .. } => f64::INFINITY,
        };
        linear_dn * self.electrons_per_dn
    }
}
