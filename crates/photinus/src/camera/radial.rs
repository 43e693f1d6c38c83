//! What every lens that is symmetric about its axis shares: one curve between the radius in its plane and the angle
//! off the axis gives both directions and both Jacobians, on the axis and past 90 deg.

use nalgebra::{Matrix2, Matrix2x3, Matrix3x2, Vector2, Vector3};

use super::field::Field;
use super::inverse::Inverse;
#[cfg(not(feature = "std"))]
use crate::float::Float as _;

/// The curve at a radius.
pub(super) struct AtRadius {
    /// sin(angle) / radius; on the axis its limit.
    pub(super) sin_per_radius: f64,
    pub(super) cos: f64,
    /// d angle / d radius.
    pub(super) slope: f64,
}

/// The curve at an angle.
pub(super) struct AtAngle {
    /// radius / sin(angle); on the axis its limit.
    pub(super) radius_per_sin: f64,
    /// d radius / d angle.
    pub(super) slope: f64,
}

/// How far out a curve can be followed.
pub(super) struct Reach {
    pub(super) radius: f64,
    pub(super) angle_rad: f64,
    pub(super) end: End,
}

/// Why a curve cannot be followed further.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum End {
    /// The image ends.
    Image,
    /// There is nothing further to see (or nothing that this kind of lens can see).
    Sphere,
    /// The curve turns back.
    Turn,
}

/// A lens symmetric about its axis.
pub(super) trait Radial {
    /// How far out the curve rises, up to `ring`, the radius of the farthest corner of the image.
    fn reach(&self, ring: f64) -> Reach;

    /// The radius at an angle within `reach`; for construction.
    fn radius(&self, angle_rad: f64, reach: &Reach) -> Option<f64>;

    /// The table that `at_radius` or `at_angle` starts from; empty when both have a closed form.
    fn inverse(&self, angle_rad: f64, radius: f64) -> Option<Inverse>;

    /// The curve at a radius within the field.
    fn at_radius(&self, radius: f64, inverse: &Inverse) -> Option<AtRadius>;

    /// The curve at an angle within the field, given as its sine and cosine.
    fn at_angle(&self, sin: f64, cos: f64, inverse: &Inverse) -> Option<AtAngle>;
}

/// The unit vector at a place in the plane, and its derivative.
#[inline(always)]
pub(super) fn lift(
    lens: &impl Radial,
    field: &Field,
    place: &Vector2<f64>,
) -> Option<(Vector3<f64>, Matrix3x2<f64>)> {
    let radius = place.norm_squared().sqrt();
    if radius > field.limit_radius {
        return None;
    }
    let AtRadius { sin_per_radius, cos, slope } = lens.at_radius(radius, &field.inverse)?;
    let outward = outward(place, radius);
    let across = outward * outward.transpose();
    let flat = across * (cos * slope) + (Matrix2::identity() - across) * sin_per_radius;
    let down = outward * (-sin_per_radius * radius * slope);
    let bearing = Vector3::new(sin_per_radius * place.x, sin_per_radius * place.y, cos);
    Some((bearing, Matrix3x2::new(flat.m11, flat.m12, flat.m21, flat.m22, down.x, down.y)))
}

/// The place in the plane of a unit vector, and its derivative along the sphere (zero along the vector itself).
#[inline(always)]
pub(super) fn project(
    lens: &impl Radial,
    field: &Field,
    bearing: &Vector3<f64>,
) -> Option<(Vector2<f64>, Matrix2x3<f64>)> {
    let flat = bearing.xy();
    let (sin, cos) = (flat.norm_squared().sqrt(), bearing.z);
    let exactly_behind = sin <= 0.0 && cos < 0.0;
    if exactly_behind || !field.sees(cos) {
        return None;
    }
    let AtAngle { radius_per_sin, slope } = lens.at_angle(sin, cos, &field.inverse)?;
    let outward = outward(&flat, sin);
    let across = outward * outward.transpose();
    let plane = across * (slope * cos) + (Matrix2::identity() - across) * radius_per_sin;
    let along_axis = outward * (-slope * sin);
    let jacobian = Matrix2x3::new(plane.m11, plane.m12, along_axis.x, plane.m21, plane.m22, along_axis.y);
    Some((flat * radius_per_sin, jacobian))
}

/// The unit vector away from the axis; any on the axis, where all give the same.
#[inline(always)]
fn outward(flat: &Vector2<f64>, length: f64) -> Vector2<f64> {
    if length > 0.0 { flat / length } else { Vector2::x() }
}
