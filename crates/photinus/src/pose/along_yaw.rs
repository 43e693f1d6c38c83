//! A mode -> normal distributions that stand for the posterior around it.
//!
//! Seen from afar the yaw is the least certain: two markers leave a bent valley of distance against yaw in which no single
//! normal distribution is honest. Many are: slices of the valley, each with the yaw held and everything else normal around
//! its best value. Their weights are the integrals over all but yaw (Laplace's method, as in nested integration). A mode whose
//! yaw is certain is one normal distribution in all six.

use alloc::vec::Vec;
use core::f64::consts::{PI, TAU};

use nalgebra::{Cholesky, Const, Matrix3, SMatrix, Vector3, Vector5};

use super::mixture::Component;
use super::problem::{Pose, Problem};
use super::refine::{Held, Refined};

/// Yaw surer than this needs no slices, rad.
const NARROW_RAD: f64 = 0.03;
/// Slices are at most this far apart, rad, ...
const WIDEST_STEP_RAD: f64 = 5.0 * PI / 180.0;
/// ... and this share of the yaw's sigma: sums over a normal distribution in such steps are exact to a part in 10^5.
const STEP_SIGMAS: f64 = 1.2;
/// Where a marker comes into sight or goes out of it by more than this from one slice to the next, nats, the slices are
/// halved, down to this much, rad.
const ABRUPT_NATS: f64 = 1.0;
const FINEST_STEP_RAD: f64 = 0.015;
/// A slice this much worse than the best, nats, is one of two that end the walk ...
const LITTLE_NATS: f64 = 5.0;
/// ... or of this many where one spot alone is seen: it may be any marker whose neighbours are out of sight.
const MOST_POOR_ALONE: usize = 16;
/// Most slices on one side.
const MOST_SLICES: usize = 36;

/// Most components of one mode.
pub(super) const MOST_COMPONENTS: usize = 2 * MOST_SLICES + 1;

/// Adds the components that stand for the posterior around a mode.
pub(super) fn spread(
    problem: &Problem<'_>,
    mode: &Refined,
    hypothesis: usize,
    components: &mut Vec<Component>,
) {
    let Some(held) = Held::of(*mode) else { return };
    let yaw_sigma_rad = held.yaw_sigma_rad();
    if yaw_sigma_rad < NARROW_RAD {
        components.extend(whole(problem, mode, hypothesis));
        return;
    }
    let mut step_rad = (STEP_SIGMAS * yaw_sigma_rad).min(WIDEST_STEP_RAD);
    while step_rad > FINEST_STEP_RAD && changes_abruptly(problem, &held, step_rad) {
        step_rad *= 0.5;
    }
    let middle = slice(problem, &held, hypothesis, 0.0, step_rad);
    components.push(middle);
    let most_poor = if problem.used().nth(1).is_some() { 2 } else { MOST_POOR_ALONE };
    for side in [step_rad, -step_rad] {
        // Each side has a summit of its own: a spot alone is likelier a marker at the edge of those that show.
        let (mut here, mut poor, mut best) = (held.clone(), 0, middle.log_weight);
        let mut bend = Vector5::zeros();
        for number in 1..=MOST_SLICES {
            let yaw_rad = side * number as f64;
            if yaw_rad.abs() > PI || poor == most_poor {
                break;
            }
            let Some(there) = here.turned(problem, side, &mut bend) else { break };
            let component = slice(problem, &there, hypothesis, yaw_rad, step_rad);
            best = best.max(component.log_weight);
            poor = if component.log_weight < best - LITTLE_NATS { poor + 1 } else { 0 };
            components.push(component);
            here = there;
        }
    }
}

/// Whether a marker comes into sight or goes out of it within a slice of the mode: by more than a normal distribution falls.
fn changes_abruptly(problem: &Problem<'_>, mode: &Held, step_rad: f64) -> bool {
    let nats = |pose: &Pose| problem.visibility_nats(pose, mode.at.normal.log_power);
    let here = nats(&mode.at.pose);
    [step_rad, -step_rad].into_iter().any(|side| (nats(&mode.following(side)) - here).abs() > ABRUPT_NATS)
}

/// A mode as one normal distribution.
fn whole(problem: &Problem<'_>, mode: &Refined, hypothesis: usize) -> Option<Component> {
    let Laplace { covariance, log_volume } = Laplace::of(&mode.normal.information.cholesky()?);
    let block = |row, column| covariance.fixed_view::<3, 3>(row, column).into_owned();
    let spread = Spread { delta: block(0, 0), turn: block(3, 3), both: block(0, 3) };
    Some(component(problem, mode, hypothesis, log_volume, &spread))
}

/// One slice of a valley, `step_rad` wide.
fn slice(problem: &Problem<'_>, held: &Held, hypothesis: usize, yaw_rad: f64, step_rad: f64) -> Component {
    let Laplace { covariance, log_volume } = Laplace::of(&held.rest);
    let mut turn = Matrix3::from_diagonal(&Vector3::new(0.0, 0.0, step_rad * step_rad / 12.0));
    turn.fixed_view_mut::<2, 2>(0, 0).copy_from(&covariance.fixed_view::<2, 2>(3, 3));
    let log_volume = log_volume + libm::log(step_rad);
    let mut both = Matrix3::zeros();
    both.fixed_view_mut::<3, 2>(0, 0).copy_from(&covariance.fixed_view::<3, 2>(0, 3));
    let spread = Spread { delta: covariance.fixed_view::<3, 3>(0, 0).into_owned(), turn, both };
    Component { yaw_rad, ..component(problem, &held.at, hypothesis, log_volume, &spread) }
}

/// The normal distribution around a minimum of the cost.
struct Laplace<const D: usize> {
    covariance: SMatrix<f64, D, D>,
    /// Logarithm of its integral for a density of 1 at the minimum.
    log_volume: f64,
}

impl<const D: usize> Laplace<D> {
    /// From the information there, factored.
    fn of(factor: &Cholesky<f64, Const<D>>) -> Self {
        let log_root: f64 = (0..D).map(|axis| libm::log(factor.l_dirty()[(axis, axis)])).sum();
        let log_volume = 0.5 * D as f64 * libm::log(TAU) - log_root;
        Self { covariance: factor.inverse(), log_volume }
    }
}

/// How wide a component is.
struct Spread {
    /// Covariance of the position, in distances.
    delta: Matrix3<f64>,
    /// Of the attitude, rad^2.
    turn: Matrix3<f64>,
    /// Of the position (rows) with the attitude (columns).
    both: Matrix3<f64>,
}

/// A component at a pose.
fn component(
    problem: &Problem<'_>,
    at: &Refined,
    hypothesis: usize,
    log_volume: f64,
    spread: &Spread,
) -> Component {
    Component {
        log_weight: log_volume - at.normal.nats - problem.visibility_nats(&at.pose, at.normal.log_power),
        pose: at.pose,
        position_covariance_m2: spread.delta * at.pose.position_m.norm_squared(),
        orientation_covariance_rad2: spread.turn,
        position_orientation_covariance_m_rad: spread.both * at.pose.position_m.norm(),
        hypothesis,
        yaw_rad: 0.0,
    }
}
