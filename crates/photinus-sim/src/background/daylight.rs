//! Sky and ground in the ultraviolet, and the sun's own light.
//!
//! Spectral irradiances near 395 nm are those of ASTM G173 to one digit: 0.6 W/m^2/nm direct and 0.25 from the sky with the
//! sun high. The clear sky is brightest along and against the sun (Rayleigh's phase function) and towards the horizon; the
//! overcast one is that of Moon and Spencer (CIE). The filter's band is taken as 30 nm.

use core::f64::consts::PI;

use nalgebra::{Unit, Vector3};

const BAND_NM: f64 = 30.0;
const DIRECT_W_M2_NM: f64 = 0.6;
const SKY_W_M2_NM: f64 = 0.25;
/// Share of ultraviolet light that grass, soil and concrete reflect, about.
const GROUND_REFLECTANCE: f64 = 0.05;
/// Optical depth of clear air at 395 nm: Rayleigh 0.38, aerosol 0.15.
const OPTICAL_DEPTH: f64 = 0.53;

/// The kind of sky.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sky {
    /// Blue, with the sun.
    Clear,
    /// Clouds all over, no sun.
    Overcast,
}

/// Light that does not come from markers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Daylight {
    sky: Sky,
    sun: Unit<Vector3<f64>>,
}

impl Daylight {
    /// Angular radius of the sun, rad.
    pub const SUN_RADIUS_RAD: f64 = 4.65e-3;

    /// Sine of the elevation over which ground turns into sky: trees and haze, and the background's grid of 16 px.
    const SOFT_HORIZON: f64 = 0.06;

    /// Light of a sky with the sun in a direction of the world frame; none at all with the sun below the horizon.
    pub fn new(sky: Sky, sun: Unit<Vector3<f64>>) -> Self {
        Self { sky, sun }
    }

    /// Direction of the sun where it shines.
    pub fn sun(&self) -> Option<&Unit<Vector3<f64>>> {
        (self.sky == Sky::Clear && self.sun.z > 0.0).then_some(&self.sun)
    }

    /// Irradiance of the sun on a surface that faces it, W/m^2: Beer's law, against an air mass of 1.5 of the standard.
    pub fn sun_w_m2(&self) -> f64 {
        let air_mass = 1.0 / self.sun.z.max(0.02);
        self.sun().map_or(0.0, |_| DIRECT_W_M2_NM * BAND_NM * libm::exp(-OPTICAL_DEPTH * (air_mass - 1.5)))
    }

    /// Radiance from a direction of the world frame, W/m^2/sr, the sun's disc left out.
    pub fn radiance(&self, direction: &Vector3<f64>) -> f64 {
        let up = direction.z.clamp(0.0, 1.0);
        let zenith = SKY_W_M2_NM * BAND_NM / PI * self.sun.z.max(0.0);
        let sky = match self.sky {
            Sky::Clear => {
                let cos = direction.dot(&self.sun);
                zenith * (1.6 - 0.6 * up) * 0.75 * (1.0 + cos * cos)
            }
            Sky::Overcast => zenith * (1.0 + 2.0 * up) / 3.0,
        };
        let above = (0.5 + 0.5 * direction.z / Self::SOFT_HORIZON).clamp(0.0, 1.0);
        self.ground() + (sky - self.ground()) * above
    }

    /// Radiance of the ground, W/m^2/sr: it reflects sun and sky evenly.
    fn ground(&self) -> f64 {
        let from_sky = SKY_W_M2_NM * BAND_NM * self.sun.z.max(0.0);
        GROUND_REFLECTANCE / PI * (from_sky + self.sun_w_m2() * self.sun.z.max(0.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sun(elevation_deg: f64) -> Unit<Vector3<f64>> {
        let (sin, cos) = libm::sincos(elevation_deg.to_radians());
        Unit::new_normalize(Vector3::new(cos, 0.0, sin))
    }

    #[test]
    fn the_sun_is_weaker_near_the_horizon_and_gone_below_it() {
        let high = Daylight::new(Sky::Clear, sun(41.81)); // air mass 1.5
        assert!((high.sun_w_m2() - 18.0).abs() < 0.01);
        let low = Daylight::new(Sky::Clear, sun(10.0)).sun_w_m2();
        assert!((low / 18.0 - libm::exp(-0.53 * (5.758_77 - 1.5))).abs() < 1e-5, "{low}");
        let night = Daylight::new(Sky::Clear, sun(-5.0));
        assert!(night.sun().is_none() && night.sun_w_m2() <= 0.0 && night.radiance(&Vector3::z()) <= 0.0);
        assert!(Daylight::new(Sky::Overcast, sun(40.0)).sun().is_none());
    }

    #[test]
    fn skies_have_the_shape_of_their_laws() {
        let overcast = Daylight::new(Sky::Overcast, sun(30.0));
        let (sin, cos) = (0.1, 0.99_f64.sqrt());
        let low = overcast.radiance(&Vector3::new(0.0, cos, sin));
        assert!((overcast.radiance(&Vector3::z()) / low - 3.0 / 1.2).abs() < 1e-12, "CIE: 1 + 2 sin");
        let clear = Daylight::new(Sky::Clear, sun(30.0));
        let across = Vector3::new(-0.5, 0.0, 3.0_f64.sqrt() / 2.0);
        assert!(clear.radiance(&sun(30.0)) > 1.9 * clear.radiance(&across), "Rayleigh: 2 to 1 at 90 deg");
        assert!(clear.radiance(&-Vector3::z()) < clear.radiance(&Vector3::z()), "the ground is dark");
    }
}
