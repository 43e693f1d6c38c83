//! A lens whose parameters are being found: a direction enters, a pixel leaves, with the derivatives by both.
//!
//! ```text
//! (x, y, z) -> radius r(angle off the axis) -> q = r (x, y) / |(x, y)| -> u = q_x + centre_u,  v = c q_y + d q_x + centre_v
//! ```
//!
//! The affine part has c and d only: OCamCalib's third number, e, turns the image together with every pose and changes
//! no prediction, so it is fixed at 0. Directions past 90 deg are ordinary; there is no normalised plane.

mod curve;
mod model;

use nalgebra::{Matrix2x3, SMatrix, SVector, Vector2, Vector3};

pub use model::{LensModel, UnknownModel};

/// Most parameters that a lens has: the affine four and ten of the curve.
pub(crate) const MOST_PARAMETERS: usize = 4 + MOST_RADIAL;
pub(crate) const MOST_RADIAL: usize = 10;

/// Column of u of the centre, px; v follows.
pub(crate) const CENTRE: usize = 0;
/// Column of c of the affine part; d follows.
pub(crate) const AFFINE: usize = 2;
/// Column of the first number of the curve.
pub(crate) const RADIAL: usize = 4;

/// Derivatives of a pixel by the parameters, zero past those that the lens has.
pub(crate) type ByParameters = SMatrix<f64, 2, MOST_PARAMETERS>;

/// The numbers of a lens, zero past those that it has.
pub(crate) type Parameters = SVector<f64, MOST_PARAMETERS>;

/// A lens of some model: `[centre u, centre v, c, d, curve ...]`.
///
/// The curve of Kannala-Brandt is `[f, k1, k2, ...]` with r = f S (t + k1 t^3 + k2 t^5 + ...), that of OCam
/// `[b0, b2, b3, ...]` with -z = S (b0 + b2 (r/S)^2 + ...); S is a length near the focal one that keeps numbers near 1.
#[derive(Clone, Debug, PartialEq)]
pub struct Lens {
    model: LensModel,
    scale_px: f64,
    parameters: Parameters,
}

/// Where a direction is seen, and the derivatives of the pixel (u, v).
pub(crate) struct Projection {
    pub(crate) pixel: Vector2<f64>,
    pub(crate) by_point: Matrix2x3<f64>,
    pub(crate) by_parameters: ByParameters,
}

impl Lens {
    /// An equidistant lens r = `focal_px` x angle about `centre_px` with square pixels.
    pub(crate) fn equidistant(scale_px: f64, focal_px: f64, centre_px: [f64; 2]) -> Self {
        let mut parameters = Parameters::zeros();
        parameters[CENTRE] = centre_px[0];
        parameters[CENTRE + 1] = centre_px[1];
        parameters[AFFINE] = 1.0;
        parameters[RADIAL] = focal_px / scale_px;
        Self { model: LensModel::EQUIDISTANT, scale_px, parameters }
    }

    /// The nearest lens of another model, compared out to `reach_rad` off the axis.
    pub(crate) fn in_model(&self, model: LensModel, reach_rad: f64) -> Self {
        let mut parameters = self.parameters;
        let radial = curve::fitted(model, &self.curve(), reach_rad);
        parameters.as_mut_slice()[RADIAL..].copy_from_slice(&radial);
        Self { model, scale_px: self.scale_px, parameters }
    }

    /// The same lens with other numbers.
    pub(crate) fn with_parameters(&self, parameters: Parameters) -> Self {
        Self { model: self.model, scale_px: self.scale_px, parameters }
    }

    /// The model.
    pub fn model(&self) -> LensModel {
        self.model
    }

    /// `[centre u, centre v, c, d, curve ...]`: the centre in px, the rest without unit.
    pub fn parameters(&self) -> &[f64] {
        &self.parameters.as_slice()[..self.model.parameters()]
    }

    pub(crate) fn all_parameters(&self) -> &Parameters {
        &self.parameters
    }

    /// The length by which the curve's numbers are scaled, px.
    pub fn scale_px(&self) -> f64 {
        self.scale_px
    }

    /// Where the axis meets the image, (u, v) in px.
    pub fn centre_px(&self) -> Vector2<f64> {
        Vector2::new(self.parameters[CENTRE], self.parameters[CENTRE + 1])
    }

    /// Radius at an angle off the axis, px; `None` where the curve has none.
    pub fn radius_px(&self, angle_rad: f64) -> Option<f64> {
        let (sin, cos) = libm::sincos(angle_rad);
        self.curve().at(sin, cos).map(|at| at.radius * self.scale_px)
    }

