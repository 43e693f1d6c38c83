//! A lens out of focus: Gaussian blur.
//!
//! The kernel is the discrete Gaussian exp(-t) I_n(t) with t = sigma^2 (T. Lindeberg, "Scale-Space for Discrete Signals", PAMI
//! 1990): its variance is sigma^2 for every sigma, which samples of a Gaussian have for wide ones only.

use photinus_io::image::GreyImage;

use super::{repainted, to_grey};

/// Weights of one side, the middle first; both sides together sum to 1.
pub(super) struct Kernel(Vec<f32>);

impl Kernel {
    /// What is left out on either side.
    const TAIL: f64 = 1e-7;

    pub(super) fn new(sigma_px: f64) -> Self {
        let weight = |n: u32| bessel_share(n, sigma_px * sigma_px);
        let mut weights = vec![weight(0)];
        let mut sum = weights[0];
        while 1.0 - sum > 2.0 * Self::TAIL && weights.len() < 1000 {
            weights.push(weight(weights.len() as u32));
            sum += 2.0 * weights[weights.len() - 1];
        }
        Self(weights.into_iter().map(|weight| (weight / sum) as f32).collect())
    }

    /// Rows, then columns; the image goes on past its edges as it ends.
    pub(super) fn apply(&self, image: &GreyImage) -> GreyImage {
        let (width, height) = (image.width(), image.height());
        let levels: Vec<f32> = image.pixels().iter().map(|&grey| f32::from(grey)).collect();
        let mut along = vec![0.0; levels.len()];
        for (to, from) in along.chunks_exact_mut(width).zip(levels.chunks_exact(width)) {
            for (u, to) in to.iter_mut().enumerate() {
                *to = self.mean(|n| from[u.saturating_sub(n)], |n| from[(u + n).min(width - 1)]);
            }
        }
        let pixel = |i: usize| {
            let (u, v) = (i % width, i / width);
            let at = |row: usize| along[row * width + u];
            to_grey(f64::from(self.mean(|n| at(v.saturating_sub(n)), |n| at((v + n).min(height - 1)))))
        };
        repainted(image, (0..levels.len()).map(pixel).collect())
    }

    fn mean(&self, before: impl Fn(usize) -> f32, after: impl Fn(usize) -> f32) -> f32 {
        let sides = self.0.iter().enumerate().skip(1).map(|(n, weight)| weight * (before(n) + after(n)));
        sides.fold(self.0[0] * before(0), |sum, side| sum + side)
    }
}

/// exp(-t) I_n(t) by the series of the modified Bessel function, term by term.
fn bessel_share(n: u32, t: f64) -> f64 {
    let half = 0.5 * t;
    let log_first = f64::from(n) * libm::log(half) - libm::lgamma(f64::from(n) + 1.0) - t;
    let mut term = libm::exp(log_first);
    let (mut sum, mut k) = (0.0, 0.0);
    while term > sum * 1e-17 || (k < half && term > 0.0) {
        sum += term;
        k += 1.0;
        term *= half * half / (k * (k + f64::from(n)));
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kernels_have_unit_weight_and_the_variance_asked_for() {
        for sigma_px in [0.1, 0.3, 0.7, 1.0, 1.5, 3.0, 8.0, 20.0] {
            let Kernel(weights) = Kernel::new(sigma_px);
            let both = |power: i32| {
                let sides =
                    (1..).zip(&weights[1..]).map(|(n, &w)| 2.0 * f64::from(w) * f64::from(n).powi(power));
                sides.sum::<f64>() + if power == 0 { f64::from(weights[0]) } else { 0.0 }
            };
            assert!((both(0) - 1.0).abs() < 1e-5, "{sigma_px}: {}", both(0));
            assert!((both(2) / (sigma_px * sigma_px) - 1.0).abs() < 1e-3, "{sigma_px}: {}", both(2));
            // a Gaussian's fourth moment, and what steps of a pixel add: 3 t^2 + t
            let t = sigma_px * sigma_px;
            assert!((both(4) / (3.0 * t * t + t) - 1.0).abs() < 1e-2, "{sigma_px}: {}", both(4));
        }
    }

    #[test]
    fn a_square_is_spread_by_the_variance_and_keeps_its_light() {
        let (width, height) = (81, 61);
        let mut pixels = vec![0; width * height];
        (26..35).for_each(|v| (36..45).for_each(|u| pixels[v * width + u] = 240));
        let image = GreyImage::new(pixels, width, height).unwrap();
        let blurred = Kernel::new(2.5).apply(&image);
        let moments = |image: &GreyImage| {
            let sum = |of: &dyn Fn(f64, f64) -> f64| {
                let levels = image.pixels().iter().enumerate();
                levels.map(|(i, &g)| f64::from(g) * of((i % width) as f64, (i / width) as f64)).sum::<f64>()
            };
            let light = sum(&|_, _| 1.0);
            let spread = |axis: &dyn Fn(f64, f64) -> f64| sum(axis) / light;
            (light, [spread(&|u, _| (u - 40.0).powi(2)), spread(&|_, v| (v - 30.0).powi(2))])
        };
        let ((before, narrow), (after, wide)) = (moments(&image), moments(&blurred));
        assert!((after / before - 1.0).abs() < 0.01, "{before} {after}");
        for axis in 0..2 {
            let added = wide[axis] - narrow[axis];
            assert!((added - 6.25).abs() < 0.15, "{added}");
        }
    }
}
