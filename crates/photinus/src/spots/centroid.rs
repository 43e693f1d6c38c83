//! Where the light fell: the centre of a window that is balanced on it.
//!
//! In: the signal around a spot and a first guess. Out: the centre with its covariance. The centre (x, y) is where the
//! windowed first moment vanishes,
//!
//! ```text
//! S(x, y) = sum G(r) I (p - c) = 0,   G(r) = (1 - r^2/R^2)^2 for r < R,
//! ```
//!
//! found by Newton's method. A background that is off by a constant cancels, the soft edge makes the answer steady in the
//! phase of the pixel grid, and the covariance follows from the same sums: J^-1 V J^-T, with V the noise of S and J its
//! derivative (the sandwich of an M-estimator), whatever the shape of the spot.

use nalgebra::{Matrix2, Vector2};

use super::patch::Patch;
use crate::camera::Pixel;
use crate::lanes::{self, Lanes};

/// Noise of a pixel with signal s: `dark` + `shot` x max(s, 0) + (`shape` s)^2, grey levels^2.
#[derive(Clone, Copy, Debug)]
pub(super) struct PixelVariance {
    pub(super) dark: f32,
    pub(super) shot: f32,
    /// How far what is seen is from any shape that is known, as a share of the light in a pixel.
    pub(super) shape: f32,
}

impl PixelVariance {
    pub(super) fn lanes(self) -> VarianceLanes {
        let Self { dark, shot, shape } = self;
        VarianceLanes {
            dark: Lanes::splat(dark),
            shot: Lanes::splat(shot),
            shape2: Lanes::splat(shape * shape),
        }
    }
}

/// The same for four pixels.
#[derive(Clone, Copy)]
pub(super) struct VarianceLanes {
    dark: Lanes,
    shot: Lanes,
    shape2: Lanes,
}

impl VarianceLanes {
    #[inline(always)]
    pub(super) fn of(self, signal: Lanes) -> Lanes {
        let signal = lanes::positive(signal);
        self.dark + (self.shot + self.shape2 * signal) * signal
    }
}

/// Balances a window of radius `radius_px` on the light near `guess`: the centre with its covariance, px^2; `None` where
/// there is no light to balance on.
pub(super) fn balance(
    patch: &Patch,
    guess: Pixel,
    radius_px: f32,
    variance: PixelVariance,
) -> Option<(Pixel, Matrix2<f64>)> {
    // Each step squares the error: from a few tenths of a pixel to hundredths to less than a thousandth.
    let first = sums::<false>(patch, guess, radius_px, variance);
    let centre = step(guess, guess, radius_px, first.newton_step()?);
    let sums = sums::<true>(patch, centre, radius_px, variance);
    let inverse = sums.derivative().try_inverse()?;
    let centre = step(centre, guess, radius_px, sums.newton_step()?);
    Some((centre, inverse * sums.noise() * inverse.transpose()))
}

/// One step, never further from the guess than half the window: beyond lies other light.
fn step(from: Pixel, guess: Pixel, radius_px: f32, step: Vector2<f64>) -> Pixel {
    let reach = f64::from(radius_px) / 2.0;
    let within = |at: f64, guess: f64| at.clamp(guess - reach, guess + reach);
    Pixel::new(within(from.u + step.x, guess.u), within(from.v + step.y, guess.v))
}

#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    first: [f32; 2],
    weight: f32,
    slope: [f32; 3],
    noise: [f32; 3],
    radius_px: f32,
}

impl Sums {
    /// dS/dc: the window moves with the centre.
    fn derivative(&self) -> Matrix2<f64> {
        let scale = 4.0 / f64::from(self.radius_px * self.radius_px);
        let [xx, xy, yy] = self.slope.map(|slope| scale * f64::from(slope));
        let weight = f64::from(self.weight);
        Matrix2::new(xx - weight, xy, xy, yy - weight)
    }

    fn noise(&self) -> Matrix2<f64> {
        let [xx, xy, yy] = self.noise.map(f64::from);
        Matrix2::new(xx, xy, xy, yy)
    }

    /// -J^-1 S. Where the window does not hold a peak (J not negative definite) the plain moment of it.
    fn newton_step(&self) -> Option<Vector2<f64>> {
        let first = Vector2::new(f64::from(self.first[0]), f64::from(self.first[1]));
        let derivative = self.derivative();
        if derivative.m11 < 0.0 && derivative.determinant() > 0.0 {
            return derivative.try_inverse().map(|inverse| -(inverse * first));
        }
        let weight = f64::from(self.weight);
        (weight > 0.0).then(|| first / weight)
    }
}

fn sums<const NOISE: bool>(patch: &Patch, centre: Pixel, radius_px: f32, variance: PixelVariance) -> Sums {
    let inverse = Lanes::splat(1.0 / (radius_px * radius_px));
    let variance = variance.lanes();
    let [mut weight, mut first_x, mut first_y] = [Lanes::default(); 3];
    let mut slope = [Lanes::default(); 3];
    let mut noise = [Lanes::default(); 3];
    for near in patch.near(patch.local(centre), radius_px) {
        let dx = lanes::counting_from(near.dx);
        let across = dx * dx;
        let mut row = near.dy;
        for &signal in near.signal {
            let dy = Lanes::splat(row);
            let down = dy * dy;
            let t = lanes::positive(Lanes::ONE - (across + down) * inverse);
            let edge = t * signal;
            let light = t * edge;
            weight += light;
            first_x += light * dx;
            first_y += light * dy;
            slope[0] += edge * across;
            slope[1] += edge * dx * dy;
            slope[2] += edge * down;
            if NOISE {
                let window = t * t;
                let spread = window * window * variance.of(signal);
                noise[0] += spread * across;
                noise[1] += spread * dx * dy;
                noise[2] += spread * down;
            }
            row += 1.0;
        }
    }
    Sums {
        first: [lanes::sum(first_x), lanes::sum(first_y)],
        weight: lanes::sum(weight),
        slope: slope.map(lanes::sum),
        noise: noise.map(lanes::sum),
        radius_px,
    }
}
