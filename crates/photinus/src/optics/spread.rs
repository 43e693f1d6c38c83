//! The effective point spread: the share of a point's light in a pixel, by how far its centre is from the point.
//!
//! In: samples four to a pixel, the integration over the pixel included (J. Anderson, I. King, PASP 112, 2000), or Gaussians.
//! Out: shares and their slopes for a whole window of pixels at once. The coefficients of the spline through them, eight to a pixel, are
//! sorted by phase along each row: all pixels of a window have the same phase, so that the coefficients that make the values of
//! neighbouring pixels lie side by side.

use alloc::vec;
use alloc::vec::Vec;

use super::{OpticsError, check, spline};
#[cfg(not(feature = "std"))]
use crate::float::Float as _;
use crate::lanes::{LANES, Lanes};
use crate::normal;

/// Samples per pixel.
const PER_PX: usize = 4;
/// Coefficients per pixel: twice as many, so that a Gaussian of 0.3 px, a pixel away from the summit, is right to 0.2 %. With as many as samples it is
/// right to 2.5 %, for where summits are full all light is told by such pixels.
const STEPS_PER_PX: usize = 2 * PER_PX;

/// A round part of a point spread, before the integration over pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gaussian {
    /// Share of the light.
    pub share: f64,
    /// Standard deviation, px.
    pub sigma_px: f64,
}

/// Coefficients along a side.
const STEPS: usize = 2 * STEPS_PER_PX * PointSpread::REACH_PX + 1;

/// Coefficients of the spline along a line, or the values that it goes through.
type Line = [f64; STEPS];

/// Values along a line, with the coefficients of the spline through them.
#[derive(Clone, Debug)]
struct Splined {
    values: Line,
    coefficients: Line,
    /// These with a pixel of room on both sides.
    roomy: [f32; STEPS + 2 * STEPS_PER_PX],
}

impl Splined {
    fn new(values: Line) -> Self {
        let (mut coefficients, mut room) = (values, [0.0; STEPS]);
        spline::coefficients(&mut coefficients, &mut room);
        let mut roomy = [0.0; STEPS + 2 * STEPS_PER_PX];
        for (roomy, coefficient) in roomy[STEPS_PER_PX..].iter_mut().zip(coefficients) {
            *roomy = coefficient as f32;
        }
        Self { values, coefficients, roomy }
    }
}

/// A Gaussian integrated over pixels along a line, and how it changes with the logarithm of its sigma.
#[derive(Clone, Debug)]
pub(crate) struct Profile {
    shares: Splined,
    by_ln_sigma: Splined,
}

impl Profile {
    pub(crate) fn new(sigma_px: f64) -> Self {
        let (mut shares, mut by_ln_sigma) = ([0.0; STEPS], [0.0; STEPS]);
        let edge = |sigmas: f64| (normal::below(sigmas), sigmas * normal::density(sigmas, 1.0));
        for index in 0..STEPS {
            let place_px = index as f64 / STEPS_PER_PX as f64 - PointSpread::REACH_PX as f64;
            let (below, moment) = edge((place_px - 0.5) / sigma_px);
            let (above, moment_above) = edge((place_px + 0.5) / sigma_px);
            (shares[index], by_ln_sigma[index]) = (above - below, moment - moment_above);
        }
        Self { shares: Splined::new(shares), by_ln_sigma: Splined::new(by_ln_sigma) }
    }

    /// The profile around a point that is `offset_px` from the middle of `2 reach + 1` pixels.
    pub(crate) fn placed(&self, offset_px: f32, reach: usize) -> PlacedProfile {
        let (first, spline::Weights { values, slopes, .. }) = beginning(offset_px, reach);
        let mut placed = PlacedProfile::default();
        for pixel in 0..=2 * reach.min(PointSpread::REACH_PX) {
            let sum = |line: &Splined, weights: [f32; 4]| {
                let four = line.roomy[first + pixel * STEPS_PER_PX..].iter();
                weights.into_iter().zip(four).map(|(weight, coefficient)| weight * coefficient).sum::<f32>()
            };
            placed.shares[pixel] = sum(&self.shares, values);
            placed.by_px[pixel] = -(STEPS_PER_PX as f32) * sum(&self.shares, slopes);
            placed.by_ln_sigma[pixel] = sum(&self.by_ln_sigma, values);
        }
        placed
    }
}

