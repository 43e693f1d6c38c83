//! Spot size and marker pairs -> distance with bounds.
//!
//! Bearings to markers and the areas of their spots enter; distances from the camera's centre to the
//! airframe's origin leave, in four kinds that are never mixed:
//!
//! - [`SpotCurve`]: how near or far a spot of this many pixels can be (paper (13), inverted);
//! - [`AdjacentPair`] and [`Margins`](margins::Margins): the paper's two estimates for a ring seen from the
//!   side, (5) to (12);
//! - [`DistanceBounds`]: strict bounds for any airframe, attitude and subset of its markers;
//! - [`Estimate`]: a distance with its sigma, for any airframe; [`crate::locator`] makes it.
//!
//! "Paper" is V. Walter, M. Saska, A. Franchi, "Fast Mutual Relative Localization of UAVs using Ultraviolet
//! LED Markers", ICUAS 2018.

mod bearing_bound;
pub mod bounds;
mod estimate;
mod interval;
pub mod margins;
mod pair;
mod spot_size;

pub use bearing_bound::bearing_bound_rad;
pub use bounds::{BoundedBearing, DistanceBounds};
pub use estimate::Estimate;
pub use interval::Interval;
pub use pair::AdjacentPair;
pub use spot_size::{Envelope, SpotCurve, SpotCurveError};
