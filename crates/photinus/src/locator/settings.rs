//! What a user may choose about locating: effect, unit and default of each.

use crate::pose;
use crate::ranging::DistanceBounds;
use crate::spots;

/// What a user may choose about locating. Begin with [`Settings::default`] and change what you must.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Settings {
    /// What is a spot.
    pub spots: spots::Settings,
    /// Largest tilt of a neighbour against the vertical that the bounds allow for, rad. Default 15 deg. Only with gravity
    /// does it say anything: without, any attitude is allowed.
    pub max_tilt_rad: f64,
    /// What is believed of a neighbour's pose beforehand.
    pub pose: pose::Settings,
    /// Neighbours less likely than this are not told, 0 to 1. Default [`Self::DEFAULT_MIN_PROBABILITY`].
    pub min_probability: f64,
    /// Most work on one frame, in first looks at a handful of spots (one or two microseconds each): time is bounded, and the most probable comes first.
    /// Half as many spots are explained, the brightest; the others count as clutter. Default [`Self::DEFAULT_BUDGET`].
    pub budget: u32,
}

impl Settings {
    /// Neighbours as likely as not are told.
    pub const DEFAULT_MIN_PROBABILITY: f64 = 0.5;
    /// Enough for dozens of neighbours that overlap.
    pub const DEFAULT_BUDGET: u32 = 12_000;
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            spots: spots::Settings::default(),
            max_tilt_rad: DistanceBounds::DEFAULT_MAX_TILT_RAD,
            pose: pose::Settings::default(),
            min_probability: Self::DEFAULT_MIN_PROBABILITY,
            budget: Self::DEFAULT_BUDGET,
        }
    }
}
