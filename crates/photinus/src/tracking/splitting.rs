//! A normal distribution whose yaw is unsure -> several side by side that add up to it.
//!
//! Two spots leave a bent valley of distance against yaw; a Kalman update takes it for straight. Over a narrow stretch of yaw it is, so that updates see
//! narrow stretches only, and weigh them against each other (a Gaussian sum: D. L. Alspach, H. W. Sorenson, IEEE Trans. Autom. Control 17 (1972)).

use alloc::vec::Vec;

use super::component::{Component, Covariance, YAW};
#[cfg(not(feature = "std"))]
use crate::float::Float as _;

/// A valley that bends by less than this share of the sigma of a marker's place, across one standard deviation of yaw, is straight.
const BEND: f64 = 1.0 / 3.0;
/// No narrower and no wider yaw is asked for, rad: spots are not exact either, and lobes bend, too.
const STRAIGHT_RAD: [f64; 2] = [0.06, 0.25];
/// Most that one is split into.
const MOST_PARTS: usize = 13;
/// Parts are at most so far apart, in their own standard deviations, and reach so far, in those of the whole.
const SPACING: f64 = 1.5;
const REACH: f64 = 2.4;

/// Over so wide a yaw, one standard deviation, rad, valleys are straight, for markers so far from the axis whose places have this sigma in a frame.
pub(super) fn straight_rad(radius_m: f64, sigma_m: f64) -> f64 {
    // A marker that turns by yaw leaves its tangent by radius yaw^2 / 2.
    (2.0 * BEND * sigma_m / radius_m.max(f64::MIN_POSITIVE)).sqrt().clamp(STRAIGHT_RAD[0], STRAIGHT_RAD[1])
}

/// Adds a distribution, in parts where its yaw is less sure than `straight_rad`.
pub(super) fn split(whole: &Component, straight_rad: f64, parts: &mut Vec<Component>) {
    let variance = whole.covariance[(YAW, YAW)];
    let sigma = variance.sqrt();
    if sigma.is_nan() || sigma <= straight_rad {
        parts.push(*whole);
        return;
    }
    let beside = (REACH * sigma / (SPACING * straight_rad)).ceil().min((MOST_PARTS / 2) as f64);
    let step = REACH * sigma / beside;
    let own = (step / SPACING).min(0.9 * sigma);
    let rest = variance - own * own;
    let places = -(beside as i32)..=beside as i32;
    let density = |place: i32| {
        let at = f64::from(place) * step;
        (at, libm::exp(-0.5 * at * at / rest))
    };
    let (total, square) = places
        .clone()
        .map(density)
        .fold((0.0, 0.0), |(total, square), (at, weight)| (total + weight, square + weight * at * at));
    // Together they are as wide as the whole.
    let stretch = (rest * total / square).sqrt();
    let along = whole.covariance.column(YAW) / variance;
    let narrower: Covariance = along * along.transpose() * rest;
    for (at, weight) in places.map(density) {
        parts.push(Component {
            weight: whole.weight * weight / total,
            covariance: whole.covariance - narrower,
            ..whole.stepped(&(along * (at * stretch)))
        });
    }
}
