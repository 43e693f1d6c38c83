//! Point spread: a shape on the axis (Gaussians or a table), and what becomes of it off the axis.
//!
//! A narrow Gaussian is a core, wide faint ones stand for scatter; Moffat's profile is a sum of them. Each is integrated over
//! square pixels without error, so that the light of a point is conserved to rounding. Coma and elongation share the light of
//! each part out among places nearby (`aberration.rs`).

use super::gaussian::Blob;
use super::{Aberrations, Gaussian, SampledSpread, ZonedSpread, moffat};
use crate::sensor::Charge;

/// How a point of light spreads over pixels.
#[derive(Clone, Debug, PartialEq)]
pub struct PointSpread {
    shape: Shape,
    aberrations: Aberrations,
}

#[derive(Clone, Debug, PartialEq)]
enum Shape {
    Gaussians(Vec<Gaussian>),
    Sampled(SampledSpread),
    Zoned(ZonedSpread),
}

/// A place and an amount of light in the image.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
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
    /// How many such points share the light of one place (a streak, an edge), 0 and 1 alike for one that is alone: what is too
    /// faint to be drawn is fainter by that.
    pub among: f64,
    /// Unit vector of the image that points away from the axis; nothing on the axis.
    pub outward: [f64; 2],
}

impl PointLight {
    /// The unit vector away from where the axis meets the image.
    pub fn outward(place_px: [f64; 2], axis_px: [f64; 2]) -> [f64; 2] {
        let [u, v] = [place_px[0] - axis_px[0], place_px[1] - axis_px[1]];
        let length = libm::hypot(u, v);
        if length > 1e-9 { [u / length, v / length] } else { [0.0; 2] }
    }
}

impl PointSpread {
    /// Light below this is not drawn, electrons per pixel, shared among the parts: far below the read noise.
    const FAINTEST_E: f64 = 1.0;

    /// A spread from its parts, each `1 + widening_per_rad2 * angle^2` times as wide off the axis. `None` unless shares are
    /// positive and sum to 1, and sigmas positive.
    pub fn new(parts: Vec<Gaussian>, widening_per_rad2: f64) -> Option<Self> {
        let sum: f64 = parts.iter().map(|part| part.share).sum();
        let positive = |part: &Gaussian| part.share > 0.0 && part.sigma_px > 0.0 && part.sigma_px.is_finite();
        let legal = parts.iter().all(positive) && (sum - 1.0).abs() < 1e-9;
        let round = Self { shape: Shape::Gaussians(parts), aberrations: Aberrations::default() };
        legal.then_some(round)?.with_aberrations(Aberrations { widening_per_rad2, ..Default::default() })
    }

    /// Moffat's profile with its full width at half the summit, px, and its exponent: `None` unless the width is positive and
    /// `beta` from 1.25 (wide wings) to 20 (nearly a Gaussian).
    pub fn moffat(fwhm_px: f64, beta: f64) -> Option<Self> {
        Self::new(moffat::gaussians(fwhm_px, beta)?, 0.0)
    }

    /// A spread that was measured.
    pub fn sampled(table: SampledSpread) -> Self {
        Self { shape: Shape::Sampled(table), aberrations: Aberrations::default() }
    }

    /// A spread that was measured all over the image.
    pub fn zoned(zones: ZonedSpread) -> Self {
        Self { shape: Shape::Zoned(zones), aberrations: Aberrations::default() }
    }

    /// The same shape with what the lens does to it off the axis; `None` for numbers that no lens has: widening and elongation
    /// are 0 to 10, coma is -10 to 10.
    pub fn with_aberrations(self, aberrations: Aberrations) -> Option<Self> {
        aberrations.is_legal().then_some(Self { aberrations, ..self })
    }

    /// What the lens does to it off the axis.
    pub fn aberrations(&self) -> &Aberrations {
        &self.aberrations
    }

    /// The parts, as on the axis; none of a table.
    pub fn parts(&self) -> &[Gaussian] {
        match &self.shape {
            Shape::Gaussians(parts) => parts,
            Shape::Sampled(_) | Shape::Zoned(_) => &[],
        }
    }

    /// Centroid of the light of a point at (`u_px`, `v_px`) as its table has it, as seen from the point, (u, v) in px: a table need not have
    /// it in its middle. What aberrations add is [`Aberrations`]' own.
    pub fn centroid_px(&self, u_px: f64, v_px: f64) -> [f64; 2] {
        match &self.shape {
            Shape::Gaussians(_) => [0.0; 2],
            Shape::Sampled(table) => table.centroid_px(),
            Shape::Zoned(zones) => zones.at(u_px, v_px).centroid_px(),
        }
    }

