//! A point spread while it is learned: samples four to a pixel, and the cubic spline through them in full precision.

use photinus::optics::{Gaussian, PointSpread};

use super::noise::Noise;
use super::window::REACH;

/// Samples per pixel.
pub(super) const PER_PX: usize = PointSpread::SAMPLES_PER_PX;
/// Samples along a side.
pub(super) const SIDE: usize = PointSpread::SIDE;
/// Samples.
pub(super) const COUNT: usize = SIDE * SIDE;
/// The sample at the point.
pub(super) const MIDDLE: usize = SIDE / 2;
/// Farthest that a point may be from the middle of its window, px.
pub(super) const FARTHEST_PX: f64 = 2.5;
/// Coefficients around the table that are 0, so that no window begins outside.
const ROOM: usize = 12;
const ACROSS: usize = SIDE + 2 * ROOM;

/// A table of shares.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Table {
    pub(super) samples: Vec<f64>,
    coefficients: Vec<f64>,
}

/// The share of a pixel, and how it changes with the place of the point, 1/px.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Share {
    pub(super) value: f64,
    pub(super) by_u: f64,
    pub(super) by_v: f64,
}

/// Shares of a window, row by row, this many pixels to every side.
#[derive(Clone, Debug, Default)]
pub(super) struct Shares {
    pub(super) reach: usize,
    pub(super) of_pixels: Vec<Share>,
    lines: Vec<[f64; 2]>,
}

impl Shares {
    /// That of a pixel this many columns and rows from the middle.
    pub(super) fn at(&self, column: isize, row: isize) -> &Share {
        let index = |offset: isize| (self.reach as isize + offset) as usize;
        &self.of_pixels[index(row) * (2 * self.reach + 1) + index(column)]
    }
}

/// Place of a sample along an axis, px.
pub(super) fn place_px(index: usize) -> f64 {
    (index as f64 - MIDDLE as f64) / PER_PX as f64
}

/// Distance of a sample from the point, px.
pub(super) fn radius_px(index: usize) -> f64 {
    libm::hypot(place_px(index % SIDE), place_px(index / SIDE))
}

impl Table {
    /// The table of these samples.
    pub(super) fn new(samples: Vec<f64>) -> Self {
        let mut table = Self { samples, coefficients: vec![0.0; ACROSS * ACROSS] };
        table.renew();
        table
    }

    /// A round one of Gaussians.
    pub(super) fn gaussians(parts: &[Gaussian]) -> Self {
        let spread = PointSpread::gaussians(parts).expect("shares and widths within what a search allows");
        Self::new(spread.samples().to_vec())
    }

    /// The spline's coefficient at a sample.
    pub(super) fn coefficient(&self, sample: usize) -> f64 {
        self.coefficients[(sample / SIDE + ROOM) * ACROSS + sample % SIDE + ROOM]
    }

    /// Adds to the coefficients; samples follow.
    pub(super) fn change(&mut self, by: &[f64]) {
        let at = |sample: usize| (sample / SIDE + ROOM) * ACROSS + sample % SIDE + ROOM;
        by.iter().enumerate().for_each(|(sample, by)| self.coefficients[at(sample)] += by);
        let c = &self.coefficients;
        let line = |k: usize| (c[k - 1] + 4.0 * c[k] + c[k + 1]) / 6.0;
        for sample in 0..COUNT {
            let k = at(sample);
            self.samples[sample] = (line(k - ACROSS) + 4.0 * line(k) + line(k + ACROSS)) / 6.0;
        }
    }

    /// The spline through changed samples.
    pub(super) fn renew(&mut self) {
        let mut spline = self.samples.clone();
        let mut line = [0.0; SIDE];
        for row in spline.chunks_exact_mut(SIDE) {
            coefficients(row);
        }
        for column in 0..SIDE {
            (0..SIDE).for_each(|row| line[row] = spline[row * SIDE + column]);
            coefficients(&mut line);
            for (row, &value) in line.iter().enumerate() {
                self.coefficients[(row + ROOM) * ACROSS + column + ROOM] = value;
            }
        }
    }

    /// Fills in the shares of a window around a point that is (`u`, `v`) px from its middle.
    pub(super) fn window(&self, u: f64, v: f64, reach: usize, onto: &mut Shares) {
        let reach = reach.min(REACH);
        let (column, across, across_slope) = phase(u, reach);
        let (row, down, down_slope) = phase(v, reach);
        let side = 2 * reach + 1;
        onto.reach = reach;
        onto.of_pixels.clear();
        for line in 0..side {
            onto.lines.clear();
            let first = (row + PER_PX * line) * ACROSS + column;
            for at in first..first + PER_PX * (side - 1) + 4 {
                let four = [0, 1, 2, 3].map(|b| self.coefficients[at + b * ACROSS]);
                onto.lines.push([dot(&down, &four), dot(&down_slope, &four)]);
            }
            let lines = &onto.lines;
            onto.of_pixels.extend(lines.windows(4).step_by(PER_PX).map(|four| {
                let (along, slopes) =
                    ([0, 1, 2, 3].map(|a: usize| four[a][0]), [0, 1, 2, 3].map(|a: usize| four[a][1]));
                Share {
                    value: dot(&across, &along),
                    by_u: dot(&across_slope, &along),
                    by_v: dot(&across, &slopes),
                }
            }));
        }
    }

