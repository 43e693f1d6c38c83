//! How a point spread changes over the field: wider, longer away from the axis, with the tail of coma.
//!
//! In: the angle off the axis and the direction away from it in the image. Out: the places among which the light of a
//! narrower blob is shared out, so that mean and variance of the sum are those of the aberration. Third-order coma sends
//! light that passes the pupil at (rho, phi) to c rho^2 (2 + cos 2 phi, sin 2 phi), a circle for each rho (W. Welford,
//! Aberrations of Optical Systems, 1986): its centroid lies c off the chief ray, its variance is c^2 / 2 along and c^2 / 6 across.

use super::PointLight;

/// What a lens does to a point of light off its axis.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Aberrations {
    /// Every width is 1 + this times the square of the angle off the axis (rad) as large.
    pub widening_per_rad2: f64,
    /// Sigma away from the axis is 1 + this times the square of the angle (rad) that across.
    pub elongation_per_rad2: f64,
    /// Coma's c per rad off the axis, px, away from the axis; negative towards it.
    pub coma_px_per_rad: f64,
    /// Coma's c that is the same all over the image, along u and v, px: a lens element that sits beside the axis.
    pub axis_coma_px: [f64; 2],
}

/// A place of a part of the light, from the place of all of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Part {
    pub(super) du_px: f64,
    pub(super) dv_px: f64,
    pub(super) share: f64,
}

const WHOLE: Part = Part { du_px: 0.0, dv_px: 0.0, share: 1.0 };

/// Parts of the light are not farther apart than this many sigmas of what is drawn at each: their sum has no ripples.
const APART: f64 = 1.15;

impl Aberrations {
    /// Largest elongation, coma over sigma and so on are limited by what is physical; the angle ends at 180 deg.
    pub(super) fn is_legal(&self) -> bool {
        let [u_px, v_px] = self.axis_coma_px;
        let positive = [self.widening_per_rad2, self.elongation_per_rad2];
        let signed = [self.coma_px_per_rad, u_px, v_px];
        positive.iter().all(|number| (0.0..=10.0).contains(number))
            && signed.iter().all(|number| (-10.0..=10.0).contains(number))
    }

    /// By how much widths grow at an angle off the axis.
    pub(super) fn widening(&self, off_axis_rad: f64) -> f64 {
        1.0 + self.widening_per_rad2 * off_axis_rad * off_axis_rad
    }

    /// Whether a point stays round and where it is.
    pub(super) fn is_round(&self) -> bool {
        let [u_px, v_px] = self.axis_coma_px;
        let bent = [self.elongation_per_rad2, self.coma_px_per_rad, u_px, v_px];
        bent.iter().all(|number| number.abs() <= 0.0)
    }

    /// Among which places the light of a blob of `sigma_px` is shared out. Shares sum to 1.
    pub(super) fn parts(&self, light: &PointLight, sigma_px: f64) -> Vec<Part> {
        let [out_u, out_v] = light.outward;
        let ratio = 1.0 + self.elongation_per_rad2 * light.off_axis_rad * light.off_axis_rad;
        let longer_px = sigma_px * (ratio * ratio - 1.0).max(0.0).sqrt();
        let coma = self.coma_px_per_rad * light.off_axis_rad;
        let (coma_u, coma_v) = (coma * out_u + self.axis_coma_px[0], coma * out_v + self.axis_coma_px[1]);
        let tail = tail((coma_u, coma_v), sigma_px);
        let line = line(longer_px, sigma_px);
        let both = |part: &Part| {
            let part = *part;
            line.iter().map(move |&(along_px, share)| Part {
                du_px: part.du_px + along_px * out_u,
                dv_px: part.dv_px + along_px * out_v,
                share: part.share * share,
            })
        };
        tail.iter().flat_map(both).collect()
    }
}

/// A Gaussian line of sigma `longer_px`, as places and shares.
fn line(longer_px: f64, sigma_px: f64) -> Vec<(f64, f64)> {
    if longer_px < 0.05 * sigma_px {
        return vec![(0.0, 1.0)];
    }
    let step_px = (APART * sigma_px).min(0.8 * longer_px);
    let reach = (3.6 * longer_px / step_px).ceil() as i32;
    let place = |index: i32| f64::from(index) * step_px;
    let weight = |index: i32| libm::exp(-0.5 * (place(index) / longer_px).powi(2));
    let sum: f64 = (-reach..=reach).map(weight).sum();
    (-reach..=reach).map(|index| (place(index), weight(index) / sum)).collect()
}

