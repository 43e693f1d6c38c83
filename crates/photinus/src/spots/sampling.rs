//! What the pixel grid does to the centre of a spot narrower than a pixel, undone as far as the spot itself tells.
//!
//! In: the signal around a spot and the centre of its window. Out: the centre with the grid's pull taken off, and the
//! covariance of what is left. The first moment of a sampled spot is its centre but for what the sampling folds back,
//!
//! ```text
//! measured = c - H / pi sin(2 pi c),   H = exp(-2 pi^2 s^2),
//! ```
//!
//! with H the share of the light's contrast that is left at one period per pixel: nothing above a sigma s of half a
//! pixel, all of it for a point. Which s it is the spot tells by how little of it reaches the column (or row) on the far
//! side of its centre, which for a Gaussian is the tail beyond the near edge of that column.

use core::f64::consts::{PI, TAU};

use nalgebra::{Matrix2, Vector2};

use super::patch::Patch;
use crate::camera::Pixel;

/// A smaller share of the light than this is noise, halo or rounding.
const FAINTEST_SHARE: f64 = 0.004;
/// A spot with less of its light in four pixels is too wide for the grid to pull.
const NARROW_SHARE: f64 = 0.8;
/// The pull is known to this share of itself: cores are not Gaussians, shares are not free of noise.
const UNKNOWN: f64 = 0.6;

/// Takes the grid's pull off a centre with its covariance, px^2, and adds the variance of what is left.
pub(super) fn unfold(patch: &Patch, centre: Pixel, covariance_px2: Matrix2<f64>) -> (Pixel, Matrix2<f64>) {
    let pixel = (centre.u.round() as i32, centre.v.round() as i32);
    let in_two = |shares: &[f64; 3]| shares[1] + shares[0].max(shares[2]);
    let narrow = |[columns, rows]: &[[f64; 3]; 2]| in_two(columns) * in_two(rows) >= NARROW_SHARE;
    let Some([columns, rows]) = patch.shares(pixel).filter(narrow) else {
        return (centre, covariance_px2);
    };
    let u = unfold_axis(centre.u - f64::from(pixel.0), &columns);
    let v = unfold_axis(centre.v - f64::from(pixel.1), &rows);
    let place = Pixel::new(f64::from(pixel.0) + u.phase, f64::from(pixel.1) + v.phase);
    let gain = Matrix2::from_diagonal(&Vector2::new(u.gain, v.gain));
    let left = Matrix2::from_diagonal(&Vector2::new(u.variance_px2, v.variance_px2));
    (place, gain * covariance_px2 * gain + left)
}

/// One axis without the grid's pull.
struct Unfolded {
    /// Where in the middle pixel the light fell, px.
    phase: f64,
    /// How the phase changes with the measured one.
    gain: f64,
    /// Of what is left of the pull.
    variance_px2: f64,
}

/// Takes the pull off the phase measured within the middle pixel, by the shares of the light.
fn unfold_axis(measured: f64, shares: &[f64; 3]) -> Unfolded {
    let far = if measured >= 0.0 { shares[0] } else { shares[2] };
    let mut phase = measured;
    let mut contrast = 0.0;
    for _ in 0..2 {
        let sigma_px = (0.5 + phase.abs()) / tail_sigmas(far.clamp(FAINTEST_SHARE, 0.45));
        contrast = libm::exp(-2.0 * PI * PI * sigma_px * sigma_px);
        phase = (measured + contrast / PI * libm::sin(TAU * phase)).clamp(-0.5, 0.5);
    }
    let pull = UNKNOWN * contrast / (PI * core::f64::consts::SQRT_2);
    let gain = 1.0 / (1.0 - 2.0 * contrast * libm::cos(TAU * phase)).max(0.5);
    Unfolded { phase, gain, variance_px2: pull * pull }
}

/// How many sigma above the mean a normal distribution has a share of itself left, for shares up to a half (Abramowitz and
/// Stegun 26.2.23, to 0.0005).
fn tail_sigmas(share: f64) -> f64 {
    let t = (-2.0 * libm::log(share)).sqrt();
    let above = 2.515_517 + t * (0.802_853 + t * 0.010_328);
    let below = 1.0 + t * (1.432_788 + t * (0.189_269 + t * 0.001_308));
    t - above / below
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The share of a Gaussian in a column.
    fn share(column: f64, centre: f64, sigma_px: f64) -> f64 {
        let below = |edge: f64| 0.5 * libm::erfc((centre - edge) / (sigma_px * core::f64::consts::SQRT_2));
        below(column + 0.5) - below(column - 0.5)
    }

    #[test]
    fn the_pull_of_the_grid_on_a_narrow_gaussian_is_taken_off() {
        for sigma_px in [0.25, 0.3, 0.4, 0.6] {
            for step in -9..=9 {
                let centre = f64::from(step) / 20.0;
                let shares = [-1.0, 0.0, 1.0].map(|column| share(column, centre, sigma_px));
                let measured =
                    (-4..=4).map(|c| f64::from(c) * share(f64::from(c), centre, sigma_px)).sum::<f64>();
                let Unfolded { phase, variance_px2: variance, .. } = unfold_axis(measured, &shares);
                let (before, after) = ((measured - centre).abs(), (phase - centre).abs());
                assert!(after < (0.65 * before).max(0.012), "{sigma_px} {centre}: {before} {after}");
                assert!(after < 3.0 * variance.sqrt() + 0.01, "{sigma_px} {centre}: {after} {variance}");
            }
        }
    }

    #[test]
    fn tails_are_those_of_the_normal_distribution() {
        for share in [0.004, 0.0228, 0.1587, 0.3085, 0.45] {
            let back = 0.5 * libm::erfc(tail_sigmas(share) / core::f64::consts::SQRT_2);
            assert!((back / share - 1.0).abs() < 2e-3, "{share} {back}");
        }
    }
}
