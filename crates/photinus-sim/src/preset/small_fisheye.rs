//! A small UV fisheye camera on a single-board computer, 960x600: spots 5 to 10 px wide, a driver that bends bright levels.

use core::f64::consts::PI;

use super::Preset;
use crate::optics::{Gaussian, Lens, PointSpread};
use crate::sensor::{ColumnSmear, Converter, Overflow, Pattern, Response, Sensor, Shutter};
use crate::source::Emitter;

/// What is fitted of this camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SmallFisheyeFit {
    /// Sigma of the point spread's core, px.
    pub core_px: f64,
    /// Share of the light in the skirt around it.
    pub skirt_share: f64,
    /// Sigma of the skirt, px.
    pub skirt_px: f64,
    /// Where bright levels end, grey levels above the dark offset.
    pub ceiling_dn: f64,
    /// Share of the light that passes, for an exposure of 1000 us and an LED of 200 mW; neither is known.
    pub transmission: f64,
}

/// What `fit_preset` found for photos of a board of LEDs from 0.5 m to 1.7 m.
pub const SMALL_FISHEYE_FIT: SmallFisheyeFit = SmallFisheyeFit {
    core_px: 1.057,
    skirt_share: 0.0548,
    skirt_px: 3.806,
    ceiling_dn: 227.9,
    transmission: 0.020_39,
};

/// The camera with `fit` for what is not known of it.
///
/// Offset, its rise towards the corners and the noise of dark pixels are those of the photos' dark parts. No pixel overflows:
/// levels bend long before.
pub fn small_fisheye(fit: &SmallFisheyeFit) -> Preset {
    let core = Gaussian { share: 1.0 - fit.skirt_share, sigma_px: fit.core_px };
    let skirt = Gaussian { share: fit.skirt_share, sigma_px: fit.skirt_px };
    Preset {
        emitter: Emitter { peak_w_per_sr: 0.2 / PI, radius_m: 5e-4, unit_spread: 0.05, wavelength_m: 395e-9 },
        lens: Lens {
            pupil_m2: PI * 0.39e-3 * 0.39e-3,
            transmission: fit.transmission,
            side_illumination: 0.6,
            vignette: None,
            falloff: None,
            spread: PointSpread::new(vec![core, skirt], 0.1).expect("shares of a fit sum to 1"),
            veiling_glare: 0.0,
        },
        sensor: Sensor {
            quantum_efficiency: 0.34,
            response: Response::Soft { ceiling_dn: fit.ceiling_dn },
            electrons_per_dn: 33.0,
            full_well_e: 1e9,
            well_noise_e: 0.0,
            overflow: Overflow { spill: 0.0 },
            smear: ColumnSmear::NONE,
            read_noise_e: 9.0,
            dark_offset_dn: 20.5,
            corner_offset_dn: 8.0,
            dark_current_e_per_s: 0.0,
            hot_pixel_share: 0.0,
            hot_pixel_e_per_s: 0.0,
            pattern: Pattern::NONE,
            converter: Converter::EIGHT_BITS,
            shutter: Shutter::Global,
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::receding::RecedingLed;

    #[test]
    fn spots_are_as_large_as_in_the_photos() {
        // pixels per LED at or above 60, 125 and 205 of 255, counted in photos from 1.17 m and 0.52 m
        for (distance_m, off_axis_deg, counts) in
            [(1.17, 23.0_f64, [28.8, 19.5, 11.4]), (0.52, 41.0, [42.7, 27.6, 17.2])]
        {
            for (threshold_dn, count) in [60, 125, 205].into_iter().zip(counts) {
                let Preset { emitter, lens, sensor } = small_fisheye(&SMALL_FISHEYE_FIT);
                let exposure_us = 1000.0 * lens.illumination(off_axis_deg.to_radians());
                let led = RecedingLed { emitter, lens, sensor, rad_per_px: 2.15e-3, threshold_dn };
                let places = [[0.0, 0.0], [0.5, 0.0], [0.25, 0.25], [0.5, 0.5], [0.25, 0.0], [0.5, 0.25]];
                let sum: u32 = places.iter().map(|&place| led.area_px(distance_m, exposure_us, place)).sum();
                let area_px = f64::from(sum) / places.len() as f64;
                assert!(
                    (area_px - count).abs() < 2.0 + 0.15 * count,
                    "{area_px} not {count} at {threshold_dn}"
                );
            }
        }
    }
}
