//! What stands between an LED and the camera: simple solids that belong to airframes, and parts that mirror (`mirror.rs`).

mod mirror;
mod own;

pub use mirror::{Image, Mirror, Surface};
pub use own::{Edge, OwnAirframe};

use nalgebra::Vector3;

/// A solid in the body frame of an airframe.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Solid {
    /// A ball.
    Sphere {
        /// Its centre, m.
        centre_m: Vector3<f64>,
        /// Its radius, m.
        radius_m: f64,
    },
    /// A cylinder about a line parallel to the body's z axis: a hub, a battery, a propeller's disc.
    Cylinder {
        /// Its centre, m.
        centre_m: Vector3<f64>,
        /// Its radius, m.
        radius_m: f64,
        /// Half its height, m.
        half_height_m: f64,
    },
}

impl Solid {
    /// Whether it cuts the straight line between two points of the body frame, m.
    pub fn cuts(&self, from_m: &Vector3<f64>, to_m: &Vector3<f64>) -> bool {
        let along = to_m - from_m;
        let (enters, leaves) = match self {
            Self::Sphere { centre_m, radius_m } => {
                let start = from_m - centre_m;
                within(along.norm_squared(), start.dot(&along), start.norm_squared() - radius_m * radius_m)
            }
            Self::Cylinder { centre_m, radius_m, half_height_m } => {
                let start = from_m - centre_m;
                let (flat, step) = (start.xy(), along.xy());
                let round =
                    within(step.norm_squared(), flat.dot(&step), flat.norm_squared() - radius_m * radius_m);
                let between = slab(start.z, along.z, *half_height_m);
                (round.0.max(between.0), round.1.min(between.1))
            }
        };
        enters.max(0.0) < leaves.min(1.0)
    }

    /// Radius of a ball about the body's origin that holds it, m.
    pub fn reach_m(&self) -> f64 {
        match self {
            Self::Sphere { centre_m, radius_m } => centre_m.norm() + radius_m,
            Self::Cylinder { centre_m, radius_m, half_height_m } => {
                centre_m.norm() + libm::hypot(*radius_m, *half_height_m)
            }
        }
    }
}

const NOWHERE: (f64, f64) = (f64::INFINITY, f64::NEG_INFINITY);
const EVERYWHERE: (f64, f64) = (f64::NEG_INFINITY, f64::INFINITY);

/// Where a t^2 + 2 b t + c is below 0.
fn within(a: f64, b: f64, c: f64) -> (f64, f64) {
    if a <= 0.0 {
        return if c < 0.0 { EVERYWHERE } else { NOWHERE };
    }
    let root = (b * b - a * c).sqrt();
    if root.is_nan() { NOWHERE } else { ((-b - root) / a, (-b + root) / a) }
}

/// Where |start + t step| is below `half`.
fn slab(start: f64, step: f64, half: f64) -> (f64, f64) {
    if step.abs() <= 0.0 {
        return if start.abs() < half { EVERYWHERE } else { NOWHERE };
    }
    let (a, b) = ((-half - start) / step, (half - start) / step);
    (a.min(b), a.max(b))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sensor::hash;

    /// Whether a point lies in a solid, said plainly.
    fn holds(solid: &Solid, point_m: &Vector3<f64>) -> bool {
        match solid {
            Solid::Sphere { centre_m, radius_m } => (point_m - centre_m).norm() < *radius_m,
            Solid::Cylinder { centre_m, radius_m, half_height_m } => {
                let from_centre = point_m - centre_m;
                libm::hypot(from_centre.x, from_centre.y) < *radius_m && from_centre.z.abs() < *half_height_m
            }
        }
    }

    #[test]
    fn cuts_agree_with_tracing_points_along_the_ray() {
        let solids = [
            Solid::Sphere { centre_m: Vector3::new(0.1, 0.0, 0.2), radius_m: 0.5 },
            Solid::Cylinder { centre_m: Vector3::new(0.0, -0.1, 0.0), radius_m: 0.6, half_height_m: 0.2 },
        ];
        let number = |key: u64| (hash(key) >> 11) as f64 / (1_u64 << 52) as f64 - 1.0;
        let (mut cut, mut grazing) = (0, 0);
        for ray in 0..2000 {
            let point = |end: u64| Vector3::from_fn(|axis, _| 1.5 * number(ray * 6 + end * 3 + axis as u64));
            let (from_m, to_m) = (point(0), point(1));
            for solid in &solids {
                let inside =
                    (0..=400).filter(|&i| holds(solid, &from_m.lerp(&to_m, f64::from(i) / 400.0))).count();
                cut += usize::from(inside > 0);
                match (inside > 0, solid.cuts(&from_m, &to_m)) {
                    (traced, cuts) if traced == cuts => {}
                    (false, true) => grazing += 1,
                    _ => panic!("{solid:?} {from_m} {to_m}"),
                }
            }
        }
        assert!((500..3500).contains(&cut) && grazing < 40, "{cut} {grazing}");
    }

    #[test]
    fn lines_along_the_axes_are_cut_where_they_should() {
        let hub = Solid::Cylinder { centre_m: Vector3::zeros(), radius_m: 0.2, half_height_m: 0.1 };
        let (above, below) = (Vector3::new(0.0, 0.0, 1.0), Vector3::new(0.0, 0.0, -1.0));
        assert!(hub.cuts(&above, &below));
        assert!(!hub.cuts(&above, &(above * 0.2)), "ends above it");
        assert!(!hub.cuts(&(above + Vector3::x()), &(below + Vector3::x())), "passes beside it");
        assert!((hub.reach_m() - libm::hypot(0.2, 0.1)).abs() < 1e-12);
    }
}