    /// Where its light is, px.
    pub(super) fn centroid_px(&self) -> [f64; 2] {
        let (mut sum, mut u, mut v) = (0.0, 0.0, 0.0);
        for (index, share) in self.samples.iter().enumerate() {
            sum += share;
            u += share * place_px(index % SIDE);
            v += share * place_px(index / SIDE);
        }
        [u / sum, v / sum]
    }

    /// Settles a table that was learnt in noise. Where that is seen, samples of no light are below 0 as often as above, and were these cut off, noise would come out as
    /// light of the wings; where darkness is cut off, nothing tells how far below it a sample is, and it is dark.
    pub(super) fn settle_in(&mut self, noise: &Noise) {
        if !noise.is_dark_seen {
            self.samples.iter_mut().for_each(|share| *share = share.max(0.0));
        }
        self.settle();
        self.become_even();
    }

    /// Scales the light to 1, and moves its centroid to the point.
    pub(super) fn settle(&mut self) {
        let [u, v] = self.centroid_px();
        if u.abs().max(v.abs()) > 1e-6 {
            self.renew();
            self.move_by(u.clamp(-1.0, 1.0), v.clamp(-1.0, 1.0));
        }
        let sum = self.samples.iter().sum::<f64>() / (PER_PX * PER_PX) as f64;
        self.samples.iter_mut().for_each(|share| *share /= sum);
        self.renew();
    }

    /// All pixels together see as much light wherever in a pixel it falls: as the light of each spot is free, no frame tells otherwise.
    fn become_even(&mut self) {
        let phase = |sample: usize| sample / SIDE % PER_PX * PER_PX + sample % SIDE % PER_PX;
        let mut sums = [0.0; PER_PX * PER_PX];
        self.samples.iter().enumerate().for_each(|(sample, share)| sums[phase(sample)] += share);
        self.samples.iter_mut().enumerate().for_each(|(sample, share)| *share /= sums[phase(sample)]);
        self.renew();
    }

    /// Takes every sample from (`u`, `v`) px further on.
    fn move_by(&mut self, u: f64, v: f64) {
        let phase = |px: f64| {
            let at = PER_PX as f64 * px;
            (at.floor() as isize - 1, weights(at - at.floor()).0)
        };
        let ((right, across), (below, down)) = (phase(u), phase(v));
        for index in 0..COUNT {
            let (column, row) = (index % SIDE, index / SIDE);
            let first = (row + ROOM).saturating_add_signed(below) * ACROSS
                + (column + ROOM).saturating_add_signed(right);
            let line = |b: usize| {
                let four = [0, 1, 2, 3].map(|a| self.coefficients[first + b * ACROSS + a]);
                dot(&across, &four)
            };
            self.samples[index] = dot(&down, &[line(0), line(1), line(2), line(3)]);
        }
    }
}

fn dot(a: &[f64; 4], b: &[f64; 4]) -> f64 {
    (a[0] * b[0] + a[1] * b[1]) + (a[2] * b[2] + a[3] * b[3])
}

/// Turns samples into the coefficients of the cubic spline through them (M. Unser, IEEE SPM 16, 1999), nothing outside.
fn coefficients(samples: &mut [f64]) {
    let mut factors = [0.0; SIDE];
    let (mut factor, mut before) = (0.0, 0.0);
    for (sample, kept) in samples.iter_mut().zip(&mut factors) {
        factor = 1.0 / (4.0 - factor);
        before = (6.0 * *sample - before) * factor;
        (*sample, *kept) = (before, factor);
    }
    let mut after = 0.0;
    for (sample, factor) in samples.iter_mut().zip(&factors).rev() {
        *sample -= factor * after;
        after = *sample;
    }
}

/// Weights of four coefficients and their slopes, a share `t` of the way from the second to the third.
pub(super) fn weights(t: f64) -> ([f64; 4], [f64; 4]) {
    let s = 1.0 - t;
    let values = [
        s * s * s / 6.0,
        (4.0 - 6.0 * t * t + 3.0 * t * t * t) / 6.0,
        (4.0 - 6.0 * s * s + 3.0 * s * s * s) / 6.0,
        t * t * t / 6.0,
    ];
    (values, [-0.5 * s * s, 1.5 * t * t - 2.0 * t, 2.0 * s - 1.5 * s * s, 0.5 * t * t])
}

