//! Pixel <-> bearing, and how sure a direction is.
//!
//! A place in the image enters, a unit vector in the camera frame leaves, and the other way round, each with its
//! Jacobian. Directions past 90 deg are ordinary. Outside the image and outside the field that the model is
//! good for there is no answer: [`Camera`] never extrapolates.
//!
//! A [`Model`] holds checked parameters; a [`Camera`] is a model with an image and a field. The lenses that are symmetric
//! about their axis ([`OCam`], [`Ideal`], [`KannalaBrandt`]) share one geometry (`radial.rs`) and differ in one curve.
//! A camera may carry the covariance of its calibration (`calibration.rs`) and tells what it means for a bearing. Cameras that are mounted on one vehicle
//! are a [`Rig`].

mod bearing;
mod calibration;
mod error;
mod field;
mod ideal;
mod inverse;
mod kannala_brandt;
mod model;
mod ocam;
mod pinhole;
mod plane;
mod polynomial;
mod radial;
mod rig;
#[cfg(test)]
mod tests;
mod watched;

use alloc::sync::Arc;

use nalgebra::{Matrix2, Matrix2x3, Matrix3, Matrix3x2};

pub use bearing::{Bearing, Pixel};
pub use error::CameraError;
pub use ideal::{Ideal, IdealLaw};
pub use kannala_brandt::KannalaBrandt;
pub use model::Model;
pub use ocam::OCam;
pub use pinhole::Pinhole;
pub use rig::{Mounted, Mounting, Rig, RigError};
pub use watched::Watched;

#[cfg(not(feature = "std"))]
use crate::float::Float as _;
use crate::frame::FrameView;
use crate::optics::Optics;
use calibration::Calibration;
use field::Field;

/// A calibrated camera: a model, the size of its image, and the field in which it answers.
///
/// ```
/// use photinus::camera::{Bearing, Camera, Ideal, IdealLaw, Model, Pixel};
///
/// // the linear law of the paper, phi = k r, with k = 3.767e-3 rad/px
/// let lens = Ideal::new(IdealLaw::Equidistant, [1.0 / 3.767e-3; 2], Pixel::new(375.5, 239.5))?;
/// let camera = Camera::new(Model::Ideal(lens), 752, 480, None)?;
/// let bearing = camera.bearing(Pixel::new(375.5 + 100.0, 239.5)).expect("inside the image");
/// assert!((bearing.off_axis_rad() - 0.3767).abs() < 1e-12);
/// assert!(bearing.vector().x > 0.0); // right of the axis is right in the camera frame
/// # Ok::<(), photinus::camera::CameraError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    model: Model,
    width_px: usize,
    height_px: usize,
    stated_limit_rad: Option<f64>,
    field: Field,
    calibration: Option<Calibration>,
    optics: Option<Arc<Optics>>,
}

impl Camera {
    /// A camera with an image of `width_px` columns and `height_px` rows.
    ///
    /// The field ends at `field_limit_rad` off the axis, at the latest at the ring through the image's farthest corner
    /// (which is where it ends when no limit is given), and never past what the model can see (180 deg; 90 deg for
    /// an orthographic lens, 89.9 deg for a pinhole).
    ///
    /// # Errors
    /// [`CameraError::NotMonotonic`] when the model folds back within that field, [`CameraError::Size`] and
    /// [`CameraError::FieldLimit`] when the size or the limit has no meaning, [`CameraError::NotFinite`] when the image lies infinitely far
    /// from the centre.
    pub fn new(
        model: Model,
        width_px: usize,
        height_px: usize,
        field_limit_rad: Option<f64>,
    ) -> Result<Self, CameraError> {
        if ![width_px, height_px].iter().all(|side| (1..=FrameView::MAX_SIDE_PX).contains(side)) {
            return Err(CameraError::Size { width_px, height_px });
        }
        if let Some(value_rad) =
            field_limit_rad.filter(|limit| !(*limit > 0.0 && *limit <= core::f64::consts::PI))
        {
            return Err(CameraError::FieldLimit { value_rad });
        }
        let (right, bottom) = (width_px as f64 - 0.5, height_px as f64 - 0.5);
        let corners =
            [(-0.5, -0.5), (right, -0.5), (-0.5, bottom), (right, bottom)].map(|(u, v)| Pixel::new(u, v));
        let field = model.field(&corners, field_limit_rad)?;
        Ok(Self {
            model,
            width_px,
            height_px,
            stated_limit_rad: field_limit_rad,
            field,
            calibration: None,
            optics: None,
        })
    }

