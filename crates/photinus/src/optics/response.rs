//! How grey levels grow with light where that is no straight line.

use super::{Measured, OpticsError, check};

/// A response with one bend: light x, in grey levels of a dark pixel's slope, reads as y = (1 - exp(-b x)) / b above darkness.
///
/// Above 0 it flattens, as a driver's tone curve or a well that fills does; below 0 it steepens. Every smooth response is
/// of this form as far as its first bend tells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Response {
    /// The bend b, per grey level.
    pub bend_per_dn: Measured,
}

/// A response steeper or flatter than this many times its slope in the dark is not straightened any further.
const MOST: f64 = 20.0;

impl Response {
    pub(super) fn check(&self) -> Result<(), OpticsError> {
        let Measured { value, sigma } = self.bend_per_dn;
        check("the bend of the response", value, value.abs() <= 0.05, "within 0.05 per grey level")?;
        check("a sigma", sigma, sigma >= 0.0 && sigma.is_finite(), "0 or more")
    }

    /// Whether it differs from a straight line by more than it may by chance, 3 sigmas.
    pub fn is_bent(&self) -> bool {
        self.bend_per_dn.value.abs() > 3.0 * self.bend_per_dn.sigma
    }

    /// The light that reads as so many grey levels above darkness, and how much it grows with each.
    pub fn straightened(&self, above_dn: f64) -> (f64, f64) {
        straightened(self.bend_per_dn.value, above_dn)
    }

    /// By how much of itself a light of so many grey levels reads too little, with its sigma.
    pub fn missing_share(&self, light_dn: f64) -> Measured {
        let bend = self.bend_per_dn.value;
        let read = |bend: f64| {
            if bend.abs() < 1e-9 { 1.0 } else { -libm::expm1(-bend * light_dn) / (bend * light_dn) }
        };
        Measured { value: 1.0 - read(bend), sigma: 0.5 * light_dn * self.bend_per_dn.sigma }
    }
}

/// The light that reads as `above_dn`, and its slope, for a bend b: -ln(1 - b y) / b; beyond the steepest slope a straight line.
pub(crate) fn straightened(bend: f64, above_dn: f64) -> (f64, f64) {
    if bend.abs() < 1e-9 {
        return (above_dn, 1.0);
    }
    let left = (1.0 - bend * above_dn).clamp(1.0 / MOST, MOST);
    let until_dn = (1.0 - left) / bend;
    (-libm::log(left) / bend + (above_dn - until_dn) / left, 1.0 / left)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn what_is_read_is_straightened_to_the_light_that_it_was(bend in -0.005..0.005_f64, light in 0.0..250.0_f64) {
            let read = if bend.abs() < 1e-9 { light } else { -libm::expm1(-bend * light) / bend };
            let response = Response { bend_per_dn: Measured { value: bend, sigma: 0.0 } };
            let (found, slope) = response.straightened(read);
            prop_assert!((found - light).abs() < 1e-6 * (1.0 + light), "{found} not {light}");
            let [less, more] = [-1e-4, 1e-4].map(|off| response.straightened(read + off).0);
            prop_assert!((slope - (more - less) / 2e-4).abs() < 1e-4 * slope);
            let missing = response.missing_share(light.max(1.0)).value;
            prop_assert!(light < 1.0 || ((1.0 - missing) * light - read).abs() < 1e-6 * (1.0 + light));
        }
    }
}
