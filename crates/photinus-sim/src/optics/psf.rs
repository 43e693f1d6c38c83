//! Point spread: a sum of Gaussians, integrated over square pixels, wider off the axis.
//!
//! A narrow Gaussian is the core, wide faint ones stand for aberrations and scatter. A Gaussian integrated over a pixel is
//! a product of two differences of the error function, so the light of a point is conserved to rounding.

use crate::sensor::Charge;

/// A part of the spread.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gaussian {
    /// Share of the light.
    pub share: f64,
    /// Sigma along u and v on the axis, px.
    pub sigma_px: f64,
}

/// How a point of light spreads over pixels.
#[derive(Clone, Debug, PartialEq)]
pub struct PointSpread {
    parts: Vec<Gaussian>,
    widening_per_rad2: f64,
}

/// A place and an amount of light in the image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointLight {
    /// Column, px.
    pub u_px: f64,
    /// Row, px.
    pub v_px: f64,
    /// Photo-electrons in all.
    pub electrons: f64,
    /// Angle off the axis, rad.
    pub off_axis_rad: f64,
    /// Radius of the source's image, px: a disc of this radius has the variance r^2 / 4 along each axis.
    pub radius_px: f64,
}

impl PointSpread {
    /// Light below this is not drawn, electrons per pixel: far below the read noise.
    const FAINTEST_E: f64 = 0.5;

    /// A spread from its parts, each `1 + widening_per_rad2 * angle^2` times as wide off the axis. `None` unless shares are
    /// positive and sum to 1, and sigmas positive.
    pub fn new(parts: Vec<Gaussian>, widening_per_rad2: f64) -> Option<Self> {
        let sum: f64 = parts.iter().map(|part| part.share).sum();
        let positive = |part: &Gaussian| part.share > 0.0 && part.sigma_px > 0.0 && part.sigma_px.is_finite();
        let legal = parts.iter().all(positive) && (sum - 1.0).abs() < 1e-9 && widening_per_rad2 >= 0.0;
        (legal && widening_per_rad2.is_finite()).then_some(Self { parts, widening_per_rad2 })
    }

    /// The parts, as on the axis.
    pub fn parts(&self) -> &[Gaussian] {
        &self.parts
    }

    /// Adds the light of a point to the charge of the pixels around it.
    pub fn draw(&self, light: &PointLight, onto: &mut Charge) {
        let wider = 1.0 + self.widening_per_rad2 * light.off_axis_rad * light.off_axis_rad;
        for part in &self.parts {
            let sigma_px = libm::hypot(part.sigma_px * wider, 0.5 * light.radius_px);
            let electrons = part.share * light.electrons;
            let summit = electrons / (core::f64::consts::TAU * sigma_px * sigma_px);
            if summit.min(electrons) <= Self::FAINTEST_E {
                continue;
            }
            let reach_px = sigma_px * (2.0 * libm::log(summit / Self::FAINTEST_E)).max(0.0).sqrt() + 1.0;
            let columns = Shares::new(light.u_px, sigma_px, reach_px, onto.width());
            let rows = Shares::new(light.v_px, sigma_px, reach_px, onto.height());
            for (v, row_share) in rows.iter() {
                onto.add_row(v, columns.first, &columns.shares, (electrons * row_share) as f32);
            }
        }
    }
}

/// Which share of a Gaussian falls on each pixel of a line of the image.
struct Shares {
    first: usize,
    shares: Vec<f32>,
}

impl Shares {
    fn new(centre_px: f64, sigma_px: f64, reach_px: f64, length: usize) -> Self {
        let last = length as f64 - 1.0;
        let first = (centre_px - reach_px).floor().clamp(0.0, last);
        let end = (centre_px + reach_px).ceil().clamp(-1.0, last);
        let scale = 1.0 / (core::f64::consts::SQRT_2 * sigma_px);
        let below = |edge_px: f64| 0.5 * libm::erf((edge_px - centre_px) * scale);
        let count = (end - first + 1.0).max(0.0) as usize;
        let mut shares = Vec::with_capacity(count);
        let mut left = below(first - 0.5);
        for index in 0..count {
            let right = below(first + index as f64 + 0.5);
            shares.push((right - left) as f32);
            left = right;
        }
        Self { first: first as usize, shares }
    }