/// Pixels along a window, whole lanes.
const ALONG: usize = (2 * PointSpread::REACH_PX + 1).next_multiple_of(LANES);

/// A profile around a point, ready for the pixels along a window.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PlacedProfile {
    shares: [f32; ALONG],
    /// How they change with the place of the point, 1/px, and with the logarithm of sigma.
    by_px: [f32; ALONG],
    by_ln_sigma: [f32; ALONG],
}

impl Default for PlacedProfile {
    fn default() -> Self {
        Self { shares: [0.0; ALONG], by_px: [0.0; ALONG], by_ln_sigma: [0.0; ALONG] }
    }
}

/// A round Gaussian around a point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PlacedGaussian {
    pub(crate) across: PlacedProfile,
    pub(crate) down: PlacedProfile,
}

/// Shares of a round Gaussian in four pixels, and how they change.
#[derive(Clone, Copy, Debug)]
pub(crate) struct GaussianShares {
    pub(crate) share: Lanes,
    /// With the place of the point along columns and rows, 1/px, and with the logarithm of sigma.
    pub(crate) by_u: Lanes,
    pub(crate) by_v: Lanes,
    pub(crate) by_ln_sigma: Lanes,
}

impl PlacedGaussian {
    /// The shares in four pixels from `column` on in `row` of the window.
    #[inline(always)]
    pub(crate) fn four(&self, row: usize, column: usize) -> GaussianShares {
        let across = |line: &[f32; ALONG]| {
            line.get(column..)
                .and_then(<[f32]>::first_chunk::<LANES>)
                .map_or(Lanes::ZERO, |&four| Lanes::new(four))
        };
        let down = |line: &[f32; ALONG]| Lanes::splat(line.get(row).copied().unwrap_or(0.0));
        let (share, share_down) = (across(&self.across.shares), down(&self.down.shares));
        GaussianShares {
            share: share * share_down,
            by_u: across(&self.across.by_px) * share_down,
            by_v: share * down(&self.down.by_px),
            by_ln_sigma: across(&self.across.by_ln_sigma) * share_down + share * down(&self.down.by_ln_sigma),
        }
    }
}

/// How a point of light spreads over pixels, at one place of the image.
#[derive(Clone, Debug)]
pub struct PointSpread {
    /// Shares at steps of a quarter of a pixel, row by row, as given.
    samples: Vec<f64>,
    /// Coefficients of the spline: of each row of samples the columns of one phase after those of another.
    coefficients: Vec<f32>,
}

impl PartialEq for PointSpread {
    fn eq(&self, other: &Self) -> bool {
        self.samples == other.samples
    }
}

impl PointSpread {
    /// How far a spread reaches to every side, px.
    pub const REACH_PX: usize = 12;
    /// Samples per pixel.
    pub const SAMPLES_PER_PX: usize = PER_PX;
    /// Samples along a side.
    pub const SIDE: usize = 2 * PER_PX * Self::REACH_PX + 1;
    /// Coefficients of one phase along a row: a pixel each, with room for whole lanes.
    const PHASE: usize = (2 * Self::REACH_PX + 4).next_multiple_of(LANES) + LANES;
    /// Coefficients of a row.
    const ROW: usize = STEPS_PER_PX * Self::PHASE;

    /// A spread from its samples, row by row, the point in the middle. They are taken as they are: light that they lack is out of reach.
    ///
    /// # Errors
    /// [`OpticsError`] unless there are [`Self::SIDE`] squared of them, finite, with a positive sum.
    pub fn new(samples: Vec<f64>) -> Result<Self, OpticsError> {
        let needed = Self::SIDE * Self::SIDE;
        if samples.len() != needed {
            return Err(OpticsError::Samples { samples: samples.len(), needed });
        }
        let sum: f64 = samples.iter().sum();
        check("the light of a point spread", sum, sum > 0.0 && sum.is_finite(), "more than 0")?;
        let mut spread = Self { samples, ..Self::dark() };
        spread.sort_coefficients();
        Ok(spread)
    }