/// The flare of coma: circles of growing radius whose centres move away.
fn tail((coma_u, coma_v): (f64, f64), sigma_px: f64) -> Vec<Part> {
    let coma_px = libm::hypot(coma_u, coma_v);
    if coma_px <= 0.0 {
        return vec![WHOLE];
    }
    let strength = coma_px / sigma_px;
    if strength < 0.05 {
        return vec![Part { du_px: coma_u, dv_px: coma_v, share: 1.0 }]; // its shape is lost in the width
    }
    let (along_u, along_v) = (coma_u / coma_px, coma_v / coma_px);
    let circles = (2.0 * strength / APART).ceil().clamp(4.0, 40.0);
    let mut parts = Vec::new();
    for circle in 0..circles as u32 {
        let square = (f64::from(circle) + 0.5) / circles; // rho^2: equal steps pass equal light
        let around = (core::f64::consts::TAU * strength * square / APART).ceil().clamp(3.0, 60.0);
        for step in 0..around as u32 {
            let angle = core::f64::consts::TAU * (f64::from(step) + 0.5) / around;
            let (sin, cos) = libm::sincos(angle);
            let (along_px, across_px) = (coma_px * square * (2.0 + cos), coma_px * square * sin);
            parts.push(Part {
                du_px: along_px * along_u - across_px * along_v,
                dv_px: along_px * along_v + across_px * along_u,
                share: 1.0 / (circles * around),
            });
        }
    }
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    fn light(off_axis_rad: f64) -> PointLight {
        PointLight {
            u_px: 0.0,
            v_px: 0.0,
            electrons: 1.0,
            off_axis_rad,
            radius_px: 0.0,
            among: 1.0,
            outward: [0.6, -0.8],
        }
    }

    /// Sum, mean and covariance along and across the way out.
    fn moments(parts: &[Part]) -> (f64, [f64; 2], [f64; 3]) {
        let (mut sum, mut mean, mut square) = (0.0, [0.0; 2], [0.0; 3]);
        for part in parts {
            let (along, across) = (0.6 * part.du_px - 0.8 * part.dv_px, 0.8 * part.du_px + 0.6 * part.dv_px);
            sum += part.share;
            mean = [mean[0] + part.share * along, mean[1] + part.share * across];
            let products = [along * along, across * across, along * across];
            (0..3).for_each(|i| square[i] += part.share * products[i]);
        }
        let covariance =
            [square[0] - mean[0] * mean[0], square[1] - mean[1] * mean[1], square[2] - mean[0] * mean[1]];
        (sum, mean, covariance)
    }

    #[test]
    fn coma_moves_and_spreads_light_as_the_integral_over_the_pupil_does() {
        let coma = Aberrations { coma_px_per_rad: 1.5, ..Default::default() };
        for sigma_px in [0.3, 1.0] {
            let (sum, mean, covariance) = moments(&coma.parts(&light(0.8), sigma_px));
            assert!((sum - 1.0).abs() < 1e-12);
            assert!((mean[0] - 1.2).abs() < 1e-9 && mean[1].abs() < 1e-9, "{mean:?}");
            // the pupil in small areas
            let (mut second, mut across) = (0.0, 0.0);
            let steps = 400;
            for i in 0..steps {
                for j in 0..steps {
                    let rho2 = (f64::from(i) + 0.5) / f64::from(steps);
                    let phi = core::f64::consts::TAU * (f64::from(j) + 0.5) / f64::from(steps);
                    let (sin, cos) = libm::sincos(2.0 * phi);
                    second += (1.2 * rho2 * (2.0 + cos)).powi(2) / f64::from(steps * steps);
                    across += (1.2 * rho2 * sin).powi(2) / f64::from(steps * steps);
                }
            }
            let variance = second - 1.44;
            assert!((covariance[0] / variance - 1.0).abs() < 0.05, "{covariance:?} {variance}");
            assert!((covariance[1] / across - 1.0).abs() < 0.02 && covariance[2].abs() < 1e-9, "{across}");
        }
    }

    #[test]
    fn an_elongated_spot_has_the_sigmas_that_were_asked_for() {
        let long = Aberrations { elongation_per_rad2: 0.5, ..Default::default() };
        let (sum, mean, covariance) = moments(&long.parts(&light(1.0), 0.4));
        assert!((sum - 1.0).abs() < 1e-12 && mean[0].abs() < 1e-12);
        // 1.5 times as long: what is added to 0.4^2 is 0.4^2 (1.5^2 - 1)
        assert!(
            (covariance[0] / (0.16 * 1.25) - 1.0).abs() < 0.01 && covariance[1] < 1e-12,
            "{covariance:?}"
        );
        assert_eq!(Aberrations::default().parts(&light(1.0), 0.4), [WHOLE]);
    }
}
