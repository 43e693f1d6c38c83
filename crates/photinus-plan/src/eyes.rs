//! From where on the light harms no eye.
//!
//! Limits are those of IEC 62471:2006 (ICNIRP's for incoherent radiation), for near ultraviolet of 315 to 400 nm on the eye,
//! weighted by nothing:
//!
//! ```text
//! up to 1000 s     10 000 J/m^2
//! longer           10 W/m^2                        IEC 62471, 4.3.2; "exempt" below it at the distance of assessment
//! a working day    10 000 J/m^2 in 8 h: 0.347 W/m^2     ICNIRP 2004; Directive 2006/25/EC, annex I
//! risk groups      33 W/m^2 for group 1, 100 W/m^2 for group 2, at 0.2 m     IEC 62471, 6.1
//! ```
//!
//! All LEDs are taken to shine from one place, at the direction in which they send the most. What the standard's actinic limit
//! (weights of 4e-5 near 395 nm) and its blue-light limit for small sources (weights of 0.05 and less) allow is more than that at these wavelengths.

use nalgebra::Vector3;
use serde::Serialize;

use crate::setup::Setup;

/// For more than 1000 s, W/m^2 (IEC 62471, 4.3.2).
const LONG_W_M2: f64 = 10.0;
/// For 8 h, W/m^2: 10 kJ/m^2 (ICNIRP 2004).
const DAY_W_M2: f64 = 10_000.0 / (8.0 * 3600.0);
/// Limits of risk groups 1 and 2, W/m^2, and where lamps of no certain use are assessed, m (IEC 62471, 6.1).
const GROUPS_W_M2: [f64; 2] = [33.0, 100.0];
const ASSESSED_M: f64 = 0.2;

/// From where on the light harms no eye.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Eyes {
    /// Most that all LEDs send in one direction, W/sr.
    pub intensity_w_per_sr: f64,
    /// Who looks into it for more than 1000 s is no nearer, m (IEC 62471: 10 W/m^2).
    pub long_m: f64,
    /// Who works beside it for 8 h is no nearer, m (ICNIRP: 10 kJ/m^2 a day).
    pub day_m: f64,
    /// Irradiance at 0.2 m, W/m^2.
    pub at_assessment_w_m2: f64,
    /// Risk group by it, near ultraviolet only: 0 is exempt, 3 the highest.
    pub risk_group: u8,
}

impl Eyes {
    pub(crate) fn of(setup: &Setup) -> Self {
        let intensity_w_per_sr = setup.emitter.peak_w_per_sr * most_intensity(setup);
        let at_assessment_w_m2 = intensity_w_per_sr / (ASSESSED_M * ASSESSED_M);
        let limits = [LONG_W_M2, GROUPS_W_M2[0], GROUPS_W_M2[1]];
        Self {
            intensity_w_per_sr,
            long_m: (intensity_w_per_sr / LONG_W_M2).sqrt(),
            day_m: (intensity_w_per_sr / DAY_W_M2).sqrt(),
            at_assessment_w_m2,
            risk_group: limits.iter().filter(|limit| at_assessment_w_m2 > **limit).count() as u8,
        }
    }
}

/// The most that all LEDs together send in one direction, 1 being one straight ahead: over a fine net of directions.
fn most_intensity(setup: &Setup) -> f64 {
    const FAR_M: f64 = 1e4;
    const NET: u32 = 90;
    let airframe = &setup.airframe;
    let sent = |towards: Vector3<f64>| -> f64 {
        (0..airframe.markers().len()).map(|marker| airframe.intensity(marker, &(towards * FAR_M))).sum()
    };
    let directions = (0..=NET).flat_map(|row| {
        let (sin_up, cos_up) = libm::sincos(core::f64::consts::PI * (f64::from(row) / f64::from(NET) - 0.5));
        (0..2 * NET).map(move |column| {
            let (sin, cos) = libm::sincos(core::f64::consts::PI * f64::from(column) / f64::from(NET));
            Vector3::new(cos * cos_up, sin * cos_up, sin_up)
        })
    });
    directions.map(sent).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::EXAMPLE;

    #[test]
    fn distances_are_those_of_a_hand_calculation() {
        let setup = Setup::parse(EXAMPLE, Path::new("set-up.toml")).unwrap();
        let eyes = Eyes::of(&setup);
        // six LEDs every 60 deg: ahead of one 1 + 2 cos 60 = 2, between two 2 cos 30 = 1.73; 200 mW / pi each
        let expected = 2.0 * 0.2 / core::f64::consts::PI;
        assert!((eyes.intensity_w_per_sr / expected - 1.0).abs() < 1e-3, "{eyes:?}");
        // sqrt(0.1273 / 10) and sqrt(0.1273 / 0.3472); 0.1273 / 0.04 = 3.18 W/m^2
        assert!((eyes.long_m - 0.1128).abs() < 1e-3 && (eyes.day_m - 0.6055).abs() < 2e-3, "{eyes:?}");
        assert!((eyes.at_assessment_w_m2 - 3.183).abs() < 0.01 && eyes.risk_group == 0, "{eyes:?}");
    }

    #[test]
    fn a_hundred_times_the_light_is_of_a_higher_group_ten_times_as_far() {
        let mut setup = Setup::parse(EXAMPLE, Path::new("set-up.toml")).unwrap();
        let one = Eyes::of(&setup);
        setup.emitter.peak_w_per_sr *= 100.0;
        let many = Eyes::of(&setup);
        assert!((many.long_m / one.long_m - 10.0).abs() < 1e-9 && many.risk_group == 3, "{many:?}");
    }
}
