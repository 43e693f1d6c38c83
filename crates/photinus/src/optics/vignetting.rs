//! How much light passes a lens off its axis.

use alloc::vec::Vec;

use super::{OpticsError, check};

/// Relative illumination: 1 on the axis, between the angles where it was measured straight lines.
#[derive(Clone, Debug, PartialEq)]
pub struct Vignetting {
    angles_rad: Vec<f64>,
    shares: Vec<f64>,
    sigmas: Vec<f64>,
}

impl Vignetting {
    /// From angles off the axis, rad, rising from 0, the share of light at each and its sigma.
    ///
    /// # Errors
    /// [`OpticsError`] when there is no angle, when the lists differ in length, angles do not rise from 0, or shares are not positive.
    pub fn new(angles_rad: &[f64], shares: &[f64], sigmas: &[f64]) -> Result<Self, OpticsError> {
        let needed = angles_rad.len().max(1);
        for list in [angles_rad, shares, sigmas] {
            if list.len() != needed {
                return Err(OpticsError::Samples { samples: list.len(), needed });
            }
        }
        check("the first angle", angles_rad[0], angles_rad[0] == 0.0, "0")?;
        for pair in angles_rad.windows(2) {
            let rises = pair[1] > pair[0] && pair[1] <= core::f64::consts::PI;
            check("an angle off the axis", pair[1], rises, "more than the one before, up to pi")?;
        }
        for &share in shares {
            check("a relative illumination", share, share > 0.0 && share <= 10.0, "above 0, at most 10")?;
        }
        for &sigma in sigmas {
            check("a sigma", sigma, sigma >= 0.0 && sigma.is_finite(), "0 or more")?;
        }
        Ok(Self { angles_rad: angles_rad.to_vec(), shares: shares.to_vec(), sigmas: sigmas.to_vec() })
    }

    /// Angles, shares and their sigmas as given.
    pub fn table(&self) -> (&[f64], &[f64], &[f64]) {
        (&self.angles_rad, &self.shares, &self.sigmas)
    }

    /// The share of light that passes at an angle off the axis, with its sigma; past the last angle as there.
    pub fn share(&self, off_axis_rad: f64) -> (f64, f64) {
        let after = self.angles_rad.partition_point(|&angle| angle <= off_axis_rad);
        let (Some(before), true) = (after.checked_sub(1), after < self.angles_rad.len()) else {
            let end = if after == 0 { 0 } else { after - 1 };
            return (self.shares[end], self.sigmas[end]);
        };
        let part =
            (off_axis_rad - self.angles_rad[before]) / (self.angles_rad[after] - self.angles_rad[before]);
        let between = |list: &[f64]| list[before] + part * (list[after] - list[before]);
        (between(&self.shares), between(&self.sigmas))
    }
}
