//! Scaramuzza's omnidirectional model as OCamCalib writes it: z(r), a polynomial of any degree.

use alloc::vec::Vec;
use core::f64::consts::PI;

use nalgebra::Matrix2;

use super::Pixel;
use super::error::{CameraError, finite};
use super::inverse::{Bracket, Inverse};
use super::plane::Plane;
use super::polynomial::{first_not_positive, value_and_slope};
use super::radial::{AtAngle, AtRadius, End, Radial, Reach};
#[cfg(not(feature = "std"))]
use crate::float::Float as _;

/// D. Scaramuzza, A. Martinelli, R. Siegwart, "A Flexible Technique for Accurate Omnidirectional Camera Calibration
/// and Structure from Motion", ICVS 2006.
///
/// With (row, column) measured from the centre and taken back through the stretch matrix to (a, b), the ray in
/// the camera frame is (b, a, -z(r)), r = |(a, b)|. The file's inverse polynomial is not used: the inverse is solved.
#[derive(Clone, Debug, PartialEq)]
pub struct OCam {
    direct: Vec<f64>,
    pub(super) plane: Plane,
}

impl OCam {
    /// Most coefficients that programs in the field accept in a file.
    pub const MAX_COEFFICIENTS: usize = 64;

    /// A lens of a shorter focal length than this is a slip, and its squares would vanish.
    const SHORTEST_PX: f64 = 1e-6;

    /// The model from the `direct` polynomial z(r) (px over px, ascending powers, term 0 negative), the `centre`, and
    /// the `stretch` matrix ([c d; e 1] in a file) that maps (a, b) to (row, column).
    ///
    /// # Errors
    /// [`CameraError`] when a number is not finite, there are no or too many coefficients, term 0 is not negative, or
    /// the matrix cannot be inverted.
    pub fn new(direct: &[f64], centre: Pixel, stretch: Matrix2<f64>) -> Result<Self, CameraError> {
        if direct.is_empty() || direct.len() > Self::MAX_COEFFICIENTS {
            return Err(CameraError::Coefficients { count: direct.len() });
        }
        finite("a coefficient of the direct polynomial", direct)?;
        if direct[0] > -Self::SHORTEST_PX {
            return Err(CameraError::LooksBack { value: direct[0] });
        }
        let plane = Plane::new(centre, swap_axes(&stretch))?;
        Ok(Self { direct: direct.to_vec(), plane })
    }

    /// The direct polynomial z(r), ascending powers of r in px, term 0 negative.
    pub fn direct(&self) -> &[f64] {
        &self.direct
    }

    /// Where the optical axis meets the image.
    pub fn centre(&self) -> Pixel {
        self.plane.centre()
    }

    /// The matrix that maps (a, b) to (row, column).
    pub fn stretch(&self) -> Matrix2<f64> {
        swap_axes(&self.plane.pixel_from_plane)
    }

    /// More than |z| anywhere within a radius.
    pub(super) fn height_bound(&self, radius: f64) -> f64 {
        self.direct.iter().rev().fold(0.0, |sum, a| sum * radius + a.abs())
    }

    /// r z' - z: positive where the angle grows with the radius.
    fn growth(&self) -> Vec<f64> {
        self.direct.iter().enumerate().map(|(k, a)| (k as f64 - 1.0) * a).collect()
    }

    /// The radius where the ray's direction is (`sin`, `cos`), of any length: the root of sin z(r) + cos r.
    #[inline]
    fn solve(&self, sin: f64, cos: f64, bracket: Bracket) -> Option<f64> {
        bracket.root(|r| {
            let (z, slope) = value_and_slope(&self.direct, r);
            (sin * z + cos * r, sin * slope + cos)
        })
    }
}

impl Radial for OCam {
    fn reach(&self, ring: f64) -> Reach {
        let turn = first_not_positive(&self.growth(), ring);
        let radius = turn.unwrap_or(ring);
        let angle_rad = libm::atan2(radius, -value_and_slope(&self.direct, radius).0);
        Reach { radius, angle_rad, end: if turn.is_some() { End::Turn } else { End::Image } }
    }

    fn radius(&self, angle_rad: f64, reach: &Reach) -> Option<f64> {
        let (sin, cos) = libm::sincos(angle_rad);
        self.solve(sin, cos, Bracket::up_to(reach.radius, -self.direct[0] * angle_rad))
    }

    fn inverse(&self, angle_rad: f64, radius: f64) -> Option<Inverse> {
        let (sin, cos) = libm::sincos(angle_rad.min(PI));
        Inverse::tabulate(diamond(sin, cos), radius, |key, bracket| {
            let (sin, cos) = (key.min(2.0 - key), 1.0 - key);
            self.solve(sin, cos, bracket)
        })
    }

    #[inline(always)]
    fn at_radius(&self, radius: f64, _: &Inverse) -> Option<AtRadius> {
        let (z, slope) = value_and_slope(&self.direct, radius);
        let length_squared = radius * radius + z * z;
        let per_length = 1.0 / length_squared.sqrt();
        Some(AtRadius {
            sin_per_radius: per_length,
            cos: -z * per_length,
            slope: (radius * slope - z) / length_squared,
        })
    }

    #[inline(always)]
    fn at_angle(&self, sin: f64, cos: f64, inverse: &Inverse) -> Option<AtAngle> {
        let radius = self.solve(sin, cos, inverse.bracket(diamond(sin, cos)))?;
        let (z, slope) = value_and_slope(&self.direct, radius);
        Some(AtAngle {
            radius_per_sin: if sin > 0.0 { radius / sin } else { -z },
            slope: (radius * radius + z * z) / (radius * slope - z),
        })
    }
}

/// A stand-in for the angle off the axis that costs one division: 0 forward, 1 at 90 deg, 2 behind.
#[inline]
fn diamond(sin: f64, cos: f64) -> f64 {
    1.0 - cos / (sin + cos.abs())
}

/// (row, column) <-> (column, row) on both sides of a matrix.
fn swap_axes(matrix: &Matrix2<f64>) -> Matrix2<f64> {
    Matrix2::new(matrix.m22, matrix.m21, matrix.m12, matrix.m11)
}
