//! Cameras that are mounted on one vehicle: what each sees is told in the axes of any other.

use alloc::vec;
use alloc::vec::Vec;

use nalgebra::{Matrix3, Rotation3, Vector3};

use super::{Camera, Watched};
use crate::frame::{FrameError, Mask};

/// How a camera sits on its vehicle. By default the body's axes and origin are the camera's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mounting {
    /// Maps the camera's coordinates to the body's axes.
    pub body_from_camera: Rotation3<f64>,
    /// Covariance of that rotation as a small turn about the body's axes, rad^2.
    pub rotation_covariance_rad2: Matrix3<f64>,
    /// The camera's centre in the body frame, m.
    pub position_m: Vector3<f64>,
    /// Covariance of that position, m^2.
    pub position_covariance_m2: Matrix3<f64>,
}

impl Default for Mounting {
    fn default() -> Self {
        Self {
            body_from_camera: Rotation3::identity(),
            rotation_covariance_rad2: Matrix3::zeros(),
            position_m: Vector3::zeros(),
            position_covariance_m2: Matrix3::zeros(),
        }
    }
}

impl Mounting {
    /// From the body's origin to the camera, in the camera's axes, m.
    pub(crate) fn lever_m(&self) -> Vector3<f64> {
        self.body_from_camera.inverse() * self.position_m
    }
}

/// A camera of a [`Rig`].
#[derive(Clone, Debug)]
pub struct Mounted {
    /// The camera.
    pub camera: Camera,
    /// Where nobody looks in its image.
    pub mask: Option<Mask>,
    /// How it sits on the vehicle.
    pub mounting: Mounting,
}

impl From<Camera> for Mounted {
    fn from(camera: Camera) -> Self {
        Self { camera, mask: None, mounting: Mounting::default() }
    }
}

/// The cameras that look from one vehicle, numbered from 0. They need not be synchronised, nor see the same.
#[derive(Clone, Debug)]
pub struct Rig {
    cameras: Vec<Mounted>,
}

/// Why cameras are no rig.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RigError {
    /// None, or too many.
    #[error("{0} cameras on one vehicle: it can have 1 to {most}", most = Rig::MOST)]
    Count(usize),
    /// A mask of another size than its camera's image.
    #[error("{0}")]
    Mask(#[from] FrameError),
    /// A mounting that is no number, or whose covariance is none.
    #[error(
        "camera {0} of the rig: its mounting must be finite, and its covariances without negative variances"
    )]
    Mounting(usize),
}

impl From<Camera> for Rig {
    /// One alone: the body's axes are its own.
    fn from(camera: Camera) -> Self {
        Self { cameras: vec![Mounted::from(camera)] }
    }
}

impl Rig {
    /// Most cameras on one vehicle.
    pub const MOST: usize = 8;

    /// These cameras.
    ///
    /// # Errors
    /// [`RigError`] for none, for more than [`Self::MOST`], for masks of another size and for mountings without meaning.
    pub fn new(cameras: Vec<Mounted>) -> Result<Self, RigError> {
        if !(1..=Self::MOST).contains(&cameras.len()) {
            return Err(RigError::Count(cameras.len()));
        }
        for (number, Mounted { camera, mask, mounting }) in cameras.iter().enumerate() {
            if let Some(mask) = mask {
                mask.check_size(camera.width(), camera.height())?;
            }
            let is_covariance = |of: &Matrix3<f64>| {
                of.iter().all(|part| part.is_finite())
                    && of.diagonal().iter().all(|&variance| variance >= 0.0)
            };
            let is_finite = mounting.body_from_camera.matrix().iter().all(|part| part.is_finite())
                && mounting.position_m.iter().all(|part| part.is_finite());
            if !is_finite
                || !is_covariance(&mounting.rotation_covariance_rad2)
                || !is_covariance(&mounting.position_covariance_m2)
            {
                return Err(RigError::Mounting(number));
            }
        }
        Ok(Self { cameras })
    }

    /// The cameras, by number.
    pub fn cameras(&self) -> &[Mounted] {
        &self.cameras
    }

    /// Sets where nobody looks in a camera's image.
    ///
    /// # Errors
    /// [`FrameError::MaskSize`] when the mask is not of the camera's size.
    ///
    /// # Panics
    /// If there is no camera of this number.
    pub(crate) fn set_mask(&mut self, camera: usize, mask: Option<Mask>) -> Result<(), FrameError> {
        let mounted = &mut self.cameras[camera];
        if let Some(mask) = &mask {
            mask.check_size(mounted.camera.width(), mounted.camera.height())?;
        }
        mounted.mask = mask;
        Ok(())
    }

    /// Where a camera looks.
    pub(crate) fn watched(&self, camera: usize) -> Watched<'_> {
        let Mounted { camera, mask, .. } = &self.cameras[camera];
        Watched::new(camera, mask.as_ref())
    }

    pub(crate) fn mounting(&self, camera: usize) -> &Mounting {
        &self.cameras[camera].mounting
    }
}
