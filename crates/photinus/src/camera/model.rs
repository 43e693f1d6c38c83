//! The enum of models, and the dispatch that gives them one interface.

use nalgebra::{Matrix2x3, Matrix3x2, Vector2, Vector3};

use super::error::{CameraError, finite};
use super::field::Field;
use super::plane::Plane;
use super::{Ideal, KannalaBrandt, OCam, Pinhole, Pixel, radial};

/// How a camera maps directions to its image.
#[derive(Clone, Debug, PartialEq)]
pub enum Model {
    /// Scaramuzza's omnidirectional model (OCamCalib).
    OCam(OCam),
    /// A lens that follows a law, such as equidistant.
    Ideal(Ideal),
    /// The fisheye model of OpenCV, Kalibr and ROS.
    KannalaBrandt(KannalaBrandt),
    /// A pinhole with Brown-Conrady distortion.
    Pinhole(Pinhole),
}

impl Model {
    /// Where the optical axis meets the image.
    pub fn centre(&self) -> Pixel {
        self.plane().centre()
    }

    pub(super) fn plane(&self) -> &Plane {
        match self {
            Model::OCam(lens) => &lens.plane,
            Model::Ideal(lens) => &lens.plane,
            Model::KannalaBrandt(lens) => &lens.plane,
            Model::Pinhole(lens) => &lens.plane,
        }
    }

    /// The field of an image with these corners.
    pub(super) fn field(&self, corners: &[Pixel; 4], stated_rad: Option<f64>) -> Result<Field, CameraError> {
        let plane = self.plane();
        let corners = corners.map(|corner| plane.place(corner));
        let ring = corners.iter().map(Vector2::norm).fold(0.0, f64::max);
        finite("the distance from the centre to the farthest corner", &[ring * ring])?;
        match self {
            Model::OCam(lens) => {
                let height = lens.height_bound(ring);
                finite("the square of the direct polynomial in the image", &[height * height])?;
                Field::of_radial(lens, ring, stated_rad, plane.px_per_unit())
            }
            Model::Ideal(lens) => Field::of_radial(lens, ring, stated_rad, plane.px_per_unit()),
            Model::KannalaBrandt(lens) => Field::of_radial(lens, ring, stated_rad, plane.px_per_unit()),
            Model::Pinhole(lens) => lens.field(&corners, stated_rad),
        }
    }

    /// The unit vector at a place in the plane, and its derivative.
    #[inline(always)]
    pub(super) fn lift(&self, field: &Field, place: &Vector2<f64>) -> Option<(Vector3<f64>, Matrix3x2<f64>)> {
        match self {
            Model::OCam(lens) => radial::lift(lens, field, place),
            Model::Ideal(lens) => radial::lift(lens, field, place),
            Model::KannalaBrandt(lens) => radial::lift(lens, field, place),
            Model::Pinhole(lens) => lens.lift(field, place),
        }
    }

    /// The place in the plane of a unit vector, and its derivative, which is zero along the vector.
    #[inline(always)]
    pub(super) fn project(
        &self,
        field: &Field,
        bearing: &Vector3<f64>,
    ) -> Option<(Vector2<f64>, Matrix2x3<f64>)> {
        match self {
            Model::OCam(lens) => radial::project(lens, field, bearing),
            Model::Ideal(lens) => radial::project(lens, field, bearing),
            Model::KannalaBrandt(lens) => radial::project(lens, field, bearing),
            Model::Pinhole(lens) => lens.project(field, bearing),
        }
    }
}
