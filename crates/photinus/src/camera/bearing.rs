//! The two ends of a camera model: a place in the image and a direction in space.

use nalgebra::{Unit, Vector3};

/// A place in the image: `u` is the column, `v` the row, 0-based, the centre of a pixel at the integer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pixel {
    /// Column, growing to the right, px.
    pub u: f64,
    /// Row, growing downwards, px.
    pub v: f64,
}

impl Pixel {
    /// A place in column `u`, row `v`.
    pub fn new(u: f64, v: f64) -> Self {
        Self { u, v }
    }
}

/// A direction in the camera frame (x right, y down, z forward): a unit vector. Bearings past 90 deg from the
/// optical axis (z < 0) are ordinary.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bearing(Unit<Vector3<f64>>);

impl Bearing {
    /// The direction of `vector`; `None` when it has no direction (zero or not finite).
    pub fn new(vector: Vector3<f64>) -> Option<Self> {
        let norm = vector.norm();
        (norm.is_finite() && norm > 0.0).then(|| Self(Unit::new_unchecked(vector / norm)))
    }

    /// A vector that has unit length by construction.
    #[inline]
    pub(super) fn from_unit(vector: Vector3<f64>) -> Self {
        Self(Unit::new_unchecked(vector))
    }

    /// The unit vector.
    pub fn vector(&self) -> &Vector3<f64> {
        &self.0
    }

    /// Angle to another bearing, rad, accurate from 0 to pi.
    pub fn angle_to(&self, other: &Bearing) -> f64 {
        libm::atan2(self.0.cross(&other.0).norm(), self.0.dot(&other.0))
    }

    /// Angle to the optical axis (+z), rad.
    pub fn off_axis_rad(&self) -> f64 {
        libm::atan2(libm::hypot(self.0.x, self.0.y), self.0.z)
    }
}
