//! Light of one spot in the window of another.
//!
//! In: measured spots. Out: the same, with wider covariances beside brighter ones. What a lens scatters around a bright spot
//! is no plane, so that what is left of it after the background is taken off pulls the centre of a fainter spot. How far
//! depends on the lens; on the rendered frames of a fisheye with half of its light in a skirt of 2.2 px the root mean square
//! is 0.016 px times the ratio of light up to 4.5 px away, and falls by e every 2 px from there.

use nalgebra::Matrix2;

use super::Spot;

/// Pull per ratio of light, px.
const PULL_PX: f64 = 0.016;
/// From the other's edge, px: up to here the pull does not fall, then by e every so much, and beyond the last there is none.
const NEAR_PX: f64 = 4.0;
const FALL_PX: f64 = 2.0;
const FAR_PX: f64 = 12.0;
/// No light pulls a centre farther than this, px: beyond it the spot would be another's.
const STRONGEST_PX: f64 = 0.5;

/// Widens the covariances of spots that stand beside brighter ones. Spots come ordered by their first row.
pub(super) fn widen(spots: &mut [Spot]) {
    for index in 0..spots.len() {
        let Some((own, below)) = spots[index..].split_first_mut() else { return };
        for other in below {
            if f64::from(other.extent.top) > f64::from(own.extent.bottom) + FAR_PX {
                break;
            }
            pull(own, other);
            pull(other, own);
        }
    }
}

fn pull(own: &mut Spot, other: &Spot) {
    let (du, dv) = (other.centre.u - own.centre.u, other.centre.v - own.centre.v);
    let radius_px = 0.25 * f64::from(other.extent.width() + other.extent.height());
    let gap_px = libm::hypot(du, dv) - radius_px;
    if gap_px > FAR_PX || other.flux <= own.flux {
        return;
    }
    let near = libm::exp(-((gap_px - NEAR_PX).max(0.0)) / FALL_PX);
    let pull_px = (PULL_PX * near * other.flux / own.flux.max(1.0)).min(STRONGEST_PX);
    own.covariance_px2 += Matrix2::from_diagonal_element(pull_px * pull_px);
}
