//! What an LED sends out: radiant intensity, its spread between units, its blinking.
//!
//! An [`Emitter`] is the part, common to all LEDs of a scene; the lobe of each LED is that of its airframe
//! ([`photinus::airframe::Lobe`]) unless the vehicle says another ([`Lobe`]): for a Lambertian one, intensity falls with the cosine of the angle to the axis
//! (paper, figure 8). Irradiance at the camera follows from the inverse square of the distance.

mod blink;
mod faults;
pub(crate) mod lobe;

pub use blink::Blink;
pub use faults::LedFaults;
pub use lobe::Lobe;

/// An LED as a part: how much it radiates, from how large a face, how equal its units are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Emitter {
    /// Radiant intensity on the axis, W/sr; for a Lambertian face radiant flux / pi.
    pub peak_w_per_sr: f64,
    /// Radius of the face that shines, m.
    pub radius_m: f64,
    /// Spread of intensity between units (bins and currents): sigma of its logarithm.
    pub unit_spread: f64,
    /// Wavelength, m.
    pub wavelength_m: f64,
}

impl Emitter {
    /// Irradiance at a distance, W/m^2, of an LED that shows `lobe` (0 to 1) of its peak intensity: I / l^2.
    pub fn irradiance_w_m2(&self, lobe: f64, distance_m: f64) -> f64 {
        self.peak_w_per_sr * lobe / (distance_m * distance_m)
    }

    /// How bright a unit is against the mean part, for a standard normal `draw`.
    pub fn unit_factor(&self, draw: f64) -> f64 {
        libm::exp(self.unit_spread * draw)
    }

    /// Energy of a photon, J: h c / lambda (CODATA 2018, exact).
    pub fn photon_j(&self) -> f64 {
        const PLANCK_J_S: f64 = 6.626_070_15e-34;
        const LIGHT_M_S: f64 = 299_792_458.0;
        PLANCK_J_S * LIGHT_M_S / self.wavelength_m
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn irradiance_and_photons_are_those_of_a_hand_calculation() {
        let emitter = Emitter {
            peak_w_per_sr: 0.2 / core::f64::consts::PI,
            radius_m: 5e-4,
            unit_spread: 0.1,
            wavelength_m: 395e-9,
        };
        // 200 mW Lambertian: 63.66 mW/sr ahead; at 2 m and 60 deg off its axis 63.66 * 0.5 / 4 mW/m^2
        assert!((emitter.irradiance_w_m2(0.5, 2.0) - 7.957_747e-3).abs() < 1e-8);
        // 1239.84 eV nm / 395 nm = 3.1388 eV
        assert!((emitter.photon_j() / 1.602_176_634e-19 - 3.138_84).abs() < 1e-4);
        assert!((emitter.unit_factor(-1.0) - 0.904_837).abs() < 1e-6);
    }
}
