//! How well an airframe is known, as calibration leaves it in the file.

use std::path::Path;

use crate::{Error, Place, Result};

/// How far an airframe may be from what its file says.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tolerances {
    /// Standard deviation of an LED's position, per axis, m; `None` where nobody measured it.
    pub position_sigma_m: Option<f64>,
    /// Standard deviation of the logarithm of an LED's power; `None` where nobody measured it.
    pub power_sigma: Option<f64>,
}

impl Tolerances {
    /// Refuses what is not a standard deviation.
    pub(super) fn check(&self, path: &Path) -> Result<()> {
        let refuse = |key: &str, value: f64, advice: &str| {
            let error = Error::format(path, format!("{value} is no standard deviation that can be"));
            Err(error.at(Place::Key(key.to_owned())).advise(advice))
        };
        match (self.position_sigma_m, self.power_sigma) {
            (Some(sigma_m), _) if !(0.0..=1.0).contains(&sigma_m) => {
                refuse("position_sigma_m", sigma_m, "give metres, 0 to 1")
            }
            (_, Some(sigma)) if !(0.001..=10.0).contains(&sigma) => {
                refuse("power_sigma", sigma, "give a share, 0.001 to 10")
            }
            _ => Ok(()),
        }
    }
}
