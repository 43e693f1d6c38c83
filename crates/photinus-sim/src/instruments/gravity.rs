//! Where down is, as an attitude filter tells it.

use nalgebra::{Isometry3, Unit, UnitQuaternion, Vector3};

use super::normals;
use crate::draw::Use;

/// How well the observer knows where down is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gravity {
    /// From frame to frame about each axis, sigma, rad.
    pub noise_rad: f64,
    /// All the time about each axis of the body, sigma, rad.
    pub bias_rad: f64,
}

const BIAS: u64 = 0;
/// Of camera 0; that of the others follows.
const NOISE: u64 = 1;

impl Gravity {
    /// What is told to a camera of the true direction in its frame. The bias is that of the vehicle, the same for all of its
    /// cameras; the noise is that of frame `number` of camera `camera`.
    pub fn measure(
        &self,
        down: &Unit<Vector3<f64>>,
        body_from_camera: &Isometry3<f64>,
        (camera, number): (u64, u64),
        seed: u64,
    ) -> Unit<Vector3<f64>> {
        let wrong = normals(seed, Use::Gravity, BIAS, 0) * self.bias_rad
            + normals(seed, Use::Gravity, NOISE + camera, number) * self.noise_rad;
        let in_body = body_from_camera.rotation * down;
        let told = UnitQuaternion::from_scaled_axis(wrong) * in_body;
        Unit::new_normalize((body_from_camera.rotation.inverse() * told).into_inner())
    }
}