    fn iter(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        self.shares.iter().enumerate().map(|(index, &share)| (self.first + index, f64::from(share)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn spread() -> PointSpread {
        let parts = vec![Gaussian { share: 0.9, sigma_px: 0.4 }, Gaussian { share: 0.1, sigma_px: 3.0 }];
        PointSpread::new(parts, 0.5).unwrap()
    }

    fn drawn(light: PointLight) -> Charge {
        let mut charge = Charge::new(61, 51);
        spread().draw(&light, &mut charge);
        charge
    }

    const POINT: PointLight =
        PointLight { u_px: 30.3, v_px: 24.6, electrons: 1e6, off_axis_rad: 0.0, radius_px: 0.0 };

    /// Sum, mean and variance along u of all charge.
    fn moments(charge: &Charge) -> (f64, f64, f64) {
        let (mut sum, mut first, mut second) = (0.0, 0.0, 0.0);
        for v in 0..charge.height() {
            for (u, &electrons) in charge.row(v).iter().enumerate() {
                let (u, electrons) = (u as f64, f64::from(electrons));
                sum += electrons;
                first += electrons * u;
                second += electrons * u * u;
            }
        }
        (sum, first / sum, second / sum - (first / sum) * (first / sum))
    }

    #[test]
    fn light_is_conserved_and_lies_where_the_point_is() {
        let (sum, mean_px, variance_px2) = moments(&drawn(POINT));
        assert!((sum / 1e6 - 1.0).abs() < 1e-3, "{sum}");
        // pixels sample a core of 0.4 px too coarsely: their centroid is off by exp(-2 pi^2 sigma^2) sin(2 pi u) / pi
        let bias_px = 0.9 * libm::exp(-2.0 * core::f64::consts::PI.powi(2) * 0.16) / core::f64::consts::PI;
        let expected_px = 30.3 - bias_px * libm::sin(core::f64::consts::TAU * 0.3);
        assert!((mean_px - expected_px).abs() < 1e-3, "{mean_px} not {expected_px}");
        // 0.9 * 0.16 + 0.1 * 9, and 1/12 for the square pixel
        assert!((variance_px2 - (0.144 + 0.9 + 1.0 / 12.0)).abs() < 0.02, "{variance_px2}");
    }

    #[test]
    fn a_pixel_holds_the_integral_over_its_square() {
        let charge = drawn(PointLight { u_px: 30.0, v_px: 25.0, ..POINT });
        // brute force: midpoints of a 200 x 200 raster over the pixel right of the point
        let density = |x: f64, y: f64, sigma: f64| {
            libm::exp(-(x * x + y * y) / (2.0 * sigma * sigma)) / (core::f64::consts::TAU * sigma * sigma)
        };
        let mut share = 0.0;
        for i in 0..200 {
            for j in 0..200 {
                let (x, y) = (0.5 + (f64::from(i) + 0.5) / 200.0, -0.5 + (f64::from(j) + 0.5) / 200.0);
                share += (0.9 * density(x, y, 0.4) + 0.1 * density(x, y, 3.0)) / 40_000.0;
            }
        }
        assert!((f64::from(charge.row(25)[31]) / 1e6 - share).abs() < 1e-5);
    }

    #[test]
    fn spots_are_wider_off_the_axis_and_near_by() {
        let (_, _, on_axis) = moments(&drawn(POINT));
        let (_, _, aside) = moments(&drawn(PointLight { off_axis_rad: 1.0, ..POINT }));
        assert!((aside - 1.0 / 12.0) / (on_axis - 1.0 / 12.0) > 2.0, "1.5 times as wide: {aside} {on_axis}");
        let (_, _, near) = moments(&drawn(PointLight { radius_px: 2.0, ..POINT }));
        assert!((near - on_axis - 1.0).abs() < 0.02, "a disc of 2 px adds r^2 / 4");
    }

    #[test]
    fn a_point_at_the_border_or_outside_is_drawn_as_far_as_it_reaches() {
        let (sum, ..) = moments(&drawn(PointLight { u_px: -0.5, ..POINT }));
        assert!((sum / 5e5 - 1.0).abs() < 1e-3, "half of it: {sum}");
        let (sum, ..) = moments(&drawn(PointLight { u_px: -40.0, ..POINT }));
        assert!(sum < 1.0 || sum.is_nan());
    }

    #[test]
    fn shares_that_do_not_sum_to_one_are_no_spread() {
        assert_eq!(PointSpread::new(vec![Gaussian { share: 0.9, sigma_px: 1.0 }], 0.0), None);
        assert_eq!(PointSpread::new(vec![Gaussian { share: 1.0, sigma_px: 0.0 }], 0.0), None);
        assert_eq!(PointSpread::new(vec![Gaussian { share: 1.0, sigma_px: 1.0 }], f64::NAN), None);
    }
}
