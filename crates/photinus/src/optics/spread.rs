//! The effective point spread: the share of a point's light in a pixel, by how far its centre is from the point.
//!
//! In: samples four to a pixel, the integration over the pixel included (J. Anderson, I. King, PASP 112, 2000), or Gaussians.
//! Out: shares and their slopes for a whole window of pixels at once. The spline through the samples has its coefficients
//! sorted by phase: all pixels of a window have the same phase, so that each of the 16 coefficients that make a value comes from a
//! plane of its own, in which neighbouring pixels lie side by side.

use super::{OpticsError, check, spline};
use crate::lanes::{LANES, Lanes};

/// Samples per pixel: enough for a Gaussian of 0.3 px to a thousandth of its summit.
const PER_PX: usize = 4;

/// A round part of a point spread, before the integration over pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gaussian {
    /// Share of the light.
    pub share: f64,
    /// Standard deviation, px.
    pub sigma_px: f64,
}

/// How a point of light spreads over pixels, at one place of the image.
#[derive(Clone, Debug, PartialEq)]
pub struct PointSpread {
    /// Shares at steps of a quarter of a pixel, row by row, as given.
    samples: Vec<f64>,
    /// Planes of coefficients, first by the phase of rows, then by that of columns.
    planes: Vec<f32>,
}

impl PointSpread {
    /// How far a spread reaches to every side, px.
    pub const REACH_PX: usize = 12;
    /// Samples per pixel.
    pub const SAMPLES_PER_PX: usize = PER_PX;
    /// Samples along a side.
    pub const SIDE: usize = 2 * PER_PX * Self::REACH_PX + 1;
    /// Entries of a plane along a row: a pixel each, with room for whole lanes.
    const PLANE: usize = (2 * Self::REACH_PX + 4).next_multiple_of(LANES) + LANES;

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
        let mut spread = Self { samples, planes: vec![0.0; PER_PX * PER_PX * Self::PLANE * Self::PLANE] };
        spread.sort_coefficients();
        Ok(spread)
    }

    /// A round spread of Gaussians, each integrated over square pixels.
    ///
    /// # Errors
    /// [`OpticsError`] for shares that are not 0 to 1 or a sigma that is not 0.01 px to 100 px.
    pub fn gaussians(parts: &[Gaussian]) -> Result<Self, OpticsError> {
        let mut samples = vec![0.0; Self::SIDE * Self::SIDE];
        for &Gaussian { share, sigma_px } in parts {
            check("the share of a Gaussian", share, (0.0..=1.0).contains(&share), "0 to 1")?;
            let is_legal = (0.01..=100.0).contains(&sigma_px);
            check("the sigma of a Gaussian", sigma_px, is_legal, "0.01 px to 100 px")?;
            let line = Self::integrated(sigma_px);
            for (row, down) in samples.chunks_exact_mut(Self::SIDE).zip(&line) {
                for (sample, across) in row.iter_mut().zip(&line) {
                    *sample += share * down * across;
                }
            }
        }
        Self::new(samples)
    }

    /// A Gaussian integrated over pixels along a line of samples.
    fn integrated(sigma_px: f64) -> Vec<f64> {
        let scale = 1.0 / (sigma_px * core::f64::consts::SQRT_2);
        let below = |edge_px: f64| 0.5 * libm::erfc(-edge_px * scale);
        let place = |index: usize| index as f64 / PER_PX as f64 - Self::REACH_PX as f64;
        (0..Self::SIDE).map(|index| below(place(index) + 0.5) - below(place(index) - 0.5)).collect()
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
        let placed = self.placed((column - x_px) as f32, (row - y_px) as f32, 0);
        // The window of one pixel lies in the middle; others are so many pixels further.
        f64::from(placed.shifted(column as isize, row as isize).four(0, 0).0.to_array()[0])
    }

    fn sort_coefficients(&mut self) {
        let side = Self::SIDE;
        let mut table = self.samples.clone();
        let mut room = vec![0.0; side];
        for row in table.chunks_exact_mut(side) {
            spline::coefficients(row, &mut room);
        }
        let mut line = vec![0.0; side];
        for column in 0..side {
            for (row, value) in line.iter_mut().enumerate() {
                *value = table[row * side + column];
            }
            spline::coefficients(&mut line, &mut room);
            for (row, value) in line.iter().enumerate() {
                table[row * side + column] = *value;
            }
        }
        // A pixel before the first sample, so that no window begins outside.
        for (row, coefficients) in table.chunks_exact(side).enumerate() {
            for (column, &coefficient) in coefficients.iter().enumerate() {
                let (row, column) = (row + PER_PX, column + PER_PX);
                let plane = (row % PER_PX) * PER_PX + column % PER_PX;
                let entry = (row / PER_PX) * Self::PLANE + column / PER_PX;
                self.planes[plane * Self::PLANE * Self::PLANE + entry] = coefficient as f32;
            }
        }
    }

    /// The spread around a point that is (`u`, `v`) px, at most 1.5 px each, from the middle of a window of `2 reach + 1` pixels;
    /// `reach` is at most [`Self::REACH_PX`] - 2.
    pub(crate) fn placed(&self, u: f32, v: f32, reach: usize) -> Placed<'_> {
        let (column, across, across_slope) = phase(u, reach);
        let (row, down, down_slope) = phase(v, reach);
        let splat = |weights: [f32; 4]| weights.map(Lanes::splat);
        let per_px = |slopes: [f32; 4]| slopes.map(|slope| Lanes::splat(-(PER_PX as f32) * slope));
        Placed {
            planes: &self.planes,
            row,
            column,
            across: splat(across),
            across_slope: per_px(across_slope),
            down: splat(down),
            down_slope: per_px(down_slope),
        }
    }
}

