//! A water surface: a mirror for markers and, ruffled, a field of glints under the sun.

use nalgebra::Vector3;

use crate::sensor::hash;

/// A level water surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Water {
    /// Its height in the world frame, m.
    pub level_m: f64,
    /// Wind that ruffles it, m/s.
    pub wind_m_s: f64,
}

impl Water {
    /// Refractive index at 395 nm (Hale and Querry, 1973).
    const INDEX: f64 = 1.343;
    /// Glints that share the sun's light.
    pub const GLINTS: u64 = 60;

    /// The mirror image of a point, m.
    pub fn mirrored(&self, point_m: &Vector3<f64>) -> Vector3<f64> {
        Vector3::new(point_m.x, point_m.y, 2.0 * self.level_m - point_m.z)
    }

    /// Share of unpolarised light that is reflected, by Fresnel's equations, for the cosine of the angle of incidence.
    pub fn reflectance(cos: f64) -> f64 {
        let cos = cos.clamp(0.0, 1.0);
        let inside = (1.0 - (1.0 - cos * cos) / (Self::INDEX * Self::INDEX)).sqrt();
        let across = (cos - Self::INDEX * inside) / (cos + Self::INDEX * inside);
        let along = (Self::INDEX * cos - inside) / (Self::INDEX * cos + inside);
        0.5 * (across * across + along * along)
    }

    /// Direction towards glint `index`, and its share of the sun's light, for a sun towards `sun`; `key` changes with the
    /// frame: waves move by their own length between frames.
    ///
    /// Slopes of the surface are Gaussian with variance 0.003 + 0.00512 per m/s of wind (Cox and Munk, 1954); the glints share
    /// the light that a flat mirror would send.
    pub fn glint(&self, sun: &Vector3<f64>, index: u64, key: u64) -> Option<(Vector3<f64>, f64)> {
        let uniform = |salt: u64| (hash(hash(key ^ salt) ^ index) >> 11) as f64 / (1_u64 << 53) as f64;
        let slope = (0.5 * (0.003 + 0.005_12 * self.wind_m_s)).sqrt();
        let radius = slope * (-2.0 * libm::log(1.0 - uniform(1))).sqrt();
        let (sin, cos) = libm::sincos(core::f64::consts::TAU * uniform(2));
        let normal = Vector3::new(radius * cos, radius * sin, 1.0).normalize();
        let cos_incidence = normal.dot(sun);
        let towards_water = sun - normal * (2.0 * cos_incidence);
        let brightness = -libm::log(1.0 - uniform(3)) / Self::GLINTS as f64;
        let seen = cos_incidence > 0.0 && towards_water.z < 0.0;
        seen.then(|| (towards_water, brightness * Self::reflectance(cos_incidence)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reflectance_is_that_of_water() {
        assert!((Water::reflectance(1.0) - 0.021_4).abs() < 1e-4, "((n - 1) / (n + 1))^2");
        assert!((Water::reflectance(0.0) - 1.0).abs() < 1e-12);
        // Brewster's angle, atan(1.343): only light polarised across is reflected, ((n^2 - 1) / (n^2 + 1))^2 / 2
        let cos = 1.0 / libm::hypot(1.0, 1.343);
        let squared = 1.343 * 1.343;
        let expected = 0.5 * ((squared - 1.0) / (squared + 1.0)) * ((squared - 1.0) / (squared + 1.0));
        assert!((Water::reflectance(cos) - expected).abs() < 1e-9);
    }

    #[test]
    fn glints_lie_about_the_mirror_image_of_the_sun_and_share_its_light() {
        let water = Water { level_m: 0.0, wind_m_s: 3.0 };
        let sun = Vector3::new(0.6, 0.0, 0.8);
        let glints: Vec<_> = (0..200)
            .flat_map(|key| (0..Water::GLINTS).filter_map(move |i| water.glint(&sun, i, key)))
            .collect();
        let mean = glints.iter().map(|glint| glint.0).sum::<Vector3<f64>>() / glints.len() as f64;
        assert!((mean.normalize() - Vector3::new(0.6, 0.0, -0.8)).norm() < 0.01, "{mean}");
        let light: f64 = glints.iter().map(|glint| glint.1).sum::<f64>() / 200.0;
        assert!((light / Water::reflectance(0.8) - 1.0).abs() < 0.1, "{light}");
        assert!((water.mirrored(&Vector3::new(1.0, 2.0, 3.0)) - Vector3::new(1.0, 2.0, -3.0)).norm() < 1e-12);
    }
}
