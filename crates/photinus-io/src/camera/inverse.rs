//! OCamCalib's inverse polynomial rho(theta): how well it fits the direct one, and how to make one that does.

use std::f64::consts::FRAC_PI_2;

use nalgebra::{DMatrix, DVector, Vector2};
use photinus::camera::{Camera, OCam, Pixel};

/// How far an inverse polynomial is from the inverse of the direct one, over the field.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InverseReport {
    /// Degree of the inverse polynomial.
    pub degree: usize,
    /// Largest difference in radius, px.
    pub max_px: f64,
    /// Root mean square difference in radius, px, over equal steps of radius.
    pub rms_px: f64,
    /// Angle off the axis of the largest difference, rad.
    pub worst_rad: f64,
}

/// Farther off than any image is wide, px: the polynomial does not belong to this lens, or overflows.
const NOWHERE_PX: f64 = 1e4;

impl std::fmt::Display for InverseReport {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.max_px <= NOWHERE_PX {
            true => write!(f, "up to {:.2} px from the direct one (rms {:.3} px)", self.max_px, self.rms_px),
            false => write!(f, "more than {NOWHERE_PX} px from the direct one"),
        }
    }
}

/// Places along a radius of the field: (radius in px, the toolbox's theta in rad, -pi/2 on the axis).
pub(super) struct Curve(Vec<(f64, f64)>);

impl Curve {
    const STEPS: u32 = 1000;

    pub(super) fn of(camera: &Camera, lens: &OCam) -> Self {
        let theta = |radius: f64| libm::atan2(value(lens.direct(), radius), radius);
        let limit = camera.field_limit_rad() - FRAC_PI_2;
        let last = last_within(ring_px(camera, lens), |radius| theta(radius) <= limit);
        let radius = |i| last * f64::from(i) / f64::from(Self::STEPS);
        Self((0..=Self::STEPS).map(radius).map(|radius| (radius, theta(radius))).collect())
    }

    /// Compares an inverse polynomial (ascending powers of theta) with the curve.
    pub(super) fn report(&self, inverse: &[f64]) -> InverseReport {
        let mut report = InverseReport {
            degree: inverse.len().saturating_sub(1),
            max_px: 0.0,
            rms_px: 0.0,
            worst_rad: 0.0,
        };
        for (radius, theta) in &self.0 {
            let difference = (value(inverse, *theta) - radius).abs();
            report.rms_px += difference * difference;
            if difference.total_cmp(&report.max_px).is_ge() {
                report.max_px = difference;
                report.worst_rad = theta + FRAC_PI_2;
            }
        }
        report.rms_px = (report.rms_px / self.0.len() as f64).sqrt();
        report
    }

    /// The inverse polynomial of least degree that stays within `good_enough_px`, or else the best there is.
    pub(super) fn fit(&self, good_enough_px: f64) -> (Vec<f64>, InverseReport) {
        let mut best: Option<(Vec<f64>, InverseReport)> = None;
        for degree in 3..=20 {
            let Some(inverse) = self.fit_degree(degree) else { continue };
            let report = self.report(&inverse);
            if best.as_ref().is_none_or(|(_, least)| report.max_px < least.max_px) {
                best = Some((inverse, report));
            }
            if best.as_ref().is_some_and(|(_, least)| least.max_px <= good_enough_px) {
                break;
            }
        }
        best.unwrap_or_else(|| (vec![0.0], self.report(&[0.0])))
    }

    /// Least squares in Chebyshev polynomials, whose normal equations stay well conditioned, then plain powers.
    fn fit_degree(&self, degree: usize) -> Option<Vec<f64>> {
        let (first, last) = (self.0.first()?.1, self.0.last()?.1);
        let (middle, half) = (0.5 * (first + last), 0.5 * (last - first));
        let rows = self.0.len();
        let mut basis = DMatrix::zeros(rows, degree + 1);
        for (i, (_, theta)) in self.0.iter().enumerate() {
            let s = (theta - middle) / half;
            let (mut before, mut now) = (s, 1.0); // T(-1) = s, T(0) = 1
            for k in 0..=degree {
                basis[(i, k)] = now;
                (before, now) = (now, 2.0 * s * now - before);
            }
        }
        let radii = DVector::from_iterator(rows, self.0.iter().map(|(radius, _)| *radius));
        let transposed = basis.transpose();
        let weights = (&transposed * &basis).cholesky()?.solve(&(transposed * radii));
        Some(plain_powers(weights.as_slice(), middle, half))
    }
}

