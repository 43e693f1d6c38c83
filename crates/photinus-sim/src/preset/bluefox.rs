//! mvBlueFOX-MLC200wG with Sunnex DSL215 and Midopt BP365, looking at ProLight PM2B-1LLE: the paper's set.

use core::f64::consts::PI;

use super::{Fitted, Preset};
use crate::optics::{Gaussian, Lens, PointSpread};
use crate::sensor::{ColumnSmear, Converter, Overflow, Pattern, Response, Sensor, Shutter};
use crate::source::Emitter;

/// What `fit_preset` found for the paper's figures 10 and 11.
pub const BLUEFOX_FIT: Fitted = Fitted {
    core_px: 0.301,
    skirt_share: 0.4915,
    skirt_px: 2.239,
    well: 4.869,
    spill: 0.999,
    transmission: 0.1045,
};

/// The paper's camera and LED, with `fitted` for what no data sheet says.
///
/// From data sheets and the paper: quantum efficiency at 395 nm, wavelength, an entrance pupil of 1.55 mm / 2.0, a face of
/// 1 mm. Assumed, because spot sizes do not depend on them: 200 mW of radiant flux (the fitted transmission makes up for
/// it), 60 electrons per grey level, read noise, dark current, spread of units, illumination off the axis.
pub fn bluefox(fitted: &Fitted) -> Preset {
    let electrons_per_dn = 60.0;
    let core = Gaussian { share: 1.0 - fitted.skirt_share, sigma_px: fitted.core_px };
    let skirt = Gaussian { share: fitted.skirt_share, sigma_px: fitted.skirt_px };
    Preset {
        emitter: Emitter { peak_w_per_sr: 0.2 / PI, radius_m: 5e-4, unit_spread: 0.05, wavelength_m: 395e-9 },
        lens: Lens {
            pupil_m2: PI * 0.39e-3 * 0.39e-3,
            transmission: fitted.transmission,
            side_illumination: 0.6,
            vignette: None,
            falloff: None,
            spread: PointSpread::new(vec![core, skirt], 0.1).expect("shares of a fit sum to 1"),
            veiling_glare: 0.0,
        },
        sensor: Sensor {
            quantum_efficiency: 0.34,
            response: Response::Linear,
            electrons_per_dn,
            full_well_e: fitted.well * 255.0 * electrons_per_dn,
            well_noise_e: 0.0,
            overflow: Overflow { spill: fitted.spill },
            smear: ColumnSmear::NONE,
            read_noise_e: 30.0,
            dark_offset_dn: 0.0,
            corner_offset_dn: 0.0,
            dark_current_e_per_s: 1000.0,
            hot_pixel_share: 1e-5,
            hot_pixel_e_per_s: 1e5,
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

    fn experiment(threshold_dn: u8) -> RecedingLed {
        let Preset { emitter, lens, sensor } = bluefox(&BLUEFOX_FIT);
        RecedingLed { emitter, lens, sensor, rad_per_px: 3.7673e-3, threshold_dn }
    }

    #[test]
    fn single_pixel_spots_begin_and_prevail_where_the_paper_has_them() {
        let led = experiment(200);
        let first_m = led.first_one_px_m(1000.0); // 3.14 m in the paper
        assert!((3.08..3.2).contains(&first_m), "{first_m}");
        for (exposure_us, paper_m) in
            [(100.0, 2.12), (200.0, 3.23), (500.0, 5.06), (1000.0, 6.62), (2000.0, 8.34), (5000.0, 14.16)]
        {
            let last_m = led.last_two_px_m(exposure_us);
            assert!((last_m / paper_m - 1.0).abs() < 0.15, "{last_m} m at {exposure_us} us");
        }
        assert!((led.last_two_px_m(1000.0) / 6.62 - 1.0).abs() < 0.01);
        assert!(led.last_two_px_m(10_000.0) > 15.0, "not within 15 m");
    }

    #[test]
    fn largest_spots_follow_equation_13() {
        let led = experiment(200);
        for distance_m in [0.6, 0.75, 0.9, 1.1, 1.3, 1.6, 2.0, 2.5, 3.0] {
            let shifted_m: f64 = distance_m - 0.0154;
            let paper_px = 1.3398 + 31.4704 / (shifted_m * shifted_m);
            let largest_px = f64::from(led.areas(distance_m, 1000.0).max_px);
            assert!((largest_px - paper_px).abs() < 1.6, "{largest_px} not {paper_px} at {distance_m} m");
        }
    }

    #[test]
    fn a_flight_threshold_sees_15_m_where_200_does_not() {
        assert!(experiment(50).last_seen_m(1000.0) > 15.0 && experiment(120).last_seen_m(1000.0) < 15.0);
        // a border halves a point: in linear light 200 cannot see twice the square of 6.62 m, see docs/sensor-preset.md
        assert!(experiment(200).last_seen_m(1000.0) < 6.62 * core::f64::consts::SQRT_2);
    }
}
