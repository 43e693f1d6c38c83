//! Where something may be: a part of a cone between two distances.

use nalgebra::{UnitVector3, Vector3};
use photinus::ranging::Interval;

/// Every place whose direction is within an angle of an axis and whose distance from the origin is within bounds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sector {
    /// The middle of the directions, in the level frame.
    pub axis: UnitVector3<f64>,
    /// The angle, rad, 0 to pi.
    pub half_angle_rad: f64,
    /// The distances.
    pub distances: Interval,
}

impl Sector {
    /// How far `point` is from the nearest place of the sector, m; zero inside.
    pub fn distance_m(&self, point: &Vector3<f64>) -> f64 {
        let (near, far) = (self.distances.min_m(), self.distances.max_m());
        let range = point.norm();
        let outside_rad =
            libm::atan2(point.cross(&self.axis).norm(), point.dot(&self.axis)) - self.half_angle_rad;
        // Every direction is in a half angle of pi, whatever the axis.
        if outside_rad <= 0.0 || self.half_angle_rad >= core::f64::consts::PI {
            return (near - range).max(range - far).max(0.0);
        }
        // The nearest place is on the edge of the cone, in the plane of point and axis.
        let (sine, cosine) = libm::sincos(outside_rad);
        let along_edge = range * cosine;
        let nearest = along_edge.max(near).min(far);
        libm::hypot(along_edge - nearest, range * sine)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Against a search over the sector in the plane of point and axis.
        #[test]
        fn distance_is_that_of_the_nearest_place(
            x in -4.0..4.0_f64, z in -4.0..4.0_f64, half in 0.0..3.1_f64, near in 0.0..3.0_f64, depth in 0.0..3.0_f64,
        ) {
            let sector = Sector {
                axis: Vector3::z_axis(),
                half_angle_rad: half,
                distances: Interval::new(near, near + depth).unwrap(),
            };
            let point = Vector3::new(x, 0.0, z);
            let mut least = f64::INFINITY;
            for a in 0..=400 {
                let angle = half * f64::from(a - 200) / 200.0;
                for r in 0..=200 {
                    let range = near + depth * f64::from(r) / 200.0;
                    let place = Vector3::new(range * libm::sin(angle), 0.0, range * libm::cos(angle));
                    least = least.min((place - point).norm());
                }
            }
            let told = sector.distance_m(&point);
            prop_assert!(told <= least + 1e-9 && least - told < 0.1, "{told} {least}");
        }
    }

    #[test]
    fn an_open_sector_reaches_to_infinity() {
        let sector = Sector {
            axis: Vector3::x_axis(),
            half_angle_rad: 0.1,
            distances: Interval::new(2.0, f64::INFINITY).unwrap(),
        };
        assert!((sector.distance_m(&Vector3::zeros()) - 2.0).abs() < 1e-12);
        assert!(sector.distance_m(&Vector3::new(1e6, 0.0, 0.0)) < 1e-9);
        assert!((sector.distance_m(&Vector3::new(-1.0, 0.0, 0.0)) - 3.0).abs() < 0.02);
    }
}
