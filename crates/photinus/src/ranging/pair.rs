//! The angle between two adjacent markers of a ring -> the paper's two distances.
//!
//! Both are for a level target seen from the side. Perpendicular (case A) supposes that the line of sight
//! halves the pair, inline (case B) that one marker of the pair lies on it. For a front pair, one whose
//! middle is within pi / n of the line of sight, the truth lies between: l_B <= l <= l_A. The upper half, l
//! <= l_A, holds for every adjacent pair in any attitude, because no view of a pair is wider than the
//! perpendicular one.
//!
//! Known limitation: an adjacent pair further to the side looks narrower than case B allows for, so l_B > l
//! for it. Such pairs show whenever a lobe reaches past 2 pi / n: on a hexarotor of bare LEDs with markers 20
//! and 80 deg from the line of sight, l_B is a third too far. The tests pin both; strict bounds are
//! [`DistanceBounds`](super::DistanceBounds).

use core::f64::consts::{PI, TAU};

use crate::airframe::RingGeometry;

/// Two neighbouring markers on a ring.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AdjacentPair {
    /// d / 2: half the distance between the markers, m.
    half_side_m: f64,
    /// v: distance of the ring's centre from the middle of the pair, m.
    apothem_m: f64,
    /// R sin(2 pi / n): distance of a marker from the line through its neighbour and the centre, m.
    inline_side_m: f64,
    /// R cos(2 pi / n): how far along that line, from the centre towards the neighbour, m.
    inline_ahead_m: f64,
}

impl AdjacentPair {
    /// The adjacent markers of a ring.
    pub fn of(ring: &RingGeometry) -> Self {
        let count = ring.markers as f64;
        let (half_sin, half_cos) = libm::sincos(PI / count);
        let (sin, cos) = libm::sincos(TAU / count);
        Self {
            half_side_m: ring.radius_m * half_sin,
            apothem_m: ring.radius_m * half_cos,
            inline_side_m: ring.radius_m * sin,
            inline_ahead_m: ring.radius_m * cos,
        }
    }

    /// l_A, paper (5): (d/2) cot(alpha/2) + v, m. `None` unless alpha is inside (0, pi).
    pub fn perpendicular_m(&self, alpha_rad: f64) -> Option<f64> {
        is_pair_angle(alpha_rad).then(|| self.half_side_m / libm::tan(alpha_rad / 2.0) + self.apothem_m)
    }

    /// l_B, paper (6): R sin(2 pi/n) cot(alpha) + R cos(2 pi/n), m. `None` unless alpha is inside (0, pi).
    pub fn inline_m(&self, alpha_rad: f64) -> Option<f64> {
        is_pair_angle(alpha_rad).then(|| {
            let (sin, cos) = libm::sincos(alpha_rad);
            self.inline_side_m * cos / sin + self.inline_ahead_m
        })
    }

    /// alpha_A: the angle of a perpendicular pair at `distance_m` from the centre, rad, the inverse of (5).
    /// `None` at or inside the middle of the pair.
    pub fn perpendicular_angle_rad(&self, distance_m: f64) -> Option<f64> {
        let ahead_m = distance_m - self.apothem_m;
        (ahead_m > 0.0).then(|| 2.0 * libm::atan2(self.half_side_m, ahead_m))
    }

    /// alpha_B: the angle of an inline pair at `distance_m` from the centre, rad, the inverse of (6). `None`
    /// where the farther marker is beside or behind the camera.
    pub fn inline_angle_rad(&self, distance_m: f64) -> Option<f64> {
        let ahead_m = distance_m - self.inline_ahead_m;
        (ahead_m > 0.0).then(|| libm::atan2(self.inline_side_m, ahead_m))
    }

    /// The perpendicular distance for a given half angle, m: paper (10) is printed in this form.
    pub(super) fn perpendicular_from_half_m(&self, half_rad: f64) -> Option<f64> {
        self.perpendicular_m(2.0 * half_rad)
    }
}

