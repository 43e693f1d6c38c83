//! Bodies in the way -> the directions in which somebody may be hidden, and from what distance on.
//!
//! Nobody stands nearer behind a body than both can: a hidden vehicle keeps its distance from the one that hides it, as all do who keep the contract.

use core::cmp::Ordering;

use nalgebra::{UnitVector3, Vector3};

use super::angle::compare;
use super::{Cone, Limits, Obstacle};
use crate::Seen;

/// All directions within an angle of an arc of a great circle, in the level frame: there, nothing is watched from a distance on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shadow {
    /// Both ends of the arc; it is shorter than half a circle.
    arc: [UnitVector3<f64>; 2],
    half_angle_rad: f64,
    starts_m: f64,
}

/// What hides everything, such as the own airframe.
impl From<Cone> for Shadow {
    fn from(cone: Cone) -> Self {
        Self { arc: [cone.axis; 2], half_angle_rad: cone.half_angle_rad, starts_m: 0.0 }
    }
}

impl Shadow {
    /// What is behind a neighbour, wherever in its bounds it is: somebody whose line of sight passes its origin within `hides_m`, m (the radius of what is
    /// opaque in the middle of an airframe, and how far cameras are from the origin).
    pub fn of_neighbour(seen: &Seen, hides_m: f64, limits: &Limits) -> Self {
        let moved_m = 2.0 * limits.speed_m_s * seen.age_s.max(0.0);
        let near_m = seen.distance.bounds.min_m() - moved_m;
        let spans_rad = spans_rad(hides_m + moved_m, near_m);
        Self {
            arc: [seen.bearing; 2],
            half_angle_rad: seen.bearing_bound_rad + spans_rad,
            starts_m: beyond_m(hides_m, near_m, limits.separation_m()),
        }
    }

    /// What is behind a body of the map, or passes it within `hides_m`; `None` behind a face: nobody is there.
    pub fn of_obstacle(obstacle: &Obstacle, hides_m: f64, limits: &Limits) -> Option<Self> {
        let Obstacle::Capsule { from, to, radius_m } = obstacle else { return None };
        let near_m = obstacle.distance_m(&Vector3::zeros()) + radius_m;
        let ends = [from, to].map(|end| UnitVector3::try_new(*end, 1e-9).unwrap_or(Vector3::z_axis()));
        Some(Self {
            arc: ends,
            half_angle_rad: spans_rad(radius_m + hides_m, near_m),
            starts_m: beyond_m(radius_m + hides_m, near_m, radius_m + limits.radius_m),
        })
    }

    /// From what distance on nothing is watched in these directions, m.
    pub fn starts_m(&self) -> f64 {
        self.starts_m
    }

    /// Whether any direction of a cone is within the shadow.
    pub fn touches(&self, cone: &Cone) -> bool {
        let direction = &cone.axis;
        let reach_rad = self.half_angle_rad + cone.half_angle_rad;
        let [a, b] = self.arc;
        let normal = a.cross(&b);
        let is_abreast = normal.cross(&a).dot(direction) > 0.0 && b.cross(&normal).dot(direction) > 0.0;
        let off = if is_abreast {
            // no division: the arc has a length where a direction is abreast of it
            libm::asin((normal.dot(direction).abs() / normal.norm()).min(1.0)).partial_cmp(&reach_rad)
        } else {
            let nearer = if a.dot(direction) >= b.dot(direction) { a } else { b };
            compare(&nearer, direction, reach_rad)
        };
        // What is no number hides.
        off.is_none_or(Ordering::is_lt)
    }
}

/// Half the angle that a ball spans whose centre is at `near_m` or farther, rad; all directions from inside of it.
fn spans_rad(radius_m: f64, near_m: f64) -> f64 {
    if radius_m < near_m { libm::asin(radius_m / near_m) } else { core::f64::consts::PI }
}

