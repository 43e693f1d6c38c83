//! The plane of the view from above: enters a direction in the camera frame, leaves where it points on the plane.

use nalgebra::{Unit, Vector2, Vector3};
use photinus::camera::{Bearing, Camera};

/// Axes of the plane in the camera frame.
#[derive(Clone, Copy)]
pub(super) struct Ground {
    right: Vector3<f64>,
    forward: Vector3<f64>,
    /// Whether gravity set it; else it is the camera's own plane of x and z.
    pub(super) is_level: bool,
}

impl Ground {
    /// The level plane where gravity is known, else that of the camera's x and z. A camera that looks straight up or
    /// down has the upper edge of its image ahead.
    pub(super) fn new(gravity: Option<&Unit<Vector3<f64>>>) -> Self {
        let Some(down) = gravity else {
            return Self { right: Vector3::x(), forward: Vector3::z(), is_level: false };
        };
        let level = |axis: Vector3<f64>| Bearing::new(axis - down.as_ref() * down.dot(&axis));
        let looks_level = (1.0 - down.z.abs()) > 1e-3;
        let ahead = if looks_level { Vector3::z() } else { -Vector3::y() };
        let forward = level(ahead).map_or(Vector3::z(), |forward| *forward.vector());
        Self { right: down.cross(&forward), forward, is_level: true }
    }

    /// How far a vector goes right and forward.
    pub(super) fn of(&self, vector: &Vector3<f64>) -> Vector2<f64> {
        Vector2::new(self.right.dot(vector), self.forward.dot(vector))
    }

    /// Whether the camera sees along the plane, by azimuth in whole degrees from forward to the right, 0 to 359.
    pub(super) fn field(&self, camera: &Camera) -> Vec<bool> {
        let sees = |degree: u32| {
            let (sin, cos) = libm::sincos(f64::from(degree).to_radians());
            Bearing::new(self.right * sin + self.forward * cos)
                .is_some_and(|bearing| camera.pixel(&bearing).is_some())
        };
        (0..360).map(sees).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gravity_levels_a_camera_that_looks_up() {
        // 30 deg up: forward (z) has a part against gravity
        let down = Unit::new_normalize(Vector3::new(0.0, libm::cos(0.5), -libm::sin(0.5)));
        let ground = Ground::new(Some(&down));
        let above = ground.of(&Vector3::z());
        assert!((above.y - libm::cos(0.5)).abs() < 1e-12 && above.x.abs() < 1e-12);
        assert!((ground.of(&Vector3::x()).x - 1.0).abs() < 1e-12, "right stays right");
        assert!(ground.of(&down).norm() < 1e-12, "down is a point");
    }

    #[test]
    fn a_camera_that_looks_down_has_its_upper_edge_ahead() {
        let down = Unit::new_normalize(Vector3::z());
        let ground = Ground::new(Some(&down));
        assert!((ground.of(&-Vector3::y()) - Vector2::new(0.0, 1.0)).norm() < 1e-12);
        assert!((ground.of(&Vector3::x()) - Vector2::new(1.0, 0.0)).norm() < 1e-12);
    }
}
