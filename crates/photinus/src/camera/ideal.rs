//! Lenses with a law in place of a polynomial: what a data sheet says, and what the paper uses (phi = k r).

use core::f64::consts::{FRAC_PI_2, PI};

use super::Pixel;
use super::error::CameraError;
use super::inverse::Inverse;
use super::plane::Plane;
use super::radial::{AtAngle, AtRadius, End, Radial, Reach};
#[cfg(not(feature = "std"))]
use crate::float::Float as _;

/// A law between the angle theta off the axis and the radius r, in focal lengths.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum IdealLaw {
    /// r = theta (the paper's phi = k r).
    Equidistant,
    /// r = 2 sin(theta / 2).
    Equisolid,
    /// r = 2 tan(theta / 2).
    Stereographic,
    /// r = sin(theta), up to 90 deg.
    Orthographic,
}

/// A lens that follows a law.
#[derive(Clone, Debug, PartialEq)]
pub struct Ideal {
    law: IdealLaw,
    pub(super) plane: Plane,
}

impl Ideal {
    /// A lens that follows `law`, with focal lengths along u and v in px, about `centre`.
    ///
    /// # Errors
    /// [`CameraError`] when a number is not finite or a focal length not positive.
    pub fn new(law: IdealLaw, focal_px: [f64; 2], centre: Pixel) -> Result<Self, CameraError> {
        Ok(Self { law, plane: Plane::with_focal(centre, focal_px)? })
    }

    /// The law.
    pub fn law(&self) -> IdealLaw {
        self.law
    }

    /// Focal lengths along u and v, px (for the equidistant law px per rad, 1/k of the paper).
    pub fn focal_px(&self) -> [f64; 2] {
        self.plane.focal_px()
    }

    /// Where the optical axis meets the image.
    pub fn centre(&self) -> Pixel {
        self.plane.centre()
    }

    /// The angle at a radius; `None` past the last one.
    fn angle(&self, radius: f64) -> Option<f64> {
        let half = 0.5 * radius;
        match self.law {
            IdealLaw::Equidistant => (radius < PI).then_some(radius),
            IdealLaw::Equisolid => (half < 1.0).then(|| 2.0 * libm::asin(half)),
            IdealLaw::Stereographic => Some(2.0 * libm::atan(half)),
            IdealLaw::Orthographic => (radius < 1.0).then(|| libm::asin(radius)),
        }
    }
}

impl Radial for Ideal {
    fn reach(&self, ring: f64) -> Reach {
        let (last_radius, last_rad) = match self.law {
            IdealLaw::Equidistant => (PI, PI),
            IdealLaw::Equisolid => (2.0, PI),
            IdealLaw::Stereographic => (f64::INFINITY, PI),
            IdealLaw::Orthographic => (1.0, FRAC_PI_2),
        };
        match self.angle(ring) {
            Some(angle_rad) => Reach { radius: ring, angle_rad, end: End::Image },
            None => Reach { radius: last_radius, angle_rad: last_rad, end: End::Sphere },
        }
    }

    fn radius(&self, angle_rad: f64, _: &Reach) -> Option<f64> {
        let half = 0.5 * angle_rad;
        Some(match self.law {
            IdealLaw::Equidistant => angle_rad,
            IdealLaw::Equisolid => 2.0 * libm::sin(half),
            IdealLaw::Stereographic => 2.0 * libm::tan(half),
            IdealLaw::Orthographic => libm::sin(angle_rad),
        })
    }

    fn inverse(&self, _: f64, _: f64) -> Option<Inverse> {
        Some(Inverse::default())
    }

    fn at_radius(&self, radius: f64, _: &Inverse) -> Option<AtRadius> {
        let squared = radius * radius;
        Some(match self.law {
            IdealLaw::Equidistant => {
                let (sin, cos) = libm::sincos(radius);
                let sin_per_radius = if radius > 0.0 { sin / radius } else { 1.0 };
                AtRadius { sin_per_radius, cos, slope: 1.0 }
            }
            IdealLaw::Equisolid => {
                let cos_half = (1.0 - 0.25 * squared).sqrt();
                AtRadius { sin_per_radius: cos_half, cos: 1.0 - 0.5 * squared, slope: 1.0 / cos_half }
            }
            IdealLaw::Stereographic => {
                let slope = 4.0 / (4.0 + squared);
                AtRadius { sin_per_radius: slope, cos: (4.0 - squared) / (4.0 + squared), slope }
            }
            IdealLaw::Orthographic => {
                let cos = (1.0 - squared).sqrt();
                AtRadius { sin_per_radius: 1.0, cos, slope: 1.0 / cos }
            }
        })
        .filter(|at| at.slope.is_finite())
    }

    fn at_angle(&self, sin: f64, cos: f64, _: &Inverse) -> Option<AtAngle> {
        // 1 + cos cancels behind the camera, sin^2 / (1 - cos) does not
        let one_plus_cos = if cos > 0.0 { 1.0 + cos } else { sin * sin / (1.0 - cos) };
        let cos_half = (0.5 * one_plus_cos).sqrt();
        let at = match self.law {
            IdealLaw::Equidistant => {
                let radius_per_sin = if sin > 0.0 { libm::atan2(sin, cos) / sin } else { 1.0 };
                AtAngle { radius_per_sin, slope: 1.0 }
            }
            IdealLaw::Equisolid => AtAngle { radius_per_sin: 1.0 / cos_half, slope: cos_half },
            IdealLaw::Stereographic => {
                AtAngle { radius_per_sin: 2.0 / one_plus_cos, slope: 2.0 / one_plus_cos }
            }
            IdealLaw::Orthographic => AtAngle { radius_per_sin: 1.0, slope: cos },
        };
        at.radius_per_sin.is_finite().then_some(at)
    }
}