fn is_pair_angle(alpha_rad: f64) -> bool {
    alpha_rad > 0.0 && alpha_rad < PI
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;

    fn pair(markers: usize, radius_m: f64) -> AdjacentPair {
        AdjacentPair::of(&RingGeometry { markers, radius_m })
    }

    /// Angle between two markers of a level ring at `yaws_rad` from the line of sight, seen from
    /// `distance_m`.
    fn angle_rad(radius_m: f64, yaws_rad: [f64; 2], distance_m: f64) -> f64 {
        let side = |yaw: f64| libm::atan2(radius_m * libm::sin(yaw), distance_m - radius_m * libm::cos(yaw));
        (side(yaws_rad[0]) - side(yaws_rad[1])).abs()
    }

    #[test]
    fn hexagon_is_as_the_paper_states_it() {
        let hexagon = pair(6, 0.4);
        let height_m = 0.4 * 3.0_f64.sqrt() / 2.0;
        for alpha_rad in [1e-3, 0.05, 0.3, 1.0, 2.0, 3.0] {
            let cot = 1.0 / libm::tan(alpha_rad);
            let l_b = hexagon.inline_m(alpha_rad).unwrap();
            assert!((l_b - (height_m * cot + 0.2)).abs() < 1e-9 * (1.0 + l_b.abs()));
            let l_a = hexagon.perpendicular_m(alpha_rad).unwrap();
            let expected_m = 0.2 / libm::tan(alpha_rad / 2.0) + height_m;
            assert!((l_a - expected_m).abs() < 1e-9 * l_a);
        }
    }

    #[test]
    fn distances_and_angles_are_inverse_and_geometric() {
        for (markers, radius_m) in [(3, 0.3), (4, 0.245), (6, 0.4), (8, 0.5)] {
            let pair = pair(markers, radius_m);
            let step_rad = TAU / markers as f64;
            for distance_m in [0.7, 2.0, 5.0, 14.0, 60.0] {
                let a_rad = angle_rad(radius_m, [step_rad / 2.0, -step_rad / 2.0], distance_m);
                assert!((pair.perpendicular_m(a_rad).unwrap() - distance_m).abs() < 1e-9);
                assert!((pair.perpendicular_angle_rad(distance_m).unwrap() - a_rad).abs() < 1e-12);
                let b_rad = angle_rad(radius_m, [0.0, step_rad], distance_m);
                assert!((pair.inline_m(b_rad).unwrap() - distance_m).abs() < 1e-9);
                assert!((pair.inline_angle_rad(distance_m).unwrap() - b_rad).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn front_pair_of_a_level_ring_is_between_inline_and_perpendicular() {
        for (markers, radius_m) in [(4, 0.245), (6, 0.4), (8, 0.5)] {
            let pair = pair(markers, radius_m);
            let step_rad = TAU / markers as f64;
            for step in 0..=200 {
                let first_rad = -step_rad * f64::from(step) / 200.0;
                for distance_m in [1.0, 3.0, 10.0, 40.0] {
                    let alpha_rad = angle_rad(radius_m, [first_rad, first_rad + step_rad], distance_m);
                    let l_a = pair.perpendicular_m(alpha_rad).unwrap();
                    let l_b = pair.inline_m(alpha_rad).unwrap();
                    assert!(l_b <= distance_m + 1e-9 && distance_m <= l_a + 1e-9, "{l_b} {distance_m} {l_a}");
                }
            }
        }
    }

    #[test]
    fn perpendicular_is_the_farthest_for_every_pair_in_any_attitude() {
        let (radius_m, distance_m) = (0.4, 3.0);
        let pair = pair(6, radius_m);
        let marker = |yaw: f64| Vector3::new(libm::cos(yaw), libm::sin(yaw), 0.0) * radius_m;
        for step in 0..5000 {
            let z = f64::from(2 * step + 1) / 5000.0 - 1.0;
            let (sin, cos) = libm::sincos(2.4 * f64::from(step));
            let camera_m =
                Vector3::new((1.0 - z * z).sqrt() * cos, (1.0 - z * z).sqrt() * sin, z) * distance_m;
            let alpha_rad = (marker(0.0) - camera_m).angle(&(marker(TAU / 6.0) - camera_m));
            assert!(pair.perpendicular_m(alpha_rad).unwrap() > distance_m - 1e-9);
        }
    }

    #[test]
    fn side_pair_of_a_hexarotor_is_nearer_than_inline_says() {
        let alpha_rad = angle_rad(0.4, [20.0_f64.to_radians(), 80.0_f64.to_radians()], 5.0);
        let l_b = pair(6, 0.4).inline_m(alpha_rad).unwrap();
        assert!(l_b > 1.25 * 5.0, "{l_b}");
    }

    #[test]
    fn angles_outside_zero_to_pi_give_nothing() {
        for alpha_rad in [0.0, -0.1, PI, 4.0, f64::NAN, f64::INFINITY] {
            assert_eq!(pair(6, 0.4).perpendicular_m(alpha_rad), None);
            assert_eq!(pair(6, 0.4).inline_m(alpha_rad), None);
        }
        assert_eq!(pair(6, 0.4).perpendicular_angle_rad(0.3), None);
        assert_eq!(pair(6, 0.4).inline_angle_rad(f64::NAN), None);
    }
}
