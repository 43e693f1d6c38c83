//! Arms at equal angles around the body's z axis: how most multirotors carry their markers.

use alloc::vec::Vec;
use core::f64::consts::{PI, TAU};

use nalgebra::{Unit, Vector3};

use super::{Airframe, AirframeError, Led, Lobe, Marker};

/// A preset: LEDs at the ends of equal arms in the plane z = 0, the first arm forward (yaw 0), the others
/// counter-clockwise seen from above. They shine outward, as Lambertian emitters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ring {
    /// Number of arms, 3 or more.
    pub arms: usize,
    /// Distance of the LEDs from the origin, m.
    pub radius_m: f64,
    /// 1 or 2 LEDs at the end of an arm.
    pub leds_per_arm: usize,
    /// Angle between the axes of the two LEDs of an arm, rad, in (0, pi]; 0 for a single LED.
    pub splay_rad: f64,
}

impl Ring {
    pub(super) fn leds(&self) -> Result<Vec<Led>, AirframeError> {
        let Self { arms, radius_m, leds_per_arm, splay_rad } = *self;
        if arms < 3 {
            return Err(AirframeError::RingArms { arms });
        }
        if !(radius_m > 0.0 && radius_m <= Airframe::MAX_REACH_M) {
            return Err(AirframeError::RingRadius { radius_m });
        }
        let turns: &[f64] = match leds_per_arm {
            1 => &[0.0],
            2 => &[-0.5, 0.5],
            _ => return Err(AirframeError::RingLeds { leds_per_arm }),
        };
        let splay_fits =
            if leds_per_arm == 1 { splay_rad.abs() <= 0.0 } else { splay_rad > 0.0 && splay_rad <= PI };
        if !splay_fits {
            return Err(AirframeError::RingSplay { leds_per_arm, splay_rad });
        }
        let count = arms.saturating_mul(leds_per_arm);
        if count > Airframe::MAX_LEDS {
            return Err(AirframeError::TooManyLeds { leds: count });
        }
        let on_arm = |arm: usize, turn: f64| {
            let yaw_rad = TAU * arm as f64 / arms as f64;
            Led {
                position_m: outward(yaw_rad) * radius_m,
                axis: Unit::new_normalize(outward(yaw_rad + turn * splay_rad)),
                lobe: Lobe::Lambertian,
                power: 1.0,
                signal: None,
            }
        };
        Ok((0..arms).flat_map(|arm| turns.iter().map(move |&turn| on_arm(arm, turn))).collect())
    }
}

fn outward(yaw_rad: f64) -> Vector3<f64> {
    let (sin, cos) = libm::sincos(yaw_rad);
    Vector3::new(cos, sin, 0.0)
}

/// Markers at equal angles and equal distance around the body's z axis, all at one height: what the paper's
/// equations (5) to (12) are about.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RingGeometry {
    /// Number of markers, 3 or more.
    pub markers: usize,
    /// Their distance from the z axis, m.
    pub radius_m: f64,
}

impl RingGeometry {
    /// How far a marker may be off the ring, as a share of the radius.
    const TOLERANCE: f64 = 1e-3;

    /// The ring that `markers` form, in any order and from any first yaw.
    pub(super) fn detect(markers: &[Marker]) -> Option<Self> {
        let count = markers.len() as f64;
        let height_m = markers.iter().map(|marker| marker.position_m.z).sum::<f64>() / count;
        let radius_of = |marker: &Marker| libm::hypot(marker.position_m.x, marker.position_m.y);
        let radius_m = markers.iter().map(radius_of).sum::<f64>() / count;
        let tolerance_m = Self::TOLERANCE * radius_m;
        let on_circle = |marker: &Marker| {
            (radius_of(marker) - radius_m).abs() <= tolerance_m
                && (marker.position_m.z - height_m).abs() <= tolerance_m
        };
        if markers.len() < 3 || !markers.iter().all(on_circle) {
            return None;
        }
        let yaw_of = |marker: &Marker| libm::atan2(marker.position_m.y, marker.position_m.x);
        let mut yaws_rad: Vec<f64> = markers.iter().map(yaw_of).collect();
        yaws_rad.sort_unstable_by(f64::total_cmp);
        let first_rad = yaws_rad[0];
        yaws_rad.push(first_rad + TAU);
        let step_rad = TAU / count;
        let regular = yaws_rad.windows(2).all(|w| (w[1] - w[0] - step_rad).abs() <= 2.0 * Self::TOLERANCE);
        regular.then_some(Self { markers: markers.len(), radius_m })
    }
}
