//! Two constellations without names -> the ways in which they can be one: which sight of A is B, and which sight of B is A.

use nalgebra::{Matrix3, Vector3};

use super::assignment::assign;
use super::group::{Pose, azimuth_rad};
use super::{Report, Sight};
use crate::Normal;

/// What a sight that has no counterpart costs: as much as one that is off by four and a half sigmas.
const LONELY: f64 = 20.0;
/// Two views of one line that differ by more, in squared sigmas, are not of one line.
const GATE: f64 = 30.0;

/// One way in which B's report agrees with A's.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Hypothesis {
    /// Which of A's sights B is.
    pub(super) sight: usize,
    /// For each of B's sights, which of A's sights it is; `None` where none of them, or A itself.
    pub(super) matches: Vec<Option<usize>>,
    /// Which of B's sights A is.
    pub(super) back: usize,
    pub(super) cost: f64,
}

/// All ways in which `other` agrees with `own`, the best first.
pub(super) fn hypotheses(own: &Report, other: &Report) -> Vec<Hypothesis> {
    let names = |sight: &Sight, id: u32| sight.identity.is_none_or(|identity| identity == id);
    let mut all = Vec::new();
    for (s, sight) in own.sights.iter().enumerate().filter(|(_, sight)| names(sight, other.from)) {
        for (t, back) in other.sights.iter().enumerate().filter(|(_, back)| names(back, own.from)) {
            all.extend(hypothesis(own, other, (s, &sight.position_m), (t, &back.position_m)));
        }
    }
    all.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    all
}

fn hypothesis(
    own: &Report,
    other: &Report,
    (s, there): (usize, &Normal),
    (t, back): (usize, &Normal),
) -> Option<Hypothesis> {
    // B looks back along the line on which A sees it.
    let heading_rad = azimuth_rad(&-there.mean) - azimuth_rad(&back.mean);
    let pose = Pose { place: there.mean, heading_rad };
    let turned = |normal: &Normal| turn(&pose, normal);
    let returned = turned(back);
    let closing = off(&(there.mean + returned.mean), &(there.covariance + returned.covariance))?;
    if closing > GATE {
        return None;
    }
    let heading_variance = across_variance(there) + across_variance(back);
    let rest_own: Vec<usize> = (0..own.sights.len()).filter(|k| *k != s).collect();
    let rest_other: Vec<usize> = (0..other.sights.len()).filter(|k| *k != t).collect();
    let pair = |a: usize, b: usize| -> f64 {
        let (mine, its) = (&own.sights[rest_own[a]], &other.sights[rest_other[b]]);
        if mine.identity.is_some() && its.identity.is_some() && mine.identity != its.identity {
            return f64::INFINITY;
        }
        let its = turned(&its.position_m);
        let across = Vector3::z().cross(&its.mean);
        let covariance = mine.position_m.covariance
            + there.covariance
            + its.covariance
            + across * across.transpose() * heading_variance;
        off(&(mine.position_m.mean - there.mean - its.mean), &covariance).unwrap_or(f64::INFINITY)
    };
    // Each may stay alone: a square table with a place for that.
    let (mine, its) = (rest_own.len(), rest_other.len());
    let table: Vec<f64> =
        (0..mine).flat_map(|a| (0..its).map(move |b| (a, b))).map(|(a, b)| pair(a, b)).collect();
    let cost = |a: usize, b: usize| match (a < mine, b < its) {
        (true, true) => table[a * its + b].min(3.0 * LONELY),
        (false, false) => 0.0,
        _ => LONELY,
    };
    let (columns, total) = assign(mine + its, cost);
    let mut matches = vec![None; other.sights.len()];
    for (a, b) in columns.iter().enumerate().take(mine).filter(|(_, b)| **b < its) {
        matches[rest_other[*b]] = Some(rest_own[a]);
    }
    Some(Hypothesis { sight: s, matches, back: t, cost: closing + total })
}

fn turn(pose: &Pose, normal: &Normal) -> Normal {
    let turn = nalgebra::Rotation3::from_axis_angle(&Vector3::z_axis(), pose.heading_rad).into_inner();
    Normal { mean: turn * normal.mean, covariance: turn * normal.covariance * turn.transpose() }
}

/// Squared distance in sigmas.
fn off(difference: &Vector3<f64>, covariance: &Matrix3<f64>) -> Option<f64> {
    Some(difference.dot(&(covariance.cholesky()?.inverse() * difference)))
}

/// How unsure the azimuth of a sight is, rad^2.
fn across_variance(normal: &Normal) -> f64 {
    let (x, y) = (normal.mean.x, normal.mean.y);
    let level2 = (x * x + y * y).max(1e-9);
    let across = Vector3::new(-y, x, 0.0);
    across.dot(&(normal.covariance * across)) / (level2 * level2)
}
