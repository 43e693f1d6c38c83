//! The lens: how much of a light it gathers, and how it spreads a point over pixels.
//!
//! Projection is that of any [`photinus::camera::Camera`]. A [`Lens`] adds what a projection does not say: pupil,
//! transmission (with the filter), relative illumination off the axis, point spread, veiling glare.

mod aberration;
mod gaussian;
mod moffat;
mod sampled;
mod spread;
mod vignette;
mod zones;

pub use aberration::Aberrations;
pub use gaussian::Gaussian;
pub use sampled::SampledSpread;
pub use spread::{PointLight, PointSpread};
pub use vignette::{Falloff, Vignette};
pub use zones::ZonedSpread;

/// A lens and filter in front of the sensor.
#[derive(Clone, Debug, PartialEq)]
pub struct Lens {
    /// Area of the entrance pupil, m^2.
    pub pupil_m2: f64,
    /// Share of the markers' light that passes lens and filter.
    pub transmission: f64,
    /// Relative illumination at 90 deg off the axis, against that on it.
    pub side_illumination: f64,
    /// What the rims of the lens cut off besides.
    pub vignette: Option<Vignette>,
    /// Relative illumination as it was measured: in place of both.
    pub falloff: Option<Falloff>,
    /// How a point of light spreads over pixels.
    pub spread: PointSpread,
    /// Share of all light in the image that is scattered evenly over it (veiling glare index, ISO 9358).
    pub veiling_glare: f64,
}

impl Lens {
    /// Relative illumination at an angle off the axis: falls with its square to [`Lens::side_illumination`] at 90 deg, and
    /// on to nothing. A fisheye's pupil turns and grows with the angle, so the cos^4 of a plain lens does not hold.
    pub fn illumination(&self, off_axis_rad: f64) -> f64 {
        if let Some(falloff) = &self.falloff {
            return falloff.share(off_axis_rad);
        }
        let share = off_axis_rad / core::f64::consts::FRAC_PI_2;
        let open = self.vignette.map_or(1.0, |vignette| vignette.open(off_axis_rad));
        (1.0 - (1.0 - self.side_illumination) * share * share).max(0.0) * open
    }

    /// Power that reaches the sensor, W, from an irradiance at the pupil.
    pub fn gathered_w(&self, irradiance_w_m2: f64, off_axis_rad: f64) -> f64 {
        irradiance_w_m2 * self.pupil_m2 * self.transmission * self.illumination(off_axis_rad)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gathered_power_is_pupil_times_transmission_times_illumination() {
        let spread = PointSpread::new(vec![Gaussian { share: 1.0, sigma_px: 0.5 }], 0.0).unwrap();
        let lens = Lens {
            pupil_m2: 5e-7,
            transmission: 0.1,
            side_illumination: 0.6,
            vignette: None,
            falloff: None,
            spread,
            veiling_glare: 0.0,
        };
        assert!((lens.gathered_w(0.06, 0.0) - 3e-9).abs() < 1e-20);
        assert!((lens.illumination(core::f64::consts::FRAC_PI_2) - 0.6).abs() < 1e-12);
        assert!((lens.illumination(core::f64::consts::FRAC_PI_4) - 0.9).abs() < 1e-12);
        assert!(lens.illumination(3.0) <= 0.0);
        let cut = Lens { vignette: Vignette::new(0.2, 1.0), ..lens };
        assert!(cut.illumination(0.1) > 0.99 && cut.illumination(1.1) <= 0.0);
    }
}
