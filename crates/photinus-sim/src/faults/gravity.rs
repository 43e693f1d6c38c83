//! A wrong direction of gravity: turned by an angle, towards the same side of the camera in every frame.

use core::f64::consts::TAU;

use nalgebra::{Rotation3, Unit, Vector3};

use super::chance::Chance;

/// `down`, turned by `angle_rad` about an axis square to it.
pub(super) fn turn(down: &Unit<Vector3<f64>>, angle_rad: f64, chance: &Chance) -> Unit<Vector3<f64>> {
    // The camera's axis that is farthest from down gives "the same side" a meaning as long as the camera hardly turns.
    let aside = Vector3::ith_axis(down.iamin()).cross(down).normalize();
    let axis = Rotation3::from_axis_angle(down, TAU * chance.share(0)) * Unit::new_normalize(aside);
    Unit::new_normalize(Rotation3::from_axis_angle(&axis, angle_rad) * down.into_inner())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_angle_is_exact_and_every_side_is_as_likely() {
        let down = Unit::new_normalize(Vector3::new(0.1, 0.9, -0.3));
        for angle_rad in [1e-3, 5.0_f64.to_radians(), 20.0_f64.to_radians(), 3.0] {
            let mut sides = Vector3::zeros();
            for seed in 0..4000 {
                let turned = turn(&down, angle_rad, &Chance::new(seed, 0));
                let angle = libm::atan2(down.cross(&turned).norm(), down.dot(&turned));
                assert!((angle - angle_rad).abs() < 1e-12, "{angle} not {angle_rad}");
                sides +=
                    (turned.into_inner() - down.into_inner() * libm::cos(angle_rad)) / libm::sin(angle_rad);
            }
            assert!((sides / 4000.0).norm() < 4.0 / 4000.0_f64.sqrt(), "{sides}");
        }
        let chance = Chance::new(1, 0);
        assert_eq!(turn(&down, 0.3, &chance), turn(&down, 0.3, &chance));
    }
}
