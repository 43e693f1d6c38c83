//! Where the light of a saturated spot fell: from its skirt alone.
//!
//! In: the signal around a spot whose core reads 255. Out: the centre with its covariance. Inside the core nothing tells
//! where the light fell, so only unsaturated pixels count. Around it the logarithm of a round spot's light is close to a
//! parabola,
//!
//! ```text
//! ln I = a + b x + c y + q (x^2 + y^2),   centre = (-b, -c) / 2 q,
//! ```
//!
//! which is linear in its four numbers: one weighted least-squares solution, weight I^2 / var(I), reaches the information
//! bound for a Gaussian spot. A spot of another shape that looks the same turned by half a turn has the same centre;
//! its misfit widens the covariance.

use nalgebra::{Matrix2, Matrix2x4, Matrix4, Vector4};

use super::centroid::PixelVariance;
use super::patch::Patch;
use crate::camera::Pixel;

/// Steps of the table of logarithms per grey level: backgrounds are rounded to them.
const STEPS_PER_LEVEL: usize = 16;
/// Skirt pixels needed: twice the unknowns.
const FEWEST_PX: u32 = 8;
/// Noise below this many sigma is no skirt.
const FAINTEST_SIGMAS: f32 = 4.0;
/// ... nor is signal below this, grey levels: ripples of lens and processing.
const FAINTEST_DN: f32 = 6.0;

/// Logarithms of all signals there are, so that no pixel computes one.
#[derive(Debug)]
pub(super) struct Logarithms(Vec<f32>);

impl Logarithms {
    pub(super) fn new() -> Self {
        let log = |step: usize| libm::log(step as f64 / STEPS_PER_LEVEL as f64) as f32;
        Self((0..=256 * STEPS_PER_LEVEL).map(log).collect())
    }

    #[inline]
    fn of(&self, signal: f32) -> f32 {
        self.0[(signal * STEPS_PER_LEVEL as f32) as usize]
    }
}

/// Fits the skirt of a saturated spot near `guess`, within `radius_px` of it; `None` where too little of it shows.
pub(super) fn fit(
    patch: &Patch,
    guess: Pixel,
    radius_px: f32,
    saturation: f32,
    variance: PixelVariance,
    logarithms: &Logarithms,
) -> Option<(Pixel, Matrix2<f64>)> {
    let x0 = (guess.u - f64::from(patch.left)) as f32;
    let y0 = (guess.v - f64::from(patch.top)) as f32;
    let faintest = FAINTEST_DN.max(FAINTEST_SIGMAS * variance.dark.sqrt());
    let mut normal = Normal::default();
    for ((_, row), j) in patch.rows().zip(0u16..) {
        let y = f32::from(j) - y0;
        let half = (radius_px * radius_px - y * y).max(0.0).sqrt();
        let first = (x0 - half).ceil().max(0.0) as usize;
        let end = ((x0 + half).floor() + 1.0).clamp(0.0, row.len() as f32) as usize;
        for (i, &signal) in row.iter().enumerate().take(end).skip(first) {
            if signal > faintest && signal < saturation {
                let weight = signal * signal / (variance.dark + variance.shot * signal);
                normal.add(i as f32 - x0, y, weight, logarithms.of(signal));
            }
        }
    }
    normal.solve(guess, f64::from(radius_px))
}

/// The normal equations of the parabola, by moments of the weighted pixels.
#[derive(Clone, Copy, Debug, Default)]
struct Normal {
    pixels: u32,
    /// Sums of w times 1, x, y, q, xx, xy, xq, yy, yq, qq.
    weights: [f64; 10],
    /// Sums of w ln I times 1, x, y, q, ln I.
    values: [f64; 5],
}

impl Normal {
    #[inline]
    fn add(&mut self, x: f32, y: f32, weight: f32, log: f32) {
        let (x, y, weight, log) = (f64::from(x), f64::from(y), f64::from(weight), f64::from(log));
        let q = x * x + y * y;
        let (wx, wy, wq, wl) = (weight * x, weight * y, weight * q, weight * log);
        let terms = [weight, wx, wy, wq, wx * x, wx * y, wx * q, wy * y, wy * q, wq * q];
        for (sum, term) in self.weights.iter_mut().zip(terms) {
            *sum += term;
        }
        for (sum, term) in self.values.iter_mut().zip([wl, wl * x, wl * y, wl * q, wl * log]) {
            *sum += term;
        }
        self.pixels += 1;
    }

    fn solve(&self, guess: Pixel, radius_px: f64) -> Option<(Pixel, Matrix2<f64>)> {
        if self.pixels < FEWEST_PX {
            return None;
        }
        let [n, x, y, q, xx, xy, xq, yy, yq, qq] = self.weights;
        #[rustfmt::skip]
        let matrix = Matrix4::new(
            n, x,  y,  q,
            x, xx, xy, xq,
            y, xy, yy, yq,
            q, xq, yq, qq,
        );
        let [l, lx, ly, lq, ll] = self.values;
        let right = Vector4::new(l, lx, ly, lq);
        let inverse = matrix.cholesky()?.inverse();
        let parabola = inverse * right;
        let curvature = parabola[3];
        if curvature >= 0.0 {
            return None;
        }
        let (du, dv) = (-parabola[1] / (2.0 * curvature), -parabola[2] / (2.0 * curvature));
        if libm::hypot(du, dv) > radius_px / 2.0 {
            return None;
        }
        let misfit = (ll - parabola.dot(&right)) / f64::from(self.pixels - 4);
        #[rustfmt::skip]
        let slope = Matrix2x4::new(
            0.0, 0.5, 0.0, du,
            0.0, 0.0, 0.5, dv,
        ) / -curvature;
        let covariance = slope * inverse * slope.transpose() * misfit.max(1.0);
        Some((Pixel::new(guess.u + du, guess.v + dv), covariance))
    }
}
