//! Where the light of a saturated spot fell: from its wings alone.
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
#[cfg(not(feature = "std"))]
use crate::float::Float as _;
use crate::lanes::{self, Lanes};

/// Pixels of the wings needed: twice the unknowns.
const FEWEST_PX: f32 = 8.0;
/// Noise below this many sigma is no wings.
const FAINTEST_SIGMAS: f32 = 4.0;
/// ... nor is signal below this, grey levels: ripples of lens and processing.
const FAINTEST_DN: f32 = 6.0;

/// The parabola's summit.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fit {
    pub(super) centre: Pixel,
    pub(super) covariance_px2: Matrix2<f64>,
    /// Squared misfit over degrees of freedom: about 1 where the spot is a Gaussian.
    pub(super) misfit: f64,
}

/// Fits the wings of a saturated spot near `guess`, within `radius_px` of it; `None` where too little of it shows.
pub(super) fn fit(
    patch: &Patch,
    guess: Pixel,
    radius_px: f32,
    saturation: f32,
    variance: PixelVariance,
) -> Option<Fit> {
    let faintest = Lanes::splat(FAINTEST_DN.max(FAINTEST_SIGMAS * variance.dark.sqrt()));
    let saturation = Lanes::splat(saturation);
    let noise = variance.lanes();
    let mut normal = Normal::default();
    for columns in patch.near(patch.local(guess), radius_px) {
        let x = lanes::counting_from(columns.dx);
        let across = x * x;
        let mut sums = ColumnSums::default();
        let mut y = columns.dy;
        for &signal in columns.signal {
            let near = lanes::less(across, Lanes::splat(radius_px * radius_px - y * y));
            let shows = lanes::less(faintest, signal) * lanes::less(signal, saturation) * near;
            if shows != Lanes::ZERO {
                let weight = shows * (signal * signal) / noise.of(signal);
                sums.add(Lanes::splat(y), weight, lanes::ln(signal));
                sums.pixels += shows;
            }
            y += 1.0;
        }
        normal.add(&sums, x);
    }
    normal.solve(guess, f64::from(radius_px))
}

/// Moments down four columns: the parabola's terms differ from column to column by powers of x alone.
#[derive(Clone, Copy, Debug, Default)]
struct ColumnSums {
    pixels: Lanes,
    /// Sums of w y^k, k from 0 to 4.
    weights: [Lanes; 5],
    /// Sums of w ln I y^k, k from 0 to 2.
    values: [Lanes; 3],
    /// Sum of w (ln I)^2.
    squares: Lanes,
}

impl ColumnSums {
    #[inline(always)]
    fn add(&mut self, y: Lanes, weight: Lanes, log: Lanes) {
        let mut term = weight;
        for sum in &mut self.weights {
            *sum += term;
            term *= y;
        }
        let mut term = weight * log;
        self.squares += term * log;
        for sum in &mut self.values {
            *sum += term;
            term *= y;
        }
    }
}

/// The normal equations of the parabola.
#[derive(Clone, Copy, Debug, Default)]
struct Normal {
    pixels: Lanes,
    /// Sums of w times 1, x, y, q, xx, xy, xq, yy, yq, qq.
    weights: [Lanes; 10],
    /// Sums of w ln I times 1, x, y, q, ln I.
    values: [Lanes; 5],
}

impl Normal {
    #[inline(always)]
    fn add(&mut self, columns: &ColumnSums, x: Lanes) {
        let [w, wy, wyy, wyyy, wyyyy] = columns.weights;
        let [l, ly, lyy] = columns.values;
        let xx = x * x;
        let (wq, wyq) = (wyy + xx * w, wyyy + xx * wy);
        let wqq = wyyyy + xx * (wyy + wyy + xx * w);
        let terms = [w, w * x, wy, wq, w * xx, wy * x, wq * x, wyy, wyq, wqq];
        for (sum, term) in self.weights.iter_mut().zip(terms) {
            *sum += term;
        }
        for (sum, term) in self.values.iter_mut().zip([l, l * x, ly, lyy + xx * l, columns.squares]) {
            *sum += term;
        }
        self.pixels += columns.pixels;
    }

    fn solve(&self, guess: Pixel, radius_px: f64) -> Option<Fit> {
        let pixels = lanes::sum(self.pixels);
        if pixels < FEWEST_PX {
            return None;
        }
        let [n, x, y, q, xx, xy, xq, yy, yq, qq] = self.weights.map(|lanes| f64::from(lanes::sum(lanes)));
        #[rustfmt::skip]
        let matrix = Matrix4::new(
            n, x,  y,  q,
            x, xx, xy, xq,
            y, xy, yy, yq,
            q, xq, yq, qq,
        );
        let [l, lx, ly, lq, ll] = self.values.map(|lanes| f64::from(lanes::sum(lanes)));
        let right = Vector4::new(l, lx, ly, lq);
        let inverse = matrix.try_inverse()?;
        let parabola = inverse * right;
        let curvature = parabola[3];
        if !(curvature < 0.0 && inverse.m11 > 0.0) {
            return None;
        }
        let (du, dv) = (-parabola[1] / (2.0 * curvature), -parabola[2] / (2.0 * curvature));
        if libm::hypot(du, dv) > radius_px / 2.0 {
            return None;
        }
        let misfit = (ll - parabola.dot(&right)) / f64::from(pixels - 4.0);
        #[rustfmt::skip]
        let slope = Matrix2x4::new(
            0.0, 0.5, 0.0, du,
            0.0, 0.0, 0.5, dv,
        ) / -curvature;
        let covariance_px2 = slope * inverse * slope.transpose() * misfit.max(1.0);
        Some(Fit { centre: Pixel::new(guess.u + du, guess.v + dv), covariance_px2, misfit })
    }
}
