//! The ordinary camera: a pinhole with Brown-Conrady distortion, as OpenCV and ROS ("plumb_bob",
//! "rational_polynomial") write it. The one model that does not reach 90 deg.

use alloc::vec;

use nalgebra::{Matrix2, Matrix2x3, Matrix3, Matrix3x2, Vector2, Vector3};

use super::Pixel;
use super::error::{CameraError, finite};
use super::field::Field;
use super::inverse::{Bracket, Inverse};
use super::plane::Plane;
use super::polynomial::{derivative, first_not_positive, minus, product, value_and_slope};
use super::radial::{End, Reach};

/// With (x, y) = (X / Z, Y / Z) and q = x^2 + y^2 the distorted place is
/// (x, y) (1 + k1 q + k2 q^2 + k3 q^3) / (1 + k4 q + k5 q^2 + k6 q^3)
/// + (2 p1 x y + p2 (q + 2 x^2), p1 (q + 2 y^2) + 2 p2 x y).
#[derive(Clone, Debug, PartialEq)]
pub struct Pinhole {
    radial: [f64; 6],
    tangential: [f64; 2],
    pub(super) plane: Plane,
}

impl Pinhole {
    /// The farthest off the axis that a pinhole is followed: 89.9 deg.
    const STEEPEST_RAD: f64 = 89.9 * core::f64::consts::PI / 180.0;

    /// The model with focal lengths along u and v in px, about `centre`, with `radial` k1 to k6 (k4 to k6 divide) and
    /// `tangential` p1, p2.
    ///
    /// # Errors
    /// [`CameraError`] when a number is not finite or a focal length not positive.
    pub fn new(
        focal_px: [f64; 2],
        centre: Pixel,
        radial: [f64; 6],
        tangential: [f64; 2],
    ) -> Result<Self, CameraError> {
        finite("a radial coefficient", &radial)?;
        finite("a tangential coefficient", &tangential)?;
        Ok(Self { radial, tangential, plane: Plane::with_focal(centre, focal_px)? })
    }

    /// k1 to k6; k4 to k6 are those of the denominator.
    pub fn radial(&self) -> [f64; 6] {
        self.radial
    }

    /// p1 and p2.
    pub fn tangential(&self) -> [f64; 2] {
        self.tangential
    }

    /// Focal lengths along u and v, px.
    pub fn focal_px(&self) -> [f64; 2] {
        self.plane.focal_px()
    }

    /// Where the optical axis meets the image.
    pub fn centre(&self) -> Pixel {
        self.plane.centre()
    }

    /// Numerator and denominator of the radial factor, in powers of q.
    fn factors(&self) -> ([f64; 4], [f64; 4]) {
        let [k1, k2, k3, k4, k5, k6] = self.radial;
        ([1.0, k1, k2, k3], [1.0, k4, k5, k6])
    }

    /// The radial factor and its derivative by q.
    fn factor(&self, q: f64) -> (f64, f64) {
        let (top, bottom) = self.factors();
        let ((n, dn), (d, dd)) = (value_and_slope(&top, q), value_and_slope(&bottom, q));
        (n / d, (dn * d - n * dd) / (d * d))
    }

    /// The distorted place and its derivative, which is symmetric.
    fn distort(&self, place: &Vector2<f64>) -> (Vector2<f64>, Matrix2<f64>) {
        let (x, y, [p1, p2]) = (place.x, place.y, self.tangential);
        let q = place.norm_squared();
        let (factor, slope) = self.factor(q);
        let shift = Vector2::new(
            2.0 * p1 * x * y + p2 * (q + 2.0 * x * x),
            p1 * (q + 2.0 * y * y) + 2.0 * p2 * x * y,
        );
        let off_diagonal = 2.0 * (slope * x * y + p1 * x + p2 * y);
        let jacobian = Matrix2::new(
            factor + 2.0 * (slope * x * x + p1 * y + 3.0 * p2 * x),
            off_diagonal,
            off_diagonal,
            factor + 2.0 * (slope * y * y + 3.0 * p1 * y + p2 * x),
        );
        (place * factor + shift, jacobian)
    }

    /// The radius after distortion, without the tangential part.
    fn distort_radius(&self, radius: f64) -> f64 {
        radius * self.factor(radius * radius).0
    }

    /// The radius before distortion, without the tangential part.
    fn undistort_radius(&self, distorted: f64, bracket: Bracket) -> Option<f64> {
        bracket.root(|r| {
            let (factor, slope) = self.factor(r * r);
            (r * factor - distorted, factor + 2.0 * r * r * slope)
        })
    }

