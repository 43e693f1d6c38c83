//! A normal distribution whose yaw is unsure -> several side by side that add up to it.
//!
//! Two spots leave a bent valley of distance against yaw; a Kalman update takes it for straight. Over a narrow stretch of yaw it is, so that updates see
//! narrow stretches only, and weigh them against each other (a Gaussian sum: D. L. Alspach, H. W. Sorenson, IEEE Trans. Autom. Control 17 (1972)).

use alloc::vec::Vec;

use super::component::{Component, Covariance};
#[cfg(not(feature = "std"))]
use crate::float::Float as _;

/// Over so wide a yaw, one standard deviation, rad, valleys are straight.
pub(super) const STRAIGHT_RAD: f64 = 0.06;
/// Most that one is split into.
const MOST_PARTS: usize = 13;
/// Parts are at most so far apart, in their own standard deviations, and reach so far, in those of the whole.
const SPACING: f64 = 1.5;
const REACH: f64 = 2.4;
/// The yaw in an error of the state.
const YAW: usize = 8;

/// Adds a distribution, in parts where its yaw is unsure.
pub(super) fn split(whole: &Component, parts: &mut Vec<Component>) {
    let variance = whole.covariance[(YAW, YAW)];
    let sigma = variance.sqrt();
    if sigma.is_nan() || sigma <= STRAIGHT_RAD {
        parts.push(*whole);
        return;
    }
    let beside = (REACH * sigma / (SPACING * STRAIGHT_RAD)).ceil().min((MOST_PARTS / 2) as f64);
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
