//! What a pixel makes of light: noise, where it is full, and where the excess goes.

use super::{OpticsError, Response, check};
#[cfg(not(feature = "std"))]
use crate::float::Float as _;

/// A number with its standard deviation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// The number.
    pub value: f64,
    /// Its standard deviation: that of the measurement, or of what is believed where nothing was measured.
    pub sigma: f64,
}

/// Where a pixel is full.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Saturation {
    /// Grey level that a full pixel reads on average.
    pub level_dn: f64,
    /// Spread of that from pixel to pixel and from frame to frame, grey levels.
    pub spread_dn: f64,
}

/// A sensor: EMVA 1288's linear model, with a full well that overflows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sensor {
    /// Grey level of a pixel without light; below 0 where darkness is clipped. Only told: the background of every spot is measured
    /// beside it.
    pub dark_dn: Option<Measured>,
    /// Noise of reading a pixel, grey levels, without that of rounding.
    pub read_noise_dn: Measured,
    /// Variance that light adds, grey levels^2 per grey level: one over the electrons per level.
    pub shot: Measured,
    /// How grey levels grow with light; `None` where nobody looked: in proportion.
    pub response: Option<Response>,
    /// Where a pixel is full.
    pub saturation: Saturation,
    /// Share of the charge above the full well that spills into the four neighbours; the rest is drained.
    pub spill: Measured,
    /// Charge that a pixel holds, in grey levels above darkness, where it is more than the converter tells: only what is
    /// above it spills. `None` where a full pixel reads [`Saturation::level_dn`].
    pub full_well_dn: Option<Measured>,
    /// Share of a pixel's light that every other pixel of its column gets (the rows pick it up on their way out).
    pub column_smear: Option<Measured>,
}

impl Sensor {
    /// Checks every number.
    ///
    /// # Errors
    /// [`OpticsError::Number`] names the first that no sensor has.
    pub fn check(&self) -> Result<(), OpticsError> {
        let within = |name, value: f64, low: f64, high: f64, must| {
            check(name, value, value >= low && value <= high, must)
        };
        let known = |name, measured: &Measured, low: f64, high: f64, must| {
            within(name, measured.value, low, high, must)?;
            within("a sigma", measured.sigma, 0.0, f64::MAX, "0 or more")
        };
        if let Some(dark) = &self.dark_dn {
            known("the dark level", dark, -255.0, 255.0, "-255 to 255 grey levels")?;
        }
        known("the read noise", &self.read_noise_dn, 0.0, 255.0, "0 to 255 grey levels")?;
        known("the shot noise", &self.shot, 0.0, 255.0, "0 to 255 grey levels")?;
        within("the saturation level", self.saturation.level_dn, 1.0, 255.0, "1 to 255 grey levels")?;
        within("the spread of saturation", self.saturation.spread_dn, 0.0, 64.0, "0 to 64 grey levels")?;
        known("the spill", &self.spill, 0.0, 1.0, "a share, 0 to 1")?;
        if let Some(well) = &self.full_well_dn {
            known("the full well", well, 1.0, 1e6, "1 grey level or more")?;
        }
        if let Some(response) = &self.response {
            response.check()?;
        }
        if let Some(smear) = &self.column_smear {
            known("the column smear", smear, 0.0, 1.0, "a share, 0 to 1")?;
        }
        Ok(())
    }

    /// The response, where it is no straight line as far as can be told.
    pub fn bent(&self) -> Option<&Response> {
        self.response.as_ref().filter(|response| response.is_bent())
    }

    /// Lowest grey level that may be that of a full pixel: three of its spreads below the mean, never more than 255.
    pub fn full_from_dn(&self) -> u8 {
        let lowest = self.saturation.level_dn - 3.0 * self.saturation.spread_dn;
        (lowest - 0.5).ceil().clamp(1.0, 255.0) as u8
    }
}