/// How near somebody can be, at the least, whose line of sight passes a centre within `radius_m` that is at `near_m` or farther, and who keeps `apart_m`
/// from that centre: the sum of two legs.
fn beyond_m(radius_m: f64, near_m: f64, apart_m: f64) -> f64 {
    let leg = |long: f64| libm::sqrt((long * long - radius_m * radius_m).max(0.0));
    if near_m > radius_m { leg(near_m) + leg(apart_m) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn place(size: f64) -> impl Strategy<Value = Vector3<f64>> {
        [-size..size, -size..size, -size..size].prop_map(Vector3::from)
    }

    /// The smallest distance of a way from the origin to a place and a segment, by trying points.
    fn nearest_m(place: &Vector3<f64>, from: &Vector3<f64>, to: &Vector3<f64>) -> f64 {
        let steps = || (0..=150).map(|step| f64::from(step) / 150.0);
        let body = Obstacle::Capsule { from: *from, to: *to, radius_m: 0.0 };
        steps().map(|share| body.distance_m(&(place * share))).fold(f64::INFINITY, f64::min)
    }

    proptest! {
        /// Whoever is hidden by a body and keeps clear of it is in its shadow, and no nearer than where that starts.
        #[test]
        fn whoever_is_hidden_is_in_the_shadow(
            from in place(4.0), to in place(4.0), share in 0.0..1.0_f64, off in place(0.3), behind in 1.0..3.0_f64, radius_m in 0.1..0.5_f64,
        ) {
            let limits = Limits::small_multirotor();
            let body = Obstacle::Capsule { from, to, radius_m };
            let hidden = (from + (to - from) * share + off) * behind;
            prop_assume!(body.distance_m(&hidden) >= limits.radius_m);
            prop_assume!(nearest_m(&hidden, &from, &to) < radius_m);
            let shadow = Shadow::of_obstacle(&body, 0.0, &limits).unwrap();
            let cone = Cone { axis: UnitVector3::new_normalize(hidden), half_angle_rad: 0.0 };
            prop_assert!(shadow.touches(&cone), "{shadow:?} {hidden}");
            prop_assert!(hidden.norm() >= shadow.starts_m() - 1e-9, "{shadow:?} {hidden}");
        }

        /// A shadow is no wider than a ball at the nearest point of the body: what is well beside it is not in it.
        #[test]
        fn what_is_beside_a_body_is_not_in_its_shadow(direction in place(1.0), half in 0.05..0.6_f64) {
            prop_assume!(direction.norm() > 0.1);
            let body = Obstacle::Capsule { from: Vector3::new(3.0, 0.0, -5.0), to: Vector3::new(3.0, 0.0, 5.0), radius_m: 3.0 * libm::sin(half) };
            let shadow = Shadow::of_obstacle(&body, 0.0, &Limits::small_multirotor()).unwrap();
            let axis = UnitVector3::new_normalize(direction);
            // the arc lies in the plane of x and z, to 59 degrees up and down
            let steep = libm::atan2(axis.z.abs(), axis.x);
            let off = if steep < libm::atan2(5.0, 3.0) { libm::asin(axis.y.abs()) } else { f64::INFINITY };
            let is_within = shadow.touches(&Cone { axis, half_angle_rad: 0.0 });
            if off < half - 1e-9 { prop_assert!(is_within) }
            if off.is_finite() && off > half + 1e-9 { prop_assert!(!is_within) }
            if axis.x < -0.9 { prop_assert!(!is_within) }
        }
    }

    #[test]
    fn behind_a_neighbour_somebody_is_as_far_as_both_keep_apart() {
        let limits = Limits::small_multirotor();
        // on the line from the origin through a neighbour at 4 m, 0.8 m behind it
        assert!((beyond_m(0.0, 4.0, limits.separation_m()) - 4.8).abs() < 1e-12);
        // inside of what hides, anybody may be anywhere
        assert!(beyond_m(0.3, 0.2, 0.8).abs() < 1e-12 && spans_rad(0.3, 0.2) > 3.1);
    }
}
