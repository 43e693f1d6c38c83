//! Four and more bearings and the body points they belong to -> the best pose.

use nalgebra::{Isometry3, Vector3};

/// The pose.
pub fn pnp(_bearings: &[Vector3<f64>], _points_m: &[Vector3<f64>]) -> Option<Isometry3<f64>> {
    None
}
