//! How wide sources of light are, beyond those that a point spread was learnt from.
//!
//! An LED is a small disc. Near by its image is wider than the point spread: its own variance grows with the square of one over its distance, as
//! its light does, so that it grows in proportion to the light. Spots of a point spread have both in it, at the light that they had.

use super::{Measured, OpticsError, check};
#[cfg(not(feature = "std"))]
use crate::float::Float as _;

/// A light that grows further than this widens a source no more, times the light of those that the point spread was learnt from.
const FARTHEST: f64 = 100.0;

/// The variance that sources of a light have of their own, beyond that of the sources that a point spread was learnt from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SourceSize {
    /// Light of those sources, grey levels.
    pub light_dn: f64,
    /// By how much the variance of a source grows with each such light, px^2.
    pub growth_px2: Measured,
    /// How far sources of one light differ, standard deviation of their variances, px^2.
    pub scatter_px2: f64,
}

impl SourceSize {
    /// What is believed where nobody looked. LEDs that are 1 mm wide and just seen (20 grey levels of light) 15 m before a lens of 250 px
    /// focal length have a variance of 0.0004 px^2 where they have a light of 500, 0.001 px^2 if they are 1.5 mm wide.
    pub const UNKNOWN: Self =
        Self { light_dn: 500.0, growth_px2: Measured { value: 5e-4, sigma: 5e-4 }, scatter_px2: 0.005 };

    /// Checks every number.
    ///
    /// # Errors
    /// [`OpticsError::Number`] names the first that no source has.
    pub fn check(&self) -> Result<(), OpticsError> {
        let within = |name, value: f64, low: f64, high: f64, must| {
            check(name, value, value >= low && value <= high, must)
        };
        within("the light of sources", self.light_dn, 1e-3, 1e9, "more than 0 grey levels")?;
        within("the growth of sources", self.growth_px2.value, 0.0, 10.0, "0 to 10 px^2")?;
        within("a sigma", self.growth_px2.sigma, 0.0, 10.0, "0 to 10 px^2")?;
        within("the scatter of sources", self.scatter_px2, 0.0, 10.0, "0 to 10 px^2")
    }

    /// The same of one that seems to have this variance: what is brighter is no smaller, so that what seems to be is so by scatter alone.
    pub(crate) fn believed_near(&self, light_dn: f64, variance_px2: f64) -> Measured {
        let believed = self.believed(light_dn);
        let is_smaller = variance_px2 < 0.0 && believed.value > 0.0;
        if is_smaller { Measured { value: 0.0, sigma: self.scatter_px2 } } else { believed }
    }

    /// The variance of a source of this much light, px^2.
    pub fn believed(&self, light_dn: f64) -> Measured {
        let from = (light_dn / self.light_dn - 1.0).clamp(-1.0, FARTHEST);
        let Measured { value, sigma } = self.growth_px2;
        let growth = sigma * from;
        Measured {
            value: value * from,
            sigma: (self.scatter_px2 * self.scatter_px2 + growth * growth).sqrt(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn an_led_grows_as_its_distance_has_it(
            wide_m in 1e-4..5e-3_f64,
            learnt_m in 3.0..15.0_f64,
            seen_m in 1.0..15.0_f64,
        ) {
            // the variance of an even disc along one axis is a quarter of its radius squared
            let variance_px2 = |m: f64| (250.0 * 0.5 * wide_m / m) * (250.0 * 0.5 * wide_m / m) / 4.0;
            let light_dn = |m: f64| 4500.0 / (m * m);
            let growth_px2 = Measured { value: variance_px2(learnt_m), sigma: 0.0 };
            let size = SourceSize { light_dn: light_dn(learnt_m), growth_px2, scatter_px2: 0.0 };
            let wider = variance_px2(seen_m) - variance_px2(learnt_m);
            if light_dn(seen_m) < FARTHEST * light_dn(learnt_m) {
                prop_assert!((size.believed(light_dn(seen_m)).value - wider).abs() < 1e-9);
            }
        }

        #[test]
        fn brighter_ones_are_not_believed_to_be_smaller(light_dn in 501.0..1e6_f64, variance_px2 in 1e-3..0.1_f64) {
            let size = SourceSize::UNKNOWN;
            let unlikely = |variance_px2: f64| {
                let Measured { value, sigma } = size.believed_near(light_dn, variance_px2);
                (variance_px2 - value) * (variance_px2 - value) / (sigma * sigma)
            };
            let smaller = variance_px2 / size.scatter_px2;
            prop_assert!((unlikely(-variance_px2) - smaller * smaller).abs() < 1e-9 * smaller * smaller);
            prop_assert!(unlikely(variance_px2) < unlikely(-variance_px2) || variance_px2 < size.believed(light_dn).value);
        }

        #[test]
        fn brighter_ones_are_less_sure(more in 1.0..50.0_f64, most in 1.0..50.0_f64) {
            let sigma = |times: f64| SourceSize::UNKNOWN.believed(times * SourceSize::UNKNOWN.light_dn).sigma;
            prop_assert!(sigma(more * most) >= sigma(more));
        }
    }

    #[test]
    fn what_no_source_is_is_refused() {
        let known = SourceSize::UNKNOWN;
        assert!(known.check().is_ok());
        let grows = |value: f64, sigma: f64| SourceSize { growth_px2: Measured { value, sigma }, ..known };
        let refused = [
            SourceSize { light_dn: 0.0, ..known },
            SourceSize { scatter_px2: f64::NAN, ..known },
            grows(-1e-3, 0.0),
            grows(0.0, -1.0),
        ];
        for size in refused {
            assert!(size.check().is_err(), "{size:?}");
        }
    }
}