/// The first of four coefficients of a window's first pixel, their weights, and slopes with the place of the point.
fn phase(offset_px: f64, reach: usize) -> (usize, [f64; 4], [f64; 4]) {
    let middle = (ROOM + MIDDLE - PER_PX * reach) as f64;
    let at = middle - PER_PX as f64 * offset_px.clamp(-FARTHEST_PX, FARTHEST_PX);
    let (values, slopes) = weights(at - at.floor());
    (at.floor() as usize - 1, values, slopes.map(|slope| -(PER_PX as f64) * slope))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_are_those_of_the_method_and_slopes_their_differences() {
        let parts = [Gaussian { share: 0.7, sigma_px: 0.4 }, Gaussian { share: 0.3, sigma_px: 2.0 }];
        let table = Table::gaussians(&parts);
        // Of as few samples as the table has.
        let samples = PointSpread::gaussians(&parts).unwrap().samples().to_vec();
        let spread = PointSpread::new(samples).unwrap();
        let shares = |u: f64, v: f64, reach: usize| {
            let mut shares = Shares::default();
            table.window(u, v, reach, &mut shares);
            shares
        };
        for (u, v, reach) in [(0.0, 0.0, 12), (0.31, -0.47, 12), (-1.4, 1.3, 5), (0.5, 0.25, 3)] {
            let here = shares(u, v, reach);
            let step = 1e-4;
            let (right, left) = (shares(u + step, v, reach), shares(u - step, v, reach));
            let (below, above) = (shares(u, v + step, reach), shares(u, v - step, reach));
            for row in -3..=3 {
                for column in -3..=3 {
                    let share = here.at(column, row);
                    let expected = spread.share(column as f64 - u, row as f64 - v);
                    assert!((share.value - expected).abs() < 1e-6, "{share:?} {expected}");
                    let slope = |a: &Shares, b: &Shares| {
                        (a.at(column, row).value - b.at(column, row).value) / (2.0 * step)
                    };
                    assert!((share.by_u - slope(&right, &left)).abs() < 1e-4);
                    assert!((share.by_v - slope(&below, &above)).abs() < 1e-4);
                }
            }
        }
    }

    const NOISE: Noise = Noise { dark: 0.44, shot: 0.03, shape: 0.0, bend: 0.0, is_dark_seen: true };

    #[test]
    fn noise_of_a_settled_table_is_no_light() {
        let mut table = Table::gaussians(&[Gaussian { share: 1.0, sigma_px: 0.5 }]);
        table.move_by(-0.3, 0.2);
        let is_dark = |sample: usize| (4.0..8.0).contains(&radius_px(sample));
        for sample in (0..COUNT).filter(|sample| is_dark(*sample)) {
            let pixel = sample % SIDE / PER_PX + sample / SIDE / PER_PX;
            table.samples[sample] += if pixel.is_multiple_of(2) { 1e-3 } else { -1e-3 };
        }
        table.settle_in(&NOISE);
        let light: f64 =
            (0..COUNT).filter(|sample| is_dark(*sample)).map(|sample| table.samples[sample]).sum();
        assert!((light / (PER_PX * PER_PX) as f64).abs() < 1e-3, "{light} where there is none");
    }

    #[test]
    fn pixels_see_all_of_a_settled_table_wherever_in_a_pixel_it_is() {
        let mut table = Table::gaussians(&[Gaussian { share: 1.0, sigma_px: 0.5 }]);
        let unevenly = |sample: usize| 1.0 + 0.1 * f64::from(sample % SIDE % PER_PX == 1);
        table.samples.iter_mut().enumerate().for_each(|(sample, share)| *share *= unevenly(sample));
        table.settle_in(&NOISE);
        let mut shares = Shares::default();
        for (u, v) in [(0.0, 0.0), (0.25, 0.5), (-0.1, 0.33), (0.45, -0.2)] {
            table.window(u, v, REACH, &mut shares);
            let all: f64 = shares.of_pixels.iter().map(|share| share.value).sum();
            assert!((all - 1.0).abs() < 2e-3, "{all} of the light at ({u}, {v})");
        }
    }

    #[test]
    fn a_settled_table_has_its_light_at_the_point() {
        let mut table = Table::gaussians(&[Gaussian { share: 1.0, sigma_px: 0.8 }]);
        table.renew();
        table.move_by(-0.3, 0.2);
        let [u, v] = table.centroid_px();
        assert!((u - 0.3).abs() < 1e-6 && (v + 0.2).abs() < 1e-6, "{u} {v}");
        table.settle();
        let [u, v] = table.centroid_px();
        assert!(libm::hypot(u, v) < 1e-6, "{u} {v}");
    }
}