/// The first of four coefficients of the first pixel of a window, and the weights of the four with their slopes.
fn phase(offset_px: f32, reach: usize) -> (usize, [f32; 4], [f32; 4]) {
    // Past the middle sample of the table by so many samples, the room before the first included.
    let middle = (PER_PX * (PointSpread::REACH_PX + 1 - reach)) as f32;
    let at = middle - PER_PX as f32 * offset_px.clamp(-1.5, 1.5);
    let whole = at as usize;
    let (values, slopes) = spline::weights(at - whole as f32);
    (whole - 1, values, slopes)
}

/// A point spread around a point, ready for the pixels of a window.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Placed<'a> {
    planes: &'a [f32],
    row: usize,
    column: usize,
    across: [Lanes; 4],
    across_slope: [Lanes; 4],
    down: [Lanes; 4],
    down_slope: [Lanes; 4],
}

impl Placed<'_> {
    /// Shares of the light in four pixels from `column` on in `row` of the window, and how they change with the place of the
    /// point, 1/px: along columns, along rows.
    #[inline(always)]
    pub(crate) fn four(&self, row: usize, column: usize) -> (Lanes, Lanes, Lanes) {
        let [mut share, mut by_u, mut by_v] = [Lanes::ZERO; 3];
        for (b, (&down, &down_slope)) in self.down.iter().zip(&self.down_slope).enumerate() {
            let y = self.row + b;
            let line = (y / PER_PX + row) * PointSpread::PLANE + column;
            let [mut along, mut along_slope] = [Lanes::ZERO; 2];
            for (a, (&across, &across_slope)) in self.across.iter().zip(&self.across_slope).enumerate() {
                let x = self.column + a;
                let plane = (y % PER_PX) * PER_PX + x % PER_PX;
                let at = plane * PointSpread::PLANE * PointSpread::PLANE + line + x / PER_PX;
                let four =
                    self.planes[at..].first_chunk::<LANES>().map_or(Lanes::ZERO, |&four| Lanes::new(four));
                along += across * four;
                along_slope += across_slope * four;
            }
            share += down * along;
            by_u += down * along_slope;
            by_v += down_slope * along;
        }
        (share, by_u, by_v)
    }

    /// The same for a window so many pixels further on.
    fn shifted(self, columns: isize, rows: isize) -> Self {
        let by = |at: usize, pixels: isize| at.saturating_add_signed(pixels * PER_PX as isize);
        Self { row: by(self.row, rows), column: by(self.column, columns), ..self }
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
        #[test]
        fn shares_are_those_of_the_gaussian(x in -9.0..9.0f64, y in -9.0..9.0f64, sigma_px in 0.3..2.0f64) {
            let spread = PointSpread::gaussians(&[Gaussian { share: 1.0, sigma_px }]).unwrap();
            let summit = share(0.0, 0.0, sigma_px);
            let error = spread.share(x, y) - share(x, y, sigma_px);
            prop_assert!(error.abs() < 1.5e-3 * summit, "{error} of {summit} at {x} {y}, sigma {sigma_px}");
        }

        #[test]
        fn slopes_are_differences_of_shares(u in -1.4..1.4f32, v in -1.4..1.4f32, row in 0usize..9, column in 0usize..6) {
            let parts = [Gaussian { share: 0.6, sigma_px: 0.4 }, Gaussian { share: 0.4, sigma_px: 2.0 }];
            let spread = PointSpread::gaussians(&parts).unwrap();
            let at = |u: f32, v: f32| spread.placed(u, v, 4).four(row, column);
            let step = 2e-3;
            let (_, by_u, by_v) = at(u, v);
            let along_u = (at(u + step, v).0 - at(u - step, v).0) / Lanes::splat(2.0 * step);
            let along_v = (at(u, v + step).0 - at(u, v - step).0) / Lanes::splat(2.0 * step);
            for (slope, difference) in [(by_u, along_u), (by_v, along_v)] {
                for (slope, difference) in slope.to_array().iter().zip(difference.to_array()) {
                    prop_assert!((slope - difference).abs() < 2e-3, "{slope} {difference}");
                }
            }
        }

        #[test]
        fn a_window_holds_the_shares_of_its_pixels(u in -1.4..1.4f32, v in -1.4..1.4f32, reach in 1usize..10) {
            let spread = PointSpread::gaussians(&[Gaussian { share: 1.0, sigma_px: 0.7 }]).unwrap();
            let placed = spread.placed(u, v, reach);
            for row in 0..2 * reach + 1 {
                for column in (0..2 * reach + 1).step_by(LANES) {
                    let (shares, ..) = placed.four(row, column);
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