    /// A round spread of Gaussians, each integrated over square pixels.
    ///
    /// # Errors
    /// [`OpticsError`] for shares that are not 0 to 1 or a sigma that is not 0.01 px to 100 px.
    pub fn gaussians(parts: &[Gaussian]) -> Result<Self, OpticsError> {
        let mut profiles = Vec::with_capacity(parts.len());
        for &Gaussian { share, sigma_px } in parts {
            check("the share of a Gaussian", share, (0.0..=1.0).contains(&share), "0 to 1")?;
            let is_legal = (0.01..=100.0).contains(&sigma_px);
            check("the sigma of a Gaussian", sigma_px, is_legal, "0.01 px to 100 px")?;
            profiles.push(Profile::new(sigma_px));
        }
        let mut spread = Self::dark();
        let parts: Vec<_> = parts.iter().map(|part| part.share).zip(&profiles).collect();
        spread.become_sum(&parts);
        Ok(spread)
    }

    /// No light at all.
    pub(crate) fn dark() -> Self {
        let samples = vec![0.0; Self::SIDE * Self::SIDE];
        // As many rows as there are coefficients in one, and as much after the last as a read of four rows may take.
        let coefficients = vec![0.0; Self::ROW * Self::ROW + FOUR_ROWS];
        Self { samples, coefficients }
    }

    /// Becomes the sum of shares of round Gaussians: the spline through the product of two profiles is the product of their splines.
    pub(crate) fn become_sum(&mut self, parts: &[(f64, &Profile)]) {
        for (row, samples) in self.samples.chunks_exact_mut(Self::SIDE).enumerate() {
            samples.fill(0.0);
            for (share, Profile { shares, .. }) in parts {
                let value = share * shares.values[2 * row];
                for (sample, across) in samples.iter_mut().zip(shares.values.iter().step_by(2)) {
                    *sample += value * across;
                }
            }
        }
        for row in 0..STEPS {
            let mut sums = [0.0; STEPS];
            for (share, Profile { shares, .. }) in parts {
                let coefficient = share * shares.coefficients[row];
                for (sum, across) in sums.iter_mut().zip(&shares.coefficients) {
                    *sum += coefficient * across;
                }
            }
            self.set_row(row, &sums);
        }
    }

    /// Sets the coefficients of a row.
    fn set_row(&mut self, row: usize, coefficients: &Line) {
        // A pixel before the first, so that no window begins outside.
        let row = &mut self.coefficients[(row + STEPS_PER_PX) * Self::ROW..];
        for (column, &coefficient) in coefficients.iter().enumerate() {
            row[place_in_row(column + STEPS_PER_PX)] = coefficient as f32;
        }
    }

    /// The samples, row by row.
    pub fn samples(&self) -> &[f64] {
        &self.samples
    }

    /// Share of the light in a pixel whose centre is (x, y) px from the point; 0 out of reach.
    pub fn share(&self, x_px: f64, y_px: f64) -> f64 {
        let reach = Self::REACH_PX as f64;
        if !(x_px.abs() < reach && y_px.abs() < reach) {
            return 0.0;
        }
        let (column, row) = (x_px.round(), y_px.round());
        // The window of one pixel lies in the middle; others are this many pixels further.
        let across = Along::new((column - x_px) as f32, 0).shifted(column as isize);
        let down = Along::new((row - y_px) as f32, 0).shifted(row as isize);
        f64::from(Placed::new(&self.coefficients, across, down).four(0, 0).share.to_array()[0])
    }

