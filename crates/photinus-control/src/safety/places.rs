//! Neighbours, what is not watched and the map -> what a commitment keeps clear of, and by how much.

use super::commitment::Commitment;
use super::{Limits, Obstacle, Sector};

/// What a commitment must keep clear of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Place {
    /// A neighbour that was seen is in the sector grown by `grown_m`; the vehicle may part from it slowly where `parts`.
    Neighbour { sector: Sector, grown_m: f64, parts: bool },
    /// Somebody may be in the sector grown by `grown_m`; the vehicle may part from it slowly where `parts`.
    Unknown { sector: Sector, grown_m: f64, parts: bool },
    /// A body of the map.
    Body(Obstacle),
}

/// What a commitment that a place allows rests upon.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Ground {
    Clear,
    Slow,
    Blocked,
}

impl Place {
    /// Whether anything at all that a vehicle could do touches the place.
    pub(super) fn matters(&self, limits: &Limits) -> bool {
        let reach = limits.longest_reach_m() + limits.longest_stray_m();
        // What is no number matters.
        let is_far = match self {
            Self::Neighbour { sector, grown_m, .. } | Self::Unknown { sector, grown_m, .. } => {
                sector.distances.min_m() - grown_m >= limits.clearance_m() + reach
            }
            Self::Body(body) => body.distance_m(&nalgebra::Vector3::zeros()) >= limits.radius_m + reach,
        };
        !is_far
    }

    /// What the place says to a commitment.
    pub(super) fn allows(&self, limits: &Limits, path: &Commitment<'_>) -> Ground {
        let said = |is_clear: bool| if is_clear { Ground::Clear } else { Ground::Blocked };
        match self {
            Self::Body(body) => {
                said(path.clear_of_m(|x| body.distance_m(x)) >= limits.radius_m + limits.stray_m)
            }
            Self::Neighbour { sector, grown_m, parts } => said(
                is_clear(limits, path, sector, *grown_m) || *parts && leaves(limits, path, sector, *grown_m),
            ),
            Self::Unknown { sector, grown_m, parts } => {
                let parts = *parts && leaves(limits, path, sector, *grown_m);
                if parts || is_clear(limits, path, sector, *grown_m) {
                    Ground::Clear
                } else if path.progress_m(&sector.axis) <= slow_reach_m(limits) {
                    Ground::Slow
                } else {
                    Ground::Blocked
                }
            }
        }
    }
}

/// Whether a path keeps clear of wherever somebody in the sector can be, or brake into.
fn is_clear(limits: &Limits, path: &Commitment<'_>, sector: &Sector, grown_m: f64) -> bool {
    let keep_m = limits.clearance_m() + grown_m + limits.stray_m;
    let near_m = sector.distances.min_m();
    // Where the path begins, and how far it gets, tell most of them.
    if near_m < keep_m {
        return false;
    }
    if near_m - path.reach_m() >= keep_m {
        return true;
    }
    let edged = sector.edged();
    path.clear_of_m(|x| edged.distance_m(x)) >= keep_m
}

/// Whether a path leads away, slowly, from somebody who is too near.
fn leaves(limits: &Limits, path: &Commitment<'_>, sector: &Sector, grown_m: f64) -> bool {
    let is_apart =
        sector.distances.min_m() - grown_m >= limits.separation_m() + 2.0 * limits.longest_stray_m();
    // Since it was seen, the bearing may have turned.
    let turned_rad = libm::asin((grown_m / sector.distances.min_m().max(grown_m).max(1e-9)).min(1.0));
    let beyond_rad = sector.half_angle_rad + turned_rad + super::limits::PARTING_TURN_RAD;
    is_apart
        && beyond_rad < core::f64::consts::FRAC_PI_2
        && path.top_speed_m_s() + limits.velocity_error_m_s <= limits.parting_speed_m_s()
        && path.leads_away(&sector.axis, beyond_rad)
}

/// How far a vehicle commits itself towards what is not known, m.
fn slow_reach_m(limits: &Limits) -> f64 {
    let speed = limits.unknown_speed_m_s;
    speed * limits.blind_s() + speed * speed / (2.0 * limits.braking_m_s2)
}
