//! How well the best mode of a neighbour fits what is seen: the sum of its squared residuals against their number.

use super::light::Light;
use super::problem::{Pose, Problem};
#[cfg(not(feature = "std"))]
use crate::float::Float as _;

/// Squared residuals in units of their variance, summed, and how many of them are left when the pose is fitted.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Misfit {
    /// Sum of squares.
    pub chi_square: f64,
    /// Degrees of freedom: residuals less parameters, at least 0.
    pub degrees: u32,
}

impl Misfit {
    /// How often a right answer fits no better than this, 0 to 1: the upper tail of the chi-square distribution. 1 where there is nothing left to fit.
    pub fn p_value(&self) -> f64 {
        if self.degrees == 0 {
            return 1.0;
        }
        let half = 0.5 * self.chi_square.max(0.0);
        // By steps of two degrees from one or two: Q(k + 2) = Q(k) + half^(k/2) e^-half / Gamma(k/2 + 1).
        let odd = self.degrees % 2 == 1;
        let (mut tail, mut term) = if odd {
            (libm::erfc(half.sqrt()), 2.0 * (half / core::f64::consts::PI).sqrt() * libm::exp(-half))
        } else {
            (libm::exp(-half), half * libm::exp(-half))
        };
        let mut degrees = if odd { 1 } else { 2 };
        while degrees < self.degrees {
            tail += term;
            degrees += 2;
            term *= half / (0.5 * f64::from(degrees));
        }
        tail.min(1.0)
    }
}

impl Problem<'_> {
    /// The misfit at a pose.
    pub(super) fn misfit_of_all(&self, pose: &Pose) -> Misfit {
        let mut chi_square: f64 = self.used().map(|(spot, marker)| self.misfit(pose, spot, marker)).sum();
        let mut residuals = 2 * self.used().count();
        if self.settings.use_brightness {
            let light = Light::of(self, pose);
            chi_square += light.misfit();
            let lit = self.lit();
            residuals += if self.known.power.is_some() { lit } else { lit.saturating_sub(1) };
        }
        if let Some(tilted) = self.tilted(pose) {
            chi_square += tilted.iter().map(|(residual, _)| residual * residual).sum::<f64>();
            residuals += 2;
        }
        Misfit { chi_square, degrees: residuals.saturating_sub(6) as u32 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Quantiles of tables that every textbook has.
    #[test]
    fn p_values_are_those_of_tables() {
        for (degrees, chi_square, p) in [
            (1, 3.841459, 0.05),
            (2, 5.991465, 0.05),
            (3, 7.814728, 0.05),
            (4, 9.487729, 0.05),
            (5, 15.08627, 0.01),
            (8, 2.732637, 0.95),
            (9, 27.87716, 0.001),
            (20, 10.85081, 0.95),
        ] {
            let told = Misfit { chi_square, degrees }.p_value();
            assert!((told / p - 1.0).abs() < 1e-5, "{degrees}: {told} for {p}");
        }
        assert!(Misfit { chi_square: 3.0, degrees: 0 }.p_value() > 1.0 - 1e-12);
        assert!(Misfit { chi_square: 0.0, degrees: 7 }.p_value() > 1.0 - 1e-12);
    }
}
