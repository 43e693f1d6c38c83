//! A point spread as a table: what was measured of a real lens, at steps finer than a pixel.
//!
//! The table is the *effective* point spread (J. Anderson, I. King, PASP 112, 2000): the share of the light that a pixel
//! gets whose centre is (x, y) from the point, the integration over the pixel included. Drawing is looking it up.

use super::PointLight;
use crate::sensor::Charge;

/// Shares of the light on a square grid about the point.
#[derive(Clone, Debug, PartialEq)]
pub struct SampledSpread {
    samples_per_px: usize,
    side: usize,
    shares: Vec<f64>,
    variance_px2: f64,
}

impl SampledSpread {
    /// Most samples along a side.
    pub const MAX_SIDE: usize = 1001;

    /// A table from its rows, `samples_per_px` of them per pixel, the point in the middle of the middle row. It is scaled so
    /// that the light sums to 1. `None` unless it is square with an odd side, at least a pixel wide to every side of the point,
    /// finite, nowhere negative and somewhere positive, with 1 to 16 samples per pixel.
    pub fn new(samples_per_px: usize, rows: &[Vec<f64>]) -> Option<Self> {
        let side = rows.len();
        let square = side % 2 == 1 && side <= Self::MAX_SIDE && rows.iter().all(|row| row.len() == side);
        if !(square && (1..=16).contains(&samples_per_px) && side > 2 * samples_per_px) {
            return None;
        }
        let values = || rows.iter().flatten().copied();
        let per_sample = 1.0 / (samples_per_px * samples_per_px) as f64;
        let sum = values().sum::<f64>() * per_sample;
        if !(values().all(|share| share >= 0.0) && sum > 0.0 && sum.is_finite()) {
            return None;
        }
        let shares: Vec<f64> = values().map(|share| share / sum).collect();
        let middle = (side / 2) as f64;
        let square_px = |index: usize| {
            let (x, y) = ((index % side) as f64 - middle, (index / side) as f64 - middle);
            (x * x + y * y) * per_sample
        };
        let variance_px2 =
            0.5 * shares.iter().enumerate().map(|(i, share)| share * square_px(i)).sum::<f64>() * per_sample;
        Some(Self { samples_per_px, side, shares, variance_px2 })
    }

    /// Mean of the variances along u and v, that of the pixel (1/12) included, px^2.
    pub fn variance_px2(&self) -> f64 {
        self.variance_px2
    }

    /// Centroid of the light as seen from the point, (u, v) in px.
    pub fn centroid_px(&self) -> [f64; 2] {
        let middle = (self.side / 2) as f64;
        let per_px = self.samples_per_px as f64;
        let mut sums = [0.0; 2];
        for (index, share) in self.shares.iter().enumerate() {
            sums[0] += share * ((index % self.side) as f64 - middle);
            sums[1] += share * ((index / self.side) as f64 - middle);
        }
        // The shares of the light sum to 1 over a pixel's samples.
        sums.map(|sum| sum / (per_px * per_px * per_px))
    }

    /// Share of the light in a pixel whose centre is (x, y) px from the point: cubic between the samples, 0 outside.
    pub fn share(&self, x_px: f64, y_px: f64) -> f64 {
        let middle = (self.side / 2) as f64;
        let at = [x_px, y_px].map(|px| px * self.samples_per_px as f64 + middle);
        let (column, columns) = cubic(at[0]);
        let (row, rows) = cubic(at[1]);
        let mut sum = 0.0;
        for (v, down) in (row..).zip(rows) {
            for (u, across) in (column..).zip(columns) {
                sum += down * across * self.sample(u, v);
            }
        }
        sum.max(0.0)
    }

    fn sample(&self, column: i64, row: i64) -> f64 {
        let inside = |index: i64| usize::try_from(index).ok().filter(|index| *index < self.side);
        inside(column).zip(inside(row)).map_or(0.0, |(u, v)| self.shares[v * self.side + u])
    }

    /// Adds the light of a point to the charge, `wider` times as wide as the table. All of it is shared out: what the table
    /// sums to at this place in the pixel is divided away.
    pub(super) fn draw(&self, light: &PointLight, wider: f64, onto: &mut Charge) {
        let reach_px = (self.side / 2) as f64 / self.samples_per_px as f64 * wider;
        let span =
            |centre_px: f64| ((centre_px - reach_px).ceil() as i64, (centre_px + reach_px).floor() as i64);
        let ((left, right), (top, bottom)) = (span(light.u_px), span(light.v_px));
        let mut patch = Vec::new();
        for v in top..=bottom {
            for u in left..=right {
                let (x_px, y_px) = (u as f64 - light.u_px, v as f64 - light.v_px);
                patch.push(self.share(x_px / wider, y_px / wider) as f32);
            }
        }
        let columns = (right - left + 1).max(0) as usize;
        let sum: f64 = patch.iter().map(|&share| f64::from(share)).sum();
        let (first, end) = (left.max(0), (right + 1).min(onto.width() as i64));
        if columns == 0 || sum <= 0.0 || first >= end {
            return;
        }
        for (v, row) in (top..=bottom).zip(patch.chunks_exact(columns)) {
            let Some(v) = usize::try_from(v).ok().filter(|v| *v < onto.height()) else { continue };
            let seen = &row[(first - left) as usize..(end - left) as usize];
            onto.add_row(v, first as usize, seen, (light.electrons / sum) as f32);
        }
    }
}