    /// Angle off the axis of the direction seen at a pixel, rad, found on a curve that rises up to `limit_rad`; `None`
    /// past it.
    pub fn angle_rad(&self, pixel: &Vector2<f64>, limit_rad: f64) -> Option<f64> {
        let radius_px = self.in_plane(pixel).norm();
        let (mut low, mut high) = (0.0, limit_rad);
        if self.radius_px(high)? < radius_px {
            return None;
        }
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if self.radius_px(middle)? < radius_px { low = middle } else { high = middle }
        }
        Some(0.5 * (low + high))
    }

    /// The direction (a unit vector) seen at a pixel, with a curve that rises up to `limit_rad`; `None` past it.
    pub fn bearing(&self, pixel: &Vector2<f64>, limit_rad: f64) -> Option<Vector3<f64>> {
        let place = self.in_plane(pixel);
        let (sin, cos) = libm::sincos(self.angle_rad(pixel, limit_rad)?);
        let radius = place.norm();
        let outward = if radius > 0.0 { place / radius } else { Vector2::x() };
        Some(Vector3::new(sin * outward.x, sin * outward.y, cos))
    }

    /// A pixel taken back through the affine part, px from the centre.
    fn in_plane(&self, pixel: &Vector2<f64>) -> Vector2<f64> {
        let p = &self.parameters;
        let from_centre = pixel - self.centre_px();
        let x = from_centre.x;
        Vector2::new(x, (from_centre.y - p[AFFINE + 1] * x) / p[AFFINE])
    }

    fn curve(&self) -> curve::Curve<'_> {
        curve::Curve { model: self.model, numbers: &self.parameters.as_slice()[RADIAL..] }
    }

    /// Where the direction of `point` (of any length) is seen; `None` where the curve has no answer.
    pub fn pixel(&self, point: &Vector3<f64>) -> Option<Vector2<f64>> {
        self.project(point).map(|projection| projection.pixel)
    }

    /// [`Lens::pixel`] with its derivatives.
    pub(crate) fn project(&self, point: &Vector3<f64>) -> Option<Projection> {
        let flat = libm::hypot(point.x, point.y);
        let length = libm::hypot(flat, point.z);
        if !(length > 0.0 && length.is_finite()) {
            return None;
        }
        let (sin, cos) = (flat / length, point.z / length);
        let at = self.curve().at(sin, cos)?;
        let radius = at.radius * self.scale_px;
        let slope = at.slope * self.scale_px;
        let outward = if flat > 0.0 { point.xy() / flat } else { Vector2::x() };

        // by the point: d angle = (cos d flat - sin dz) / length, and the turn about the axis
        let per_flat = if sin > 1e-9 { radius / flat } else { slope / length * cos.signum() };
        let across = outward * outward.transpose();
        let turning = (nalgebra::Matrix2::identity() - across) * per_flat + across * (slope * cos / length);
        let along = outward * (-slope * sin / length);
        let place_by_point =
            Matrix2x3::new(turning.m11, turning.m12, along.x, turning.m21, turning.m22, along.y);

        let place = outward * radius;
        let (c, d) = (self.parameters[AFFINE], self.parameters[AFFINE + 1]);
        let affine = nalgebra::Matrix2::new(1.0, 0.0, d, c);
        let pixel = affine * place + self.centre_px();

        let mut by_parameters = ByParameters::zeros();
        by_parameters[(0, CENTRE)] = 1.0;
        by_parameters[(1, CENTRE + 1)] = 1.0;
        by_parameters[(1, AFFINE)] = place.y;
        by_parameters[(1, AFFINE + 1)] = place.x;
        let outward_px = affine * outward * self.scale_px;
        for (k, by) in at.by_numbers.iter().enumerate().take(self.model.radial()) {
            by_parameters[(0, RADIAL + k)] = outward_px.x * by;
            by_parameters[(1, RADIAL + k)] = outward_px.y * by;
        }
        pixel.iter().all(|value| value.is_finite()).then_some(Projection {
            pixel,
            by_point: affine * place_by_point,
            by_parameters,
        })
    }

    /// The angle up to which the curve rises with at least a tenth of its slope on the axis, at most `limit_rad`.
    pub(crate) fn rises_to_rad(&self, limit_rad: f64) -> f64 {
        const STEPS: u32 = 400;
        let slope = |angle: f64| {
            let (sin, cos) = libm::sincos(angle);
            self.curve().at(sin, cos).map_or(f64::NEG_INFINITY, |at| at.slope)
        };
        let least = 0.1 * slope(0.0);
        let step = limit_rad / f64::from(STEPS);
        let rising = (1..=STEPS).take_while(|i| slope(step * f64::from(*i)) > least).count();
        step * rising as f64
    }
}

#[cfg(test)]
mod tests;
