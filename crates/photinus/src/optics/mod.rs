//! What a camera makes of a point of light: how it spreads over pixels, and what a pixel makes of it.
//!
//! In: what a calibration measured of a lens and its sensor, or what is believed of one that nobody measured. Out: the share
//! of a point's light that each pixel around it gets, with its slopes ([`PointSpread`], for every part of the image in
//! [`SpreadField`]); noise, saturation and overflow of a pixel ([`Sensor`]), how its grey levels grow with light ([`Response`]), and
//! which are bright without any ([`HotPixels`]); how much light the lens lets through off its axis ([`Vignetting`]). Centres, light and
//! their errors follow from these in [`crate::spots`].

mod field;
mod hot_pixels;
mod log_light;
mod response;
mod sensor;
mod source_size;
mod spline;
mod spread;
mod vignetting;

pub(crate) use spread::{GaussianShares, Placed, PlacedGaussian, Profile, Shares};

pub use field::SpreadField;
pub use hot_pixels::{HotPixel, HotPixels};
pub use log_light::LogLight;
pub use response::Response;
pub use sensor::{Measured, Saturation, Sensor};
pub use source_size::SourceSize;
pub use spread::{Gaussian, PointSpread};
pub use vignetting::Vignetting;

/// Why numbers do not make optics.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum OpticsError {
    /// A number that no lens or sensor has.
    #[error("{name} is {value}, it must be {must}")]
    Number {
        /// Which.
        name: &'static str,
        /// What was given.
        value: f64,
        /// What it must be.
        must: &'static str,
    },
    /// A table whose samples are not the square of an odd number of rows.
    #[error("{samples} samples, {needed} are needed")]
    Samples {
        /// Samples given.
        samples: usize,
        /// Samples needed.
        needed: usize,
    },
}

/// Refuses what is not within a range.
fn check(name: &'static str, value: f64, is_legal: bool, must: &'static str) -> Result<(), OpticsError> {
    if is_legal { Ok(()) } else { Err(OpticsError::Number { name, value, must }) }
}

/// Lens and sensor of one camera, as measured.
#[derive(Clone, Debug, PartialEq)]
pub struct Optics {
    /// How a point of light spreads over pixels, all over the image.
    pub spread: SpreadField,
    /// What a pixel makes of light.
    pub sensor: Sensor,
    /// How much light passes off the axis; `None` where it was not to be seen.
    pub vignetting: Option<Vignetting>,
    /// Pixels that are bright without light.
    pub hot_pixels: HotPixels,
}