/// The four samples about a place and their weights: the cubic of Catmull and Rom, which passes through the samples.
fn cubic(at: f64) -> (i64, [f64; 4]) {
    let whole = at.floor();
    let t = at - whole;
    let weights = [
        ((2.0 - t) * t - 1.0) * t,
        (3.0 * t - 5.0) * t * t + 2.0,
        ((4.0 - 3.0 * t) * t + 1.0) * t,
        (t - 1.0) * t * t,
    ];
    (whole as i64 - 1, weights.map(|weight| 0.5 * weight))
}

#[cfg(test)]
mod tests {
    use super::super::{Gaussian, PointSpread};
    use super::*;

    /// A Gaussian integrated over pixels, four samples a pixel.
    fn gaussian(sigma_px: f64) -> SampledSpread {
        let half = |x_px: f64| {
            let below = |edge: f64| 0.5 * libm::erf(edge / (sigma_px * core::f64::consts::SQRT_2));
            below(x_px + 0.5) - below(x_px - 0.5)
        };
        let place = |index: usize| (index as f64 - 20.0) / 4.0;
        let rows: Vec<Vec<f64>> =
            (0..41).map(|v| (0..41).map(|u| half(place(u)) * half(place(v))).collect()).collect();
        SampledSpread::new(4, &rows).unwrap()
    }

    #[test]
    fn a_table_of_a_gaussian_draws_that_gaussian() {
        let parts = vec![Gaussian { share: 1.0, sigma_px: 0.7 }];
        let exact = PointSpread::new(parts, 0.0).unwrap();
        let sampled = PointSpread::sampled(gaussian(0.7));
        for (u_px, v_px) in [(12.0, 11.0), (12.31, 11.77), (11.5, 12.5), (0.2, 11.1), (12.0, -3.0)] {
            let light = PointLight { u_px, v_px, electrons: 1e5, ..PointLight::default() };
            let (mut a, mut b) = (Charge::new(25, 23), Charge::new(25, 23));
            exact.draw(&light, &mut a);
            sampled.draw(&light, &mut b);
            for v in 0..23 {
                for u in 0..25 {
                    assert!(
                        (a.at(u, v) - b.at(u, v)).abs() < 150.0,
                        "{} {} at {u} {v}",
                        a.at(u, v),
                        b.at(u, v)
                    );
                }
            }
            if u_px > 5.0 && v_px > 5.0 {
                assert!((b.total() / 1e5 - 1.0).abs() < 1e-6, "all light is shared out: {}", b.total());
            }
        }
        assert!((gaussian(0.7).variance_px2() - 0.49 - 1.0 / 12.0).abs() < 1e-3);
    }

    #[test]
    fn the_centroid_is_that_of_what_is_drawn() {
        let rows: Vec<Vec<f64>> = (0..41)
            .map(|v| {
                (0..41)
                    .map(|u| {
                        libm::exp(
                            -0.01 * (f64::from(u) - 24.0).powi(2) - 0.02 * (f64::from(v) - 19.0).powi(2),
                        )
                    })
                    .collect()
            })
            .collect();
        let table = SampledSpread::new(4, &rows).unwrap();
        let mut charge = Charge::new(40, 40);
        table.draw(
            &PointLight { u_px: 20.3, v_px: 19.6, electrons: 1e5, ..PointLight::default() },
            1.0,
            &mut charge,
        );
        let mut sums = [0.0; 2];
        for (u, v) in (0..40).flat_map(|u| (0..40).map(move |v| (u, v))) {
            sums[0] += f64::from(charge.at(u, v)) * (u as f64 - 20.3) / 1e5;
            sums[1] += f64::from(charge.at(u, v)) * (v as f64 - 19.6) / 1e5;
        }
        let found = table.centroid_px();
        assert!(
            libm::hypot(found[0] - sums[0], found[1] - sums[1]) < 0.01 && found[0] > 0.5,
            "{found:?} {sums:?}"
        );
    }

    #[test]
    fn what_is_no_table_does_not_construct() {
        let even = vec![vec![1.0; 4]; 4];
        let negative = vec![vec![-1.0; 5]; 5];
        let ragged = vec![vec![1.0; 5], vec![1.0; 4], vec![1.0; 5], vec![1.0; 5], vec![1.0; 5]];
        for rows in [even, negative, ragged, vec![vec![0.0; 5]; 5], vec![vec![f64::NAN; 5]; 5]] {
            assert_eq!(SampledSpread::new(1, &rows), None);
        }
        assert!(SampledSpread::new(1, &vec![vec![1.0; 5]; 5]).is_some());
        assert_eq!(SampledSpread::new(0, &vec![vec![1.0; 5]; 5]), None);
    }
}
