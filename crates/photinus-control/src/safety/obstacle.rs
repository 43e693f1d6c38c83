//! What a map shows: dark in the ultraviolet, and known to stand still.

use nalgebra::{UnitVector3, Vector3};

/// A body that stands still, in the level frame of now, grown by how unsure the vehicle is of its own place on the map. Walls of
/// a gate and the trunk of a tree are capsules; the ground, a wall or a fence is a face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Obstacle {
    /// All that is within a radius of a segment; a ball where both ends agree.
    Capsule {
        /// One end of the segment, m.
        from: Vector3<f64>,
        /// The other end, m.
        to: Vector3<f64>,
        /// The radius, m.
        radius_m: f64,
    },
    /// All that is behind a plane.
    Face {
        /// Out of the body, towards where one may fly.
        normal: UnitVector3<f64>,
        /// From the plane to the level frame's origin along the normal, m: positive where the vehicle is outside.
        height_m: f64,
    },
}

impl Obstacle {
    /// How far a point is from the body, m; not positive inside.
    pub fn distance_m(&self, point: &Vector3<f64>) -> f64 {
        match self {
            Self::Capsule { from, to, radius_m } => {
                let along = to - from;
                let length2 = along.norm_squared();
                let share =
                    if length2 > 0.0 { ((point - from).dot(&along) / length2).clamp(0.0, 1.0) } else { 0.0 };
                (point - (from + along * share)).norm() - radius_m
            }
            Self::Face { normal, height_m } => normal.dot(point) + height_m,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_are_from_the_surface() {
        let pole =
            Obstacle::Capsule { from: Vector3::zeros(), to: Vector3::new(0.0, 0.0, 4.0), radius_m: 0.5 };
        assert!((pole.distance_m(&Vector3::new(2.0, 0.0, 1.0)) - 1.5).abs() < 1e-12);
        assert!((pole.distance_m(&Vector3::new(0.0, 0.0, 6.0)) - 1.5).abs() < 1e-12);
        let ball = Obstacle::Capsule { from: Vector3::x(), to: Vector3::x(), radius_m: 0.25 };
        assert!((ball.distance_m(&Vector3::zeros()) - 0.75).abs() < 1e-12);
        let ground = Obstacle::Face { normal: Vector3::z_axis(), height_m: 3.0 };
        assert!((ground.distance_m(&Vector3::new(5.0, 1.0, -1.0)) - 2.0).abs() < 1e-12);
    }
}
