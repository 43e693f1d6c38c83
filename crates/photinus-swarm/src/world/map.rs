//! What stands in the world besides vehicles: dark in ultraviolet light, hard to the touch, known to whoever has the map.

use nalgebra::Vector3;

/// An obstacle: all that is within a radius of a segment. A trunk, a mast, a bar of a gate; a ball where both ends agree.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Obstacle {
    /// One end of the segment, m.
    pub from_m: Vector3<f64>,
    /// The other end, m.
    pub to_m: Vector3<f64>,
    /// The radius, m.
    pub radius_m: f64,
}

impl Obstacle {
    /// How far a place is from its surface, m; below 0 inside.
    pub fn distance_m(&self, place_m: &Vector3<f64>) -> f64 {
        let along_m = self.to_m - self.from_m;
        let share = share(&(place_m - self.from_m), &along_m);
        (place_m - self.from_m - along_m * share).norm() - self.radius_m
    }

    /// Whether it hides one place from another: whether the way between them comes nearer to the segment than the radius.
    pub fn hides(&self, a_m: &Vector3<f64>, b_m: &Vector3<f64>) -> bool {
        between_segments_m((self.from_m, self.to_m), (*a_m, *b_m)) < self.radius_m
    }
}

/// The share of `along` at which the foot of `off` stands, 0 to 1.
fn share(off: &Vector3<f64>, along: &Vector3<f64>) -> f64 {
    let square = along.norm_squared();
    if square > 0.0 { (off.dot(along) / square).clamp(0.0, 1.0) } else { 0.0 }
}

/// The smallest distance of two segments, m. Where the nearest points of the lines lie on both segments they are it; else an end of one of them is.
fn between_segments_m((a, b): (Vector3<f64>, Vector3<f64>), (c, d): (Vector3<f64>, Vector3<f64>)) -> f64 {
    let (u, v, w) = (b - a, d - c, a - c);
    let (uu, uv, vv, uw, vw) = (u.dot(&u), u.dot(&v), v.dot(&v), u.dot(&w), v.dot(&w));
    let determinant = uu * vv - uv * uv;
    if determinant > 1e-12 * uu * vv {
        let (s, t) = ((uv * vw - vv * uw) / determinant, (uu * vw - uv * uw) / determinant);
        if (0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&t) {
            return (w + u * s - v * t).norm();
        }
    }
    let to = |point: Vector3<f64>, from: Vector3<f64>, along: Vector3<f64>| {
        (point - from - along * share(&(point - from), &along)).norm()
    };
    to(a, c, v).min(to(b, c, v)).min(to(c, a, u)).min(to(d, a, u))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chance::{Chance, Use};

    /// By walking along the way and along the obstacle in small steps.
    #[test]
    fn hiding_and_distance_are_those_of_trying_many_points() {
        let mut chance = Chance::new(3, Use::Places, 0);
        let (mut hidden, mut free) = (0, 0);
        for number in 0..600 {
            let from_m = chance.normals();
            let to_m = if number % 5 == 0 { from_m } else { from_m + chance.normals() * 1.5 };
            let obstacle = Obstacle { from_m, to_m, radius_m: 0.2 + 0.6 * chance.uniform() };
            let [a, b] = [chance.normals() * 1.8, chance.normals() * 1.8];
            let shares = || (0..=200).map(|step| f64::from(step) / 200.0);
            let to_axis = |place: Vector3<f64>| {
                shares()
                    .map(|share| (place - from_m - (to_m - from_m) * share).norm())
                    .fold(f64::INFINITY, f64::min)
            };
            let walked = shares().map(|share| to_axis(a + (b - a) * share)).fold(f64::INFINITY, f64::min);
            // steps are up to 4 cm
            if (walked - obstacle.radius_m).abs() > 0.04 {
                assert_eq!(walked < obstacle.radius_m, obstacle.hides(&a, &b), "{obstacle:?} {a} {b}");
                if walked < obstacle.radius_m { hidden += 1 } else { free += 1 }
            }
            assert!((obstacle.distance_m(&a) - (to_axis(a) - obstacle.radius_m)).abs() < 0.02);
        }
        assert!(hidden > 40 && free > 400, "{hidden} {free}");
    }
}