    /// The place before distortion, by Newton from the place that has the right radial part.
    fn undistort(&self, distorted: &Vector2<f64>, bracket: Bracket) -> Option<(Vector2<f64>, Matrix2<f64>)> {
        let radius = distorted.norm();
        let start = self.undistort_radius(radius, bracket)?;
        let mut place = if radius > 0.0 { distorted * (start / radius) } else { Vector2::zeros() };
        for _ in 0..20 {
            let (value, jacobian) = self.distort(&place);
            let inverse = jacobian.try_inverse()?;
            let step = inverse * (distorted - value);
            place += step;
            if step.norm() <= 1e-13 * (1.0 + place.norm()) {
                return Some((place, inverse));
            }
        }
        None
    }

    /// The radius before distortion up to which no two places share an image.
    ///
    /// The distortion is the gradient of a potential, so it is one to one on a disc where its derivative is positive
    /// definite. The radial part has the eigenvalues d(r f)/dr and f, the tangential part takes at most 6 |p| r away.
    fn first_fold(&self, last: f64) -> Option<f64> {
        let in_radius = |c: [f64; 4]| vec![c[0], 0.0, c[1], 0.0, c[2], 0.0, c[3]];
        let (top, bottom) = self.factors();
        let (n, d) = (in_radius(top), in_radius(bottom));
        let rn = product(&[0.0, 1.0], &n);
        let taken = [0.0, 6.0 * libm::hypot(self.tangential[0], self.tangential[1])];
        let across = minus(&n, 1.0, &product(&taken, &d));
        let quotient_rule = minus(&product(&derivative(&rn), &d), 1.0, &product(&rn, &derivative(&d)));
        let along = minus(&quotient_rule, 1.0, &product(&taken, &product(&d, &d)));
        [d, across, along].iter().filter_map(|p| first_not_positive(p, last)).min_by(f64::total_cmp)
    }

    /// How far out the image reaches, given its corners in the plane.
    fn reach(&self, corners: &[Vector2<f64>]) -> Reach {
        let last = libm::tan(Self::STEEPEST_RAD);
        let fold = self.first_fold(last);
        let radius = fold.unwrap_or(last);
        let outermost = corners.iter().try_fold(0.0_f64, |outermost, corner| {
            let (place, _) = self.undistort(corner, Bracket::up_to(radius, corner.norm()))?;
            (place.norm() < radius
                && (self.distort(&place).0 - corner).norm() <= 1e-9 * (1.0 + corner.norm()))
            .then(|| outermost.max(place.norm()))
        });
        match outermost {
            Some(radius) => {
                Reach { radius: self.distort_radius(radius), angle_rad: libm::atan(radius), end: End::Image }
            }
            None => {
                let end = if fold.is_some() { End::Turn } else { End::Sphere };
                Reach { radius: self.distort_radius(radius), angle_rad: libm::atan(radius), end }
            }
        }
    }

    pub(super) fn field(
        &self,
        corners: &[Vector2<f64>],
        stated_rad: Option<f64>,
    ) -> Result<Field, CameraError> {
        let reach = self.reach(corners);
        let px_per_unit = self.plane.px_per_unit();
        let limit_rad = reach.limit(stated_rad, px_per_unit)?;
        let limit_radius = libm::tan(limit_rad);
        let top = limit_radius * self.factor(limit_radius * limit_radius).0;
        let inverse =
            Inverse::tabulate(top, limit_radius, |radius, bracket| self.undistort_radius(radius, bracket))
                .ok_or(reach.not_monotonic(px_per_unit))?;
        Ok(Field::new(limit_rad, limit_radius, inverse))
    }

    pub(super) fn lift(
        &self,
        field: &Field,
        distorted: &Vector2<f64>,
    ) -> Option<(Vector3<f64>, Matrix3x2<f64>)> {
        let (place, inverse) = self.undistort(distorted, field.inverse.bracket(distorted.norm()))?;
        if place.norm() > field.limit_radius {
            return None;
        }
        let ray = place.push(1.0);
        let length = ray.norm();
        let bearing = ray / length;
        let turn = (Matrix3::identity() - bearing * bearing.transpose()) / length;
        Some((bearing, turn.fixed_columns::<2>(0) * inverse))
    }

    pub(super) fn project(
        &self,
        field: &Field,
        bearing: &Vector3<f64>,
    ) -> Option<(Vector2<f64>, Matrix2x3<f64>)> {
        if !field.sees(bearing.z) || bearing.z <= 0.0 {
            return None;
        }
        let place = bearing.xy() / bearing.z;
        let (distorted, jacobian) = self.distort(&place);
        let flat = Matrix2x3::new(1.0, 0.0, -place.x, 0.0, 1.0, -place.y) / bearing.z;
        Some((distorted, jacobian * flat))
    }
}
