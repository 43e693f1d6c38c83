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
        self.edged().distance_m(point)
    }

    /// The same sector, for the distances of many points.
    pub(super) fn edged(&self) -> Edged<'_> {
        Edged { sector: self, sine_cosine: libm::sincos(self.half_angle_rad) }
    }
}

/// A sector with the direction of its edge.
#[derive(Clone, Copy, Debug)]
pub(super) struct Edged<'a> {
    sector: &'a Sector,
    sine_cosine: (f64, f64),
}

impl Edged<'_> {
    /// As [`Sector::distance_m`].
    pub(super) fn distance_m(&self, point: &Vector3<f64>) -> f64 {
        let Sector { axis, half_angle_rad, distances } = self.sector;
        let (near, far) = (distances.min_m(), distances.max_m());
        let (sine, cosine) = self.sine_cosine;
        // In the plane of point and axis, turned so that the edge of the cone is the first of its axes.
        let (along, across) = (point.dot(axis), point.cross(axis).norm());
        let (along_edge, outside) = (along * cosine + across * sine, across * cosine - along * sine);
        let is_opposite = outside == 0.0 && sine == 0.0 && along < 0.0;
        // Every direction is in a half angle of pi, whatever the axis.
        if outside <= 0.0 && !is_opposite || *half_angle_rad >= core::f64::consts::PI {
            let range = point.norm();
            return (near - range).max(range - far).max(0.0);
        }
        // The nearest place is on the edge.
        let beyond = along_edge - along_edge.max(near).min(far);
        libm::sqrt(beyond * beyond + outside * outside)
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
    fn a_ray_is_far_from_what_is_behind_it_and_what_is_no_number_is_nowhere() {
        let distances = Interval::new(2.0, 5.0).unwrap();
        let ray = Sector { axis: Vector3::x_axis(), half_angle_rad: 0.0, distances };
        for (x, y, distance_m) in
            [(-1.0, 0.0, 3.0), (1.0, 0.0, 1.0), (3.0, 0.0, 0.0), (3.0, 2.0, 2.0), (7.0, 0.0, 2.0)]
        {
            assert!((ray.distance_m(&Vector3::new(x, y, 0.0)) - distance_m).abs() < 1e-12, "{x} {y}");
        }
        assert!(ray.distance_m(&Vector3::new(f64::NAN, 0.0, 0.0)).is_nan());
        let anywhere = Sector { half_angle_rad: f64::NAN, ..ray };
        assert!(anywhere.distance_m(&Vector3::zeros()).is_nan());
        let all = Sector { half_angle_rad: core::f64::consts::PI, ..ray };
        assert!((all.distance_m(&Vector3::new(-1.0, 0.0, 0.0)) - 1.0).abs() < 1e-12);
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