    /// How far apart two points of the same light must be that the middle between them is darker than both by an eighth, px: the
    /// mean of that along columns and along rows. [`Self::REACH_PX`] for a spread without a summit.
    pub fn resolution_px(&self) -> f64 {
        const DIP: f64 = 0.125;
        let middle = Self::SIDE / 2;
        let along = |step: usize| -> f64 {
            let at = |quarters: usize| {
                let [before, after] = [-1, 1].map(|side: isize| {
                    let index = (middle * Self::SIDE + middle) as isize + side * (quarters * step) as isize;
                    self.samples[index as usize]
                });
                0.5 * (before + after)
            };
            // how much darker the middle is than an eighth below the summits, of points 2 k quarters of a pixel apart
            let lacks = |k: usize| (1.0 - DIP) * (at(0) + at(2 * k)) - 2.0 * at(k);
            let apart_px = |k: f64| 2.0 * k / PER_PX as f64;
            let first = (1..=middle / 2).find(|&k| lacks(k) > 0.0);
            first.map_or(Self::REACH_PX as f64, |k| {
                let (here, before) = (lacks(k), lacks(k - 1));
                apart_px(k as f64 - here / (here - before))
            })
        };
        0.5 * (along(1) + along(Self::SIDE))
    }

    /// Makes the coefficients from the samples.
    fn sort_coefficients(&mut self) {
        let (side, mut room) = (Self::SIDE, [0.0; Self::SIDE]);
        let mut refined = |line: &mut [f64; Self::SIDE]| {
            spline::coefficients(line, &mut room);
            let mut twice_as_many = [0.0; STEPS];
            spline::refine(line, &mut twice_as_many);
            twice_as_many
        };
        // Along columns of samples first, each as a row; then along rows of those.
        let mut columns = vec![[0.0; STEPS]; side];
        for (column, refined_column) in columns.iter_mut().enumerate() {
            let mut line = core::array::from_fn(|row| self.samples[row * side + column]);
            *refined_column = refined(&mut line);
        }
        let line = |row: usize| core::array::from_fn(|column| columns[column][row]);
        for (row, mut line) in (0..STEPS).map(line).enumerate() {
            self.set_row(row, &refined(&mut line));
        }
    }

    /// The spread around a point that is (`u`, `v`) px from the middle of a window of `2 reach + 1` pixels. Point and window stay within
    /// reach of the table: what is further is taken for as far as that.
    pub(crate) fn placed(&self, u: f32, v: f32, reach: usize) -> Placed<'_> {
        Placed::new(&self.coefficients, Along::new(u, reach), Along::new(v, reach))
    }
}

/// Where a column of samples has its coefficient in a row.
fn place_in_row(column: usize) -> usize {
    column % STEPS_PER_PX * PointSpread::PHASE + column / STEPS_PER_PX
}

/// The first of the four coefficients of the first pixel of a window, a pixel of room before all of them included, and their weights.
fn beginning(offset_px: f32, reach: usize) -> (usize, spline::Weights) {
    let room = PointSpread::REACH_PX.saturating_sub(reach) as f32;
    let middle = (STEPS_PER_PX * (PointSpread::REACH_PX + 1 - reach.min(PointSpread::REACH_PX))) as f32;
    let at = middle - STEPS_PER_PX as f32 * offset_px.clamp(-room, room);
    let whole = at as usize;
    (whole - 1, spline::weights(at - whole as f32))
}

/// Where the coefficients of a window lie along one axis, and their weights.
#[derive(Clone, Copy, Debug)]
struct Along {
    /// First of the four coefficients of the first pixel.
    first: usize,
    values: [Lanes; 4],
    /// How the values change with the place of the point, 1/px.
    slopes: [Lanes; 4],
    /// How the slopes do, 1/px^2.
    curvatures: [Lanes; 4],
}

impl Along {
    fn new(offset_px: f32, reach: usize) -> Self {
        let (first, weights) = beginning(offset_px, reach);
        let scaled = |weights: [f32; 4], by: f32| weights.map(|weight| Lanes::splat(by * weight));
        let per_px = STEPS_PER_PX as f32;
        Self {
            first,
            values: scaled(weights.values, 1.0),
            slopes: scaled(weights.slopes, -per_px),
            curvatures: scaled(weights.curvatures, per_px * per_px),
        }
    }

    fn shifted(self, pixels: isize) -> Self {
        Self { first: self.first.saturating_add_signed(pixels * STEPS_PER_PX as isize), ..self }
    }
}

/// Coefficients that make the values of a row of pixels, as far as any column begins, and four more.
const FOUR_ROWS: usize = 4 * PointSpread::ROW + LANES;