    /// Adds the light of a point to the charge of the pixels around it.
    pub fn draw(&self, light: &PointLight, onto: &mut Charge) {
        let wider = self.aberrations.widening(light.off_axis_rad);
        let among = light.among.max(1.0);
        match &self.shape {
            Shape::Gaussians(parts) => {
                let faintest_e = Self::FAINTEST_E / parts.len() as f64 / among;
                for part in parts {
                    let sigma_px = libm::hypot(part.sigma_px * wider, 0.5 * light.radius_px);
                    let whole = PointLight { electrons: part.share * light.electrons, ..*light };
                    self.share_out(&whole, sigma_px, |light, share| {
                        let PointLight { u_px, v_px, electrons, .. } = *light;
                        Blob { u_px, v_px, sigma_px, electrons }.draw(faintest_e * share, onto);
                    });
                }
            }
            Shape::Sampled(table) => self.draw_sampled(table, light, wider, onto),
            Shape::Zoned(zones) => self.draw_sampled(zones.at(light.u_px, light.v_px), light, wider, onto),
        }
    }

    fn draw_sampled(&self, table: &SampledSpread, light: &PointLight, wider: f64, onto: &mut Charge) {
        // a source of some size widens the table as it widens a Gaussian of the same variance
        let source_px2 = 0.25 * light.radius_px * light.radius_px;
        let sigma_px = (table.variance_px2() * wider * wider + source_px2).sqrt();
        let wider = sigma_px / table.variance_px2().sqrt();
        self.share_out(light, sigma_px, |light, _| table.draw(light, wider, onto));
    }

    /// Hands over the parts among which aberrations share the light of a blob of `sigma_px`, each with its share.
    fn share_out(&self, whole: &PointLight, sigma_px: f64, mut draw: impl FnMut(&PointLight, f64)) {
        if self.aberrations.is_round() {
            return draw(whole, 1.0);
        }
        for part in self.aberrations.parts(whole, sigma_px) {
            let light = PointLight {
                u_px: whole.u_px + part.du_px,
                v_px: whole.v_px + part.dv_px,
                electrons: whole.electrons * part.share,
                ..*whole
            };
            draw(&light, part.share);
        }
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

    const POINT: PointLight = PointLight {
        u_px: 30.3,
        v_px: 24.6,
        electrons: 1e6,
        off_axis_rad: 0.0,
        radius_px: 0.0,
        among: 1.0,
        outward: [1.0, 0.0],
    };

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
    fn coma_moves_the_centroid_and_elongation_the_variance_as_integrals_say() {
        let parts = vec![Gaussian { share: 1.0, sigma_px: 0.8 }];
        let bent = Aberrations { coma_px_per_rad: 1.0, elongation_per_rad2: 0.4, ..Default::default() };
        let spread = PointSpread::new(parts, 0.0).unwrap().with_aberrations(bent).unwrap();
        for (outward, along) in [([1.0, 0.0], true), ([0.0, -1.0], false)] {
            let light = PointLight { off_axis_rad: 1.0, outward, ..POINT };
            let mut charge = Charge::new(61, 51);
            spread.draw(&light, &mut charge);
            let (sum, mean_px, variance_px2) = moments(&charge);
            assert!((sum / 1e6 - 1.0).abs() < 1e-3, "{sum}");
            // along: 1 px of coma, (0.8 * 1.4)^2 + 1/2 + 1/12; across: none, 0.8^2 + 1/6 + 1/12
            let expected = if along { (31.3, 1.2544 + 0.5) } else { (30.3, 0.64 + 1.0 / 6.0) };
            assert!((mean_px - expected.0).abs() < 2e-3, "{mean_px}");
            assert!((variance_px2 / (expected.1 + 1.0 / 12.0) - 1.0).abs() < 0.02, "{variance_px2}");
        }
    }

    #[test]
    fn a_moffat_profile_keeps_its_light_and_its_wings() {
        let moffat = PointSpread::moffat(1.2, 2.5).unwrap();
        let mut charge = Charge::new(201, 201);
        moffat.draw(&PointLight { u_px: 100.2, v_px: 99.7, electrons: 1e9, ..POINT }, &mut charge);
        assert!((charge.total() / 1e9 - 1.0).abs() < 1e-3, "{}", charge.total());
        // the light outside 10 px by the closed form: (1 + 100 / a^2)^-1.5
        let a_px = 0.6 / (libm::exp2(0.4) - 1.0).sqrt();
        let mut outside = 0.0;
        for v in 0..201 {
            for u in 0..201 {
                let far = libm::hypot(u as f64 - 100.2, v as f64 - 99.7) > 10.0;
                outside += if far { f64::from(charge.at(u, v)) / 1e9 } else { 0.0 };
            }
        }
        let expected = libm::pow(1.0 + 100.0 / (a_px * a_px), -1.5);
        assert!((outside / expected - 1.0).abs() < 0.05, "{outside} not {expected}");
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
