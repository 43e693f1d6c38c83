//! How far off the axis a camera answers.

use super::error::CameraError;
use super::inverse::Inverse;
use super::radial::{End, Radial, Reach};

/// The part of the sphere that a camera sees: outside it there is no answer.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Field {
    pub(super) limit_rad: f64,
    limit_cos: f64,
    /// The same limit in the lens's plane (for a pinhole: in the plane before distortion).
    pub(super) limit_radius: f64,
    /// Where the lens's iterative direction starts from.
    pub(super) inverse: Inverse,
}

impl Field {
    pub(super) fn new(limit_rad: f64, limit_radius: f64, inverse: Inverse) -> Self {
        Self { limit_rad, limit_cos: libm::cos(limit_rad), limit_radius, inverse }
    }

    /// The field of a radial lens whose image ends at `ring`, in px through `px_per_unit` for messages.
    pub(super) fn of_radial(
        lens: &impl Radial,
        ring: f64,
        stated_rad: Option<f64>,
        px_per_unit: f64,
    ) -> Result<Self, CameraError> {
        let reach = lens.reach(ring);
        let turns = reach.not_monotonic(px_per_unit);
        let limit_rad = reach.limit(stated_rad, px_per_unit)?;
        let limit_radius =
            if limit_rad < reach.angle_rad { lens.radius(limit_rad, &reach) } else { Some(reach.radius) };
        let limit_radius = limit_radius.filter(|r| *r > 0.0 && r.is_finite()).ok_or(turns.clone())?;
        let inverse = lens.inverse(limit_rad, limit_radius).ok_or(turns)?;
        Ok(Self::new(limit_rad, limit_radius, inverse))
    }

    #[inline]
    pub(super) fn sees(&self, cos: f64) -> bool {
        cos >= self.limit_cos
    }
}

impl Reach {
    /// The field limit: what was stated, clipped to the reach.
    pub(super) fn limit(&self, stated_rad: Option<f64>, px_per_unit: f64) -> Result<f64, CameraError> {
        let stated_rad = stated_rad.unwrap_or(f64::INFINITY);
        if self.end == End::Turn && stated_rad >= self.angle_rad {
            return Err(self.not_monotonic(px_per_unit));
        }
        Ok(stated_rad.min(self.angle_rad))
    }

    pub(super) fn not_monotonic(&self, px_per_unit: f64) -> CameraError {
        CameraError::NotMonotonic { radius_px: self.radius * px_per_unit, angle_rad: self.angle_rad }
    }
}