/// A point spread around a point, ready for the pixels of a window.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Placed<'a> {
    /// The coefficients from those of the first row of pixels on.
    coefficients: &'a [f32],
    /// Where those of the first pixel are in a row.
    columns: [usize; 4],
    across: Along,
    down: Along,
}

/// Shares of light in four pixels, and how they change.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shares {
    pub(crate) share: Lanes,
    /// With the place of the point along columns and rows, 1/px.
    pub(crate) by_u: Lanes,
    pub(crate) by_v: Lanes,
    /// With the variance of a source that is no point, 1/px^2: half the Laplacian.
    pub(crate) by_variance: Lanes,
}

impl<'a> Placed<'a> {
    fn new(coefficients: &'a [f32], across: Along, down: Along) -> Self {
        let coefficients = coefficients.get(down.first * PointSpread::ROW..).unwrap_or_default();
        let columns = core::array::from_fn(|a| place_in_row(across.first + a));
        Self { coefficients, columns, across, down }
    }

    /// The shares in four pixels from `column` on in `row` of the window.
    #[inline(always)]
    pub(crate) fn four(&self, row: usize, column: usize) -> Shares {
        let [mut share, mut by_u, mut by_v, mut by_uu, mut by_vv] = [Lanes::ZERO; 5];
        let rows = self.coefficients.get(STEPS_PER_PX * row * PointSpread::ROW..);
        let Some(rows) = rows.and_then(<[f32]>::first_chunk::<FOUR_ROWS>) else {
            return Shares { share, by_u, by_v, by_variance: Lanes::ZERO };
        };
        // Modulo a power of two that no column reaches, which tells the compiler that four more are there.
        let columns = self.columns.map(|first| (first + column) % PointSpread::ROW);
        for b in 0..4 {
            let [mut along, mut slope, mut curvature] = [Lanes::ZERO; 3];
            for (a, first) in columns.into_iter().enumerate() {
                let at = b * PointSpread::ROW + first;
                let four = Lanes::new([rows[at], rows[at + 1], rows[at + 2], rows[at + 3]]);
                along += self.across.values[a] * four;
                slope += self.across.slopes[a] * four;
                curvature += self.across.curvatures[a] * four;
            }
            share += self.down.values[b] * along;
            by_u += self.down.values[b] * slope;
            by_v += self.down.slopes[b] * along;
            by_uu += self.down.values[b] * curvature;
            by_vv += self.down.curvatures[b] * along;
        }
        Shares { share, by_u, by_v, by_variance: Lanes::splat(0.5) * (by_uu + by_vv) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Share of a Gaussian in a pixel, by its closed form.
    fn share(x_px: f64, y_px: f64, sigma_px: f64) -> f64 {
        let below = |edge: f64| 0.5 * libm::erfc(-edge / (sigma_px * core::f64::consts::SQRT_2));
        (below(x_px + 0.5) - below(x_px - 0.5)) * (below(y_px + 0.5) - below(y_px - 0.5))
    }

    proptest! {
        /// The spline through a sum of products, against that through its samples, where these are enough.
        #[test]
        fn a_sum_of_products_is_that_of_its_samples(core_px in 1.2..1.6f64, wider in 1.0..1.4f64, halo in 0.0..1.0f64) {
            let parts = [(1.0 - halo, core_px), (halo, core_px * wider)];
            let sum = PointSpread::gaussians(&parts.map(|(share, sigma_px)| Gaussian { share, sigma_px })).unwrap();
            let sampled = PointSpread::new(sum.samples().to_vec()).unwrap();
            for (a, b) in sum.coefficients.iter().zip(&sampled.coefficients) {
                prop_assert!((a - b).abs() < 1e-5, "{a} {b}");
            }
        }

        #[test]
        fn shares_are_those_of_the_gaussian(x in -9.0..9.0f64, y in -9.0..9.0f64, sigma_px in 0.3..2.0f64) {
            let spread = PointSpread::gaussians(&[Gaussian { share: 1.0, sigma_px }]).unwrap();
            let summit = share(0.0, 0.0, sigma_px);
            let error = spread.share(x, y) - share(x, y, sigma_px);
            prop_assert!(error.abs() < 1e-4 * summit, "{error} of {summit} at {x} {y}, sigma {sigma_px}");
        }

        #[test]
        fn a_placed_gaussian_is_its_spread(
            u in -1.4..1.4f32, v in -1.4..1.4f32, row in 0usize..21, column in 0usize..20, sigma_px in 0.25..2.0f64,
        ) {
            let four = |u: f32, v: f32, sigma_px: f64| {
                let profile = Profile::new(sigma_px);
                PlacedGaussian { across: profile.placed(u, 10), down: profile.placed(v, 10) }.four(row, column)
            };
            let here = four(u, v, sigma_px);
            let spread = PointSpread::gaussians(&[Gaussian { share: 1.0, sigma_px }]).unwrap();
            let told = spread.placed(u, v, 10).four(row, column);
            let (step, half) = (1e-2, Lanes::splat(0.5 / 1e-2));
            let wider = |by: f64| four(u, v, sigma_px * libm::exp(by)).share;
            let by_ln_sigma = (wider(step) - wider(-step)) * half;
            let pairs = [(here.share, told.share), (here.by_u, told.by_u), (here.by_v, told.by_v), (here.by_ln_sigma, by_ln_sigma)];
            for (number, (one, other)) in pairs.into_iter().enumerate() {
                let allowed = if number < 3 { 1e-5 } else { 1e-3 };
                for (one, other) in one.to_array().into_iter().zip(other.to_array()) {
                    prop_assert!((one - other).abs() < allowed, "{number}: {one} {other}");
                }
            }
        }

        #[test]
        fn slopes_are_differences_of_shares(u in -1.4..1.4f32, v in -1.4..1.4f32, row in 0usize..9, column in 0usize..6) {
            let parts = [Gaussian { share: 0.6, sigma_px: 0.4 }, Gaussian { share: 0.4, sigma_px: 2.0 }];
            let spread = PointSpread::gaussians(&parts).unwrap();
            let at = |u: f32, v: f32| spread.placed(u, v, 4).four(row, column);
            let step = 2e-3;
            let here = at(u, v);
            let half = Lanes::splat(0.5 / step);
            let along_u = (at(u + step, v).share - at(u - step, v).share) * half;
            let along_v = (at(u, v + step).share - at(u, v - step).share) * half;
            let bent = (at(u + step, v).by_u - at(u - step, v).by_u + at(u, v + step).by_v - at(u, v - step).by_v)
                * half * Lanes::splat(0.5);
            for (slope, difference) in [(here.by_u, along_u), (here.by_v, along_v), (here.by_variance, bent)] {
                for (slope, difference) in slope.to_array().iter().zip(difference.to_array()) {
                    prop_assert!((slope - difference).abs() < 4e-3, "{slope} {difference}");
                }
            }
        }

        #[test]
        fn a_window_holds_the_shares_of_its_pixels(u in -1.4..1.4f32, v in -1.4..1.4f32, reach in 1usize..10) {
            let spread = PointSpread::gaussians(&[Gaussian { share: 1.0, sigma_px: 0.7 }]).unwrap();
            let placed = spread.placed(u, v, reach);
            for row in 0..2 * reach + 1 {
                for column in (0..2 * reach + 1).step_by(LANES) {
                    let shares = placed.four(row, column).share;
                    for (i, window) in shares.to_array().into_iter().enumerate() {
                        let x = (column + i) as f64 - reach as f64 - f64::from(u);
                        let y = row as f64 - reach as f64 - f64::from(v);
                        prop_assert!((f64::from(window) - share(x, y, 0.7)).abs() < 1e-3);
                    }
                }
            }
        }
    }

    #[test]
    fn what_is_no_spread_does_not_construct() {
        let side = PointSpread::SIDE * PointSpread::SIDE;
        for samples in [vec![1.0; 5], vec![0.0; side], vec![f64::NAN; side], vec![-1.0; side]] {
            assert!(PointSpread::new(samples).is_err());
        }
        assert!(PointSpread::gaussians(&[Gaussian { share: 1.0, sigma_px: 0.0 }]).is_err());
        assert!(PointSpread::gaussians(&[Gaussian { share: 2.0, sigma_px: 1.0 }]).is_err());
    }
}