/// The sum of `weights[k] T_k((t - middle) / half)` in ascending powers of t.
fn plain_powers(weights: &[f64], middle: f64, half: f64) -> Vec<f64> {
    let times_s = |p: &[f64]| {
        let mut product = vec![0.0; p.len() + 1];
        for (k, c) in p.iter().enumerate() {
            product[k] -= c * middle / half;
            product[k + 1] += c / half;
        }
        product
    };
    let (mut before, mut now) = (times_s(&[1.0]), vec![1.0]);
    let mut sum = vec![0.0; weights.len()];
    for weight in weights {
        for (total, c) in sum.iter_mut().zip(&now) {
            *total += weight * c;
        }
        let mut next = times_s(&now);
        for (k, c) in next.iter_mut().enumerate() {
            *c = 2.0 * *c - before.get(k).copied().unwrap_or(0.0);
        }
        (before, now) = (now, next);
    }
    sum
}

/// The end of the stretch from 0, at most to `ring`, where `within` holds.
fn last_within(ring: f64, within: impl Fn(f64) -> bool) -> f64 {
    let step = ring / 1000.0;
    let steps = (1..=1000).take_while(|i| within(step * f64::from(*i))).count();
    if steps == 1000 {
        return ring;
    }
    let (mut inside, mut outside) = (step * steps as f64, step * (steps + 1) as f64);
    for _ in 0..50 {
        let middle = 0.5 * (inside + outside);
        *(if within(middle) { &mut inside } else { &mut outside }) = middle;
    }
    inside
}

/// The radius of the farthest corner of the image, px before the stretch.
fn ring_px(camera: &Camera, lens: &OCam) -> f64 {
    let (right, bottom) = (camera.width() as f64 - 0.5, camera.height() as f64 - 0.5);
    let Pixel { u, v } = lens.centre();
    let flat = lens.stretch().try_inverse().unwrap_or_default();
    let corners = [(-0.5, -0.5), (right, -0.5), (-0.5, bottom), (right, bottom)];
    corners.iter().map(|(x, y)| (flat * Vector2::new(y - v, x - u)).norm()).fold(0.0, f64::max)
}

fn value(ascending: &[f64], x: f64) -> f64 {
    ascending.iter().rev().fold(0.0, |sum, a| sum * x + a)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Matrix2;
    use photinus::camera::Model;

    fn curve() -> Curve {
        let direct = [-259.5395, 0.0, 1.626945e-3, -2.328091e-6, 6.601777e-9];
        let lens = OCam::new(&direct, Pixel::new(364.4, 229.6), Matrix2::identity()).unwrap();
        Curve::of(&Camera::new(Model::OCam(lens.clone()), 752, 480, None).unwrap(), &lens)
    }

    #[test]
    fn chebyshev_sums_become_plain_powers() {
        // T0 + 2 T1 + 3 T2 at s = t: 1 + 2 t + 3 (2 t^2 - 1)
        assert_eq!(plain_powers(&[1.0, 2.0, 3.0], 0.0, 1.0), [-2.0, 2.0, 6.0]);
    }

    #[test]
    fn the_fit_reaches_a_hundredth_of_a_pixel() {
        let (inverse, report) = curve().fit(0.01);
        assert!(report.max_px <= 0.01 && report.rms_px <= report.max_px, "{report:?}");
        assert!(inverse.len() < 16, "{report:?}");
        assert_eq!(report, curve().report(&inverse));
    }

    #[test]
    fn the_curve_ends_with_the_field() {
        let direct = [-259.5395, 0.0, 1.626945e-3, -2.328091e-6, 6.601777e-9];
        let lens = OCam::new(&direct, Pixel::new(364.4, 229.6), Matrix2::identity()).unwrap();
        for limit in [1e-4, 0.5, 1.7] {
            let camera = Camera::new(Model::OCam(lens.clone()), 752, 480, Some(limit)).unwrap();
            let curve = Curve::of(&camera, &lens);
            assert!((curve.0[1000].1 + FRAC_PI_2 - limit).abs() < 1e-12);
            assert!(curve.fit(0.01).1.max_px <= 0.01);
        }
    }

    #[test]
    fn a_wrong_inverse_is_reported_where_it_is_worst() {
        let (mut inverse, good) = curve().fit(0.01);
        inverse[1] += 1.0; // theta px: largest where theta is, at the axis
        let report = curve().report(&inverse);
        assert!((report.max_px - FRAC_PI_2).abs() < 2.0 * good.max_px && report.worst_rad.abs() < 1e-9);
    }
}
