//! Pixels <-> the lens's own plane: an offset and a matrix.

use nalgebra::{Matrix2, Vector2};

use super::Pixel;
use super::error::{CameraError, finite};
#[cfg(not(feature = "std"))]
use crate::float::Float as _;

/// The lens's plane, x along the columns and y along the rows from the optical centre, in units of the lens (px for
/// OCam, focal lengths for the others).
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Plane {
    centre: Vector2<f64>,
    pub(super) pixel_from_plane: Matrix2<f64>,
    pub(super) plane_from_pixel: Matrix2<f64>,
}

impl Plane {
    pub(super) fn new(centre: Pixel, pixel_from_plane: Matrix2<f64>) -> Result<Self, CameraError> {
        finite("the centre", &[centre.u, centre.v])?;
        finite("the affine matrix", pixel_from_plane.as_slice())?;
        let determinant = pixel_from_plane.determinant();
        let singular = CameraError::Singular { determinant };
        if determinant.abs() <= 1e-12 * pixel_from_plane.norm_squared() {
            return Err(singular);
        }
        let plane_from_pixel = pixel_from_plane.try_inverse().ok_or(singular)?;
        finite("the inverse of the affine matrix", plane_from_pixel.as_slice())?;
        Ok(Self { centre: Vector2::new(centre.u, centre.v), pixel_from_plane, plane_from_pixel })
    }

    /// A plane in focal lengths.
    pub(super) fn with_focal(centre: Pixel, focal_px: [f64; 2]) -> Result<Self, CameraError> {
        finite("the focal length", &focal_px)?;
        if let Some(&value_px) = focal_px.iter().find(|&&f| f <= 0.0) {
            return Err(CameraError::FocalLength { value_px });
        }
        Self::new(centre, Matrix2::new(focal_px[0], 0.0, 0.0, focal_px[1]))
    }

    pub(super) fn centre(&self) -> Pixel {
        Pixel::new(self.centre.x, self.centre.y)
    }

    pub(super) fn focal_px(&self) -> [f64; 2] {
        [self.pixel_from_plane.m11, self.pixel_from_plane.m22]
    }

    /// Pixels per unit of the plane, over all directions.
    pub(super) fn px_per_unit(&self) -> f64 {
        self.pixel_from_plane.determinant().abs().sqrt()
    }

    #[inline]
    pub(super) fn place(&self, pixel: Pixel) -> Vector2<f64> {
        self.plane_from_pixel * (Vector2::new(pixel.u, pixel.v) - self.centre)
    }

    #[inline]
    pub(super) fn pixel(&self, place: &Vector2<f64>) -> Pixel {
        let pixel = self.pixel_from_plane * place + self.centre;
        Pixel::new(pixel.x, pixel.y)
    }
}
