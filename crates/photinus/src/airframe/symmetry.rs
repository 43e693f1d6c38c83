//! Which views of an airframe are the same view: a regular airframe needs looking at from one sector only.

use core::f64::consts::TAU;

use nalgebra::{Rotation3, Unit, Vector3};

use super::{Airframe, Lobe};

/// How far LEDs may be from coinciding, m and in the axis; far below what the table is widened by.
const TOLERANCE: f64 = 1e-12;

/// How many turns of the airframe about its z axis, each by the same part of a circle, leave its LEDs as they
/// were: at least 1.
pub(super) fn turns(airframe: &Airframe) -> usize {
    let leaves_as_is = |count: &usize| {
        let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), TAU / *count as f64);
        maps_to_itself(airframe, |vector| turn * vector)
    };
    (2..=airframe.markers().len()).rev().find(leaves_as_is).unwrap_or(1)
}

/// Whether the LEDs below the plane z = 0 mirror those above.
pub(super) fn is_mirrored(airframe: &Airframe) -> bool {
    maps_to_itself(airframe, |vector| Vector3::new(vector.x, vector.y, -vector.z))
}

fn maps_to_itself(airframe: &Airframe, map: impl Fn(&Vector3<f64>) -> Vector3<f64>) -> bool {
    let leds = airframe.leds();
    leds.iter().all(|led| {
        let (position_m, axis) = (map(&led.position_m), Unit::new_unchecked(map(&led.axis)));
        leds.iter().any(|other| {
            other.lobe == led.lobe
                && (other.power - led.power).abs() <= TOLERANCE * led.power
                && (other.position_m - position_m).norm() <= TOLERANCE
                && (led.lobe == Lobe::Omni
                    || (other.axis.into_inner() - axis.into_inner()).norm() <= TOLERANCE)
        })
    })
}

#[cfg(test)]
mod tests {
    use super::super::Ring;
    use super::*;

    fn ring(arms: usize, leds_per_arm: usize, splay_rad: f64) -> Airframe {
        Airframe::from_ring("ring", Ring { arms, radius_m: 0.3, leds_per_arm, splay_rad }).unwrap()
    }

    #[test]
    fn rings_turn_into_themselves_and_mirror() {
        for airframe in [ring(6, 1, 0.0), ring(4, 2, 1.5), ring(8, 2, 2.0)] {
            assert_eq!(turns(&airframe), airframe.markers().len());
            assert!(is_mirrored(&airframe));
        }
    }

    #[test]
    fn one_led_out_of_line_breaks_the_symmetry() {
        let mut leds = ring(6, 1, 0.0).leds().to_vec();
        leds[2].axis = Vector3::z_axis();
        let tilted = Airframe::new("tilted", leds.clone()).unwrap();
        assert_eq!(turns(&tilted), 1);
        assert!(!is_mirrored(&tilted));
        leds[5].axis = Vector3::z_axis();
        let opposite = Airframe::new("opposite", leds).unwrap();
        assert_eq!(turns(&opposite), 2);
    }

    #[test]
    fn leds_that_shine_otherwise_break_the_symmetry() {
        let symmetric = ring(6, 1, 0.0);
        let mut leds = symmetric.leds().to_vec();
        leds[0].power = 1.2;
        assert_eq!(turns(&Airframe::new("one strong", leds.clone()).unwrap()), 1);
        leds[3].power = 1.2;
        let opposite = Airframe::new("two strong", leds.clone()).unwrap();
        assert_eq!((turns(&opposite), is_mirrored(&opposite)), (2, true));
        leds[3].lobe = Lobe::Cosine { power: 3.0 };
        assert_eq!(turns(&Airframe::new("one narrow", leds).unwrap()), 1);
    }
}