    /// The direction seen at a place; `None` outside the image or the field.
    #[inline]
    pub fn bearing(&self, pixel: Pixel) -> Option<Bearing> {
        if !self.holds(pixel) {
            return None;
        }
        let place = self.model.plane().place(pixel);
        self.model.lift(&self.field, &place).map(|(vector, _)| Bearing::from_unit(vector))
    }

    /// The place where a direction is seen; `None` where it is not, outside the field or the image.
    #[inline]
    pub fn pixel(&self, bearing: &Bearing) -> Option<Pixel> {
        let (place, _) = self.model.project(&self.field, bearing.vector())?;
        Some(self.model.plane().pixel(&place)).filter(|pixel| self.holds(*pixel))
    }

    /// [`Camera::bearing`] with its derivative by (u, v), 1/px; its columns are tangent to the sphere.
    #[inline]
    pub fn bearing_with_jacobian(&self, pixel: Pixel) -> Option<(Bearing, Matrix3x2<f64>)> {
        if !self.holds(pixel) {
            return None;
        }
        let plane = self.model.plane();
        let (vector, jacobian) = self.model.lift(&self.field, &plane.place(pixel))?;
        Some((Bearing::from_unit(vector), jacobian * plane.plane_from_pixel))
    }

    /// [`Camera::pixel`] with the derivative of (u, v) by the unit vector, px.
    ///
    /// The derivative is that of (u, v) as a function of direction alone: it is zero along the bearing. For a vector of
    /// length l divide it by l.
    #[inline]
    pub fn pixel_with_jacobian(&self, bearing: &Bearing) -> Option<(Pixel, Matrix2x3<f64>)> {
        let plane = self.model.plane();
        let (place, jacobian) = self.model.project(&self.field, bearing.vector())?;
        let pixel = plane.pixel(&place);
        self.holds(pixel).then(|| (pixel, plane.pixel_from_plane * jacobian))
    }

    /// How far the direction turns per pixel at a place, along the image direction in which it turns most, rad/px.
    pub fn rad_per_px(&self, pixel: Pixel) -> Option<f64> {
        self.bearing_with_jacobian(pixel).map(|(_, jacobian)| largest_rad_per_px(&jacobian))
    }

    /// The covariance of the bearing seen at a place whose own covariance is `covariance_px2`, rad^2.
    ///
    /// It lies in the tangent plane: its third axis, along the bearing, is zero.
    pub fn tangent_covariance(&self, pixel: Pixel, covariance_px2: &Matrix2<f64>) -> Option<Matrix3<f64>> {
        let (_, jacobian) = self.bearing_with_jacobian(pixel)?;
        Some(jacobian * covariance_px2 * jacobian.transpose())
    }

    /// Largest angle off the axis at which the camera answers, rad.
    pub fn field_limit_rad(&self) -> f64 {
        self.field.limit_rad
    }

    /// The field limit that the camera was made with, if any, rad: it can lie past what the image shows.
    pub fn stated_limit_rad(&self) -> Option<f64> {
        self.stated_limit_rad
    }

    /// Columns of the image.
    pub fn width(&self) -> usize {
        self.width_px
    }

    /// Rows of the image.
    pub fn height(&self) -> usize {
        self.height_px
    }

    /// The same camera with the optics that were measured of it.
    #[must_use]
    pub fn with_optics(self, optics: Optics) -> Self {
        Self { optics: Some(Arc::new(optics)), ..self }
    }

    /// What was measured of its lens and sensor, if anything.
    pub fn optics(&self) -> Option<&Arc<Optics>> {
        self.optics.as_ref()
    }

    /// The model.
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// Whether a place lies in the image: half a pixel around the centres of the outermost pixels belongs to it.
    #[inline]
    fn holds(&self, pixel: Pixel) -> bool {
        pixel.u >= -0.5
            && pixel.v >= -0.5
            && pixel.u < self.width_px as f64 - 0.5
            && pixel.v < self.height_px as f64 - 0.5
    }
}

/// The largest singular value of a bearing's Jacobian: how far a direction turns per pixel, where it turns most.
pub(crate) fn largest_rad_per_px(jacobian: &Matrix3x2<f64>) -> f64 {
    let squares = jacobian.transpose() * jacobian;
    let half_difference = libm::hypot(0.5 * (squares.m11 - squares.m22), squares.m12);
    (0.5 * squares.trace() + half_difference).sqrt()
}
