//! Moffat's profile as a sum of Gaussians: what turbulence, diffusion in silicon and scatter in a lens look like.
//!
//! I(r) = (b - 1) / (pi a^2) (1 + r^2 / a^2)^-b (A. Moffat, Astronomy and Astrophysics 3, 1969) is a Gaussian of variance
//! a^2 / 2t whose t is drawn from a gamma distribution of shape b - 1. The sum over equal steps of ln t reaches that integral
//! to a ten-thousandth, and a sum of Gaussians is integrated over pixels without error.

use super::Gaussian;

/// Longest step of ln t; a narrow distribution takes shorter ones, as long as its sigma.
const LONGEST_STEP: f64 = 0.8;
/// Light in the wings that is left out.
const LEFT_OUT: f64 = 2e-5;

/// The width a of a profile whose full width at half its summit is `fwhm_px`.
fn width_px(fwhm_px: f64, beta: f64) -> f64 {
    0.5 * fwhm_px / (libm::exp2(1.0 / beta) - 1.0).sqrt()
}

/// The Gaussians of a profile; `None` unless the width is positive and `beta` from 1.25 to 20.
pub(super) fn gaussians(fwhm_px: f64, beta: f64) -> Option<Vec<Gaussian>> {
    if !(fwhm_px > 0.0 && fwhm_px.is_finite() && (1.25..=20.0).contains(&beta)) {
        return None;
    }
    let (a_px, shape) = (width_px(fwhm_px, beta), beta - 1.0);
    let weight = |ln_t: f64| libm::exp(shape * ln_t - libm::exp(ln_t));
    // the weight falls as t^shape towards the wings, and faster than any power towards the core
    let first = libm::log(LEFT_OUT * shape) / shape;
    let last = libm::log(shape + 4.0 * shape.sqrt() + 10.0);
    let step = LONGEST_STEP.min(1.0 / shape.sqrt());
    let steps = ((last - first) / step).ceil() as usize;
    let nodes = (0..=steps).map(|index| first + step * index as f64);
    let sum: f64 = nodes.clone().map(weight).sum();
    let parts = nodes
        .map(|ln_t| Gaussian { share: weight(ln_t) / sum, sigma_px: a_px * (0.5 * libm::exp(-ln_t)).sqrt() });
    Some(parts.filter(|part| part.share > 1e-9).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn encircled_light_is_that_of_the_closed_form() {
        for beta in [1.5, 2.5, 3.5, 4.765, 12.0] {
            let (parts, a_px) = (gaussians(0.9, beta).unwrap(), width_px(0.9, beta));
            for radius_px in [0.1, 0.3, 0.45, 0.9, 2.0, 5.0, 15.0] {
                let within: f64 = parts
                    .iter()
                    .map(|part| -part.share * libm::expm1(-0.5 * (radius_px / part.sigma_px).powi(2)))
                    .sum();
                let expected = 1.0 - libm::pow(1.0 + (radius_px / a_px).powi(2), 1.0 - beta);
                assert!(
                    (within - expected).abs() < 4e-4,
                    "{within} not {expected}: {radius_px} px, beta {beta}"
                );
            }
            let summit = |r_px: f64| -> f64 {
                let density = |part: &Gaussian| {
                    part.share / part.sigma_px.powi(2) * libm::exp(-0.5 * (r_px / part.sigma_px).powi(2))
                };
                parts.iter().map(density).sum()
            };
            assert!((summit(0.45) / summit(0.0) - 0.5).abs() < 2e-3, "half its summit at half its width");
        }
        assert_eq!((gaussians(0.0, 2.5), gaussians(1.0, 1.0), gaussians(1.0, f64::NAN)), (None, None, None));
    }
}
