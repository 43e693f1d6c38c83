//! The fisheye model of OpenCV, Kalibr ("equidistant") and ROS: a polynomial of the angle.

use core::f64::consts::PI;

use super::Pixel;
use super::error::{CameraError, finite};
use super::inverse::{Bracket, Inverse};
use super::plane::Plane;
use super::polynomial::{first_not_positive, value_and_slope};
use super::radial::{AtAngle, AtRadius, End, Radial, Reach};

/// J. Kannala, S. S. Brandt, "A Generic Camera Model and Calibration Method for Conventional, Wide-Angle, and Fish-Eye
/// Lenses", PAMI 2006, with the four radial terms of OpenCV's `fisheye`:
/// r = theta + k1 theta^3 + k2 theta^5 + k3 theta^7 + k4 theta^9, in focal lengths.
#[derive(Clone, Debug, PartialEq)]
pub struct KannalaBrandt {
    k: [f64; 4],
    pub(super) plane: Plane,
}

impl KannalaBrandt {
    /// The model with focal lengths along u and v in px, about `centre`, with k1 to k4.
    ///
    /// # Errors
    /// [`CameraError`] when a number is not finite or a focal length not positive.
    pub fn new(focal_px: [f64; 2], centre: Pixel, k: [f64; 4]) -> Result<Self, CameraError> {
        finite("a coefficient k", &k)?;
        Ok(Self { k, plane: Plane::with_focal(centre, focal_px)? })
    }

    /// The same with a shear, for an axis of the sensor that leans: a place x focal lengths to the right lies `shear_px` x
    /// lower than without.
    ///
    /// # Errors
    /// Those of [`KannalaBrandt::new`]; [`CameraError`] when the shear is not finite.
    pub fn with_shear(
        focal_px: [f64; 2],
        centre: Pixel,
        k: [f64; 4],
        shear_px: f64,
    ) -> Result<Self, CameraError> {
        finite("the shear", &[shear_px])?;
        let upright = Self::new(focal_px, centre, k)?;
        let mut pixel_from_plane = upright.plane.pixel_from_plane;
        pixel_from_plane.m21 = shear_px;
        Ok(Self { plane: Plane::new(centre, pixel_from_plane)?, ..upright })
    }

    /// How much lower a place one focal length to the right lies, px; 0 for most cameras.
    pub fn shear_px(&self) -> f64 {
        self.plane.pixel_from_plane.m21
    }

    /// k1 to k4.
    pub fn k(&self) -> [f64; 4] {
        self.k
    }

    /// Focal lengths along u and v, px.
    pub fn focal_px(&self) -> [f64; 2] {
        self.plane.focal_px()
    }

    /// Where the optical axis meets the image.
    pub fn centre(&self) -> Pixel {
        self.plane.centre()
    }

    /// Radius and d radius / d angle at an angle.
    #[inline]
    fn curve(&self, angle: f64) -> (f64, f64) {
        let [k1, k2, k3, k4] = self.k;
        let squared = angle * angle;
        let (value, slope) = value_and_slope(&[1.0, k1, k2, k3, k4], squared);
        (angle * value, value + 2.0 * squared * slope)
    }

    fn solve(&self, radius: f64, bracket: Bracket) -> Option<f64> {
        bracket.root(|angle| {
            let (value, slope) = self.curve(angle);
            (value - radius, slope)
        })
    }
}

impl Radial for KannalaBrandt {
    fn reach(&self, ring: f64) -> Reach {
        let [k1, k2, k3, k4] = self.k;
        let slope = [1.0, 0.0, 3.0 * k1, 0.0, 5.0 * k2, 0.0, 7.0 * k3, 0.0, 9.0 * k4];
        let turn = first_not_positive(&slope, PI);
        let last_rad = turn.unwrap_or(PI);
        let last_radius = self.curve(last_rad).0;
        if last_radius > ring
            && let Some(angle_rad) = self.solve(ring, Bracket::up_to(last_rad, ring))
        {
            return Reach { radius: ring, angle_rad, end: End::Image };
        }
        let end = if turn.is_some() { End::Turn } else { End::Sphere };
        Reach { radius: last_radius, angle_rad: last_rad, end }
    }

    fn radius(&self, angle_rad: f64, _: &Reach) -> Option<f64> {
        Some(self.curve(angle_rad).0)
    }

    fn inverse(&self, angle_rad: f64, radius: f64) -> Option<Inverse> {
        Inverse::tabulate(radius, angle_rad, |radius, bracket| self.solve(radius, bracket))
    }

    fn at_radius(&self, radius: f64, inverse: &Inverse) -> Option<AtRadius> {
        let angle = self.solve(radius, inverse.bracket(radius))?;
        let (sin, cos) = libm::sincos(angle);
        let sin_per_radius = if radius > 0.0 { sin / radius } else { 1.0 };
        Some(AtRadius { sin_per_radius, cos, slope: 1.0 / self.curve(angle).1 })
    }

    fn at_angle(&self, sin: f64, cos: f64, _: &Inverse) -> Option<AtAngle> {
        let (radius, slope) = self.curve(libm::atan2(sin, cos));
        Some(AtAngle { radius_per_sin: if sin > 0.0 { radius / sin } else { 1.0 }, slope })
    }
}
