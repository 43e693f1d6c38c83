//! Normal distributions with weights -> what is told: modes, mean and covariance, distance, all within the strict bounds.

use alloc::vec::Vec;

use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};

use super::problem::Pose;
#[cfg(not(feature = "std"))]
use crate::float::Float as _;
use crate::normal;
use crate::ranging::{Estimate, Interval};

/// Most slices that one mode stands for: their valley is straight over so short a stretch.
const SLICES_PER_MODE: usize = 3;
/// A component is at most this many sigma beyond the bounds.
const FARTHEST_SIGMAS: f64 = 2.0;
/// Modes with less weight are not told.
const NEGLIGIBLE: f64 = 1e-3;

/// A part of the posterior, normal.
#[derive(Clone, Copy, Debug)]
pub(super) struct Component {
    pub(super) log_weight: f64,
    pub(super) pose: Pose,
    pub(super) position_covariance_m2: Matrix3<f64>,
    /// Of a rotation in the body frame.
    pub(super) orientation_covariance_rad2: Matrix3<f64>,
    /// Of the position (rows) with that rotation (columns).
    pub(super) position_orientation_covariance_m_rad: Matrix3<f64>,
    pub(super) hypothesis: usize,
    /// From the mode that it belongs to.
    pub(super) yaw_rad: f64,
}

/// One way in which the spots can be this airframe.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mode {
    /// Its share of the posterior, 0 to 1.
    pub weight: f64,
    /// Where and how turned.
    pub pose: Pose,
    /// Covariance of the position, camera frame, m^2.
    pub position_covariance_m2: Matrix3<f64>,
    /// Covariance of the attitude as a small rotation in the body frame, rad^2.
    pub orientation_covariance_rad2: Matrix3<f64>,
    /// Covariance of the position (rows) with that rotation (columns), m rad.
    pub position_orientation_covariance_m_rad: Matrix3<f64>,
}

/// The whole posterior in a few numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Summary {
    /// Mean position; mean attitude, yaw modulo the airframe's symmetry.
    pub pose: Pose,
    /// Covariance of the position, over all modes, camera frame, m^2.
    pub position_covariance_m2: Matrix3<f64>,
    /// Covariance of the attitude as a small rotation in the body frame, rad^2, yaw modulo the airframe's symmetry.
    pub orientation_covariance_rad2: Matrix3<f64>,
    /// Covariance of the position (rows) with that rotation (columns), over all modes, m rad.
    pub position_orientation_covariance_m_rad: Matrix3<f64>,
    /// Mean and standard deviation of distance.
    pub distance: Estimate,
}

/// Cuts each component off at the bounds on distance: truth is never beyond. What is left of each is taken as normal again.
///
/// A component that is wholly beyond contradicts the bounds, and is no surer than they are: it is widened until it reaches
/// them, at the weight that it had.
pub(super) fn truncate(components: &mut [Component], bounds: &Interval) {
    for component in components {
        let distance_m = component.pose.position_m.norm();
        let ahead = component.pose.position_m / distance_m;
        let covariance = &component.position_covariance_m2;
        let along = covariance * ahead;
        let variance_m2 = ahead.dot(&along);
        let sigma_m = variance_m2.sqrt().max(1e-9);
        let low = (bounds.min_m() - distance_m) / sigma_m;
        let high = (bounds.max_m() - distance_m) / sigma_m;
        if low < -5.0 && high > 5.0 {
            continue;
        }
        component.log_weight += truncated(low, high).log_mass;
        let widening = (low.max(-high) / FARTHEST_SIGMAS).max(1.0);
        component.position_covariance_m2 *= widening * widening;
        component.position_orientation_covariance_m_rad *= widening;
        let (sigma_m, variance_m2, along) =
            (sigma_m * widening, variance_m2 * widening * widening, along * (widening * widening));
        let Truncated { shift, variance, .. } = truncated(low / widening, high / widening);
        // The other directions follow the distance as far as they are correlated with it.
        let gain = along / variance_m2.max(1e-18);
        component.pose.position_m += gain * (shift * sigma_m);
        component.position_covariance_m2 -= gain * gain.transpose() * (variance_m2 * (1.0 - variance));
        // The attitude stays as wide as it was, so that the whole stays a covariance.
        let turned = ahead.transpose() * component.position_orientation_covariance_m_rad;
        component.position_orientation_covariance_m_rad -= gain * turned * (1.0 - variance);
    }
}

/// What is left of a standard normal distribution between two limits.
struct Truncated {
    log_mass: f64,
    shift: f64,
    variance: f64,
}

fn truncated(low: f64, high: f64) -> Truncated {
    // Far in a tail the rest is close to exponential, at the nearer limit.
    if low > 5.0 {
        return Truncated {
            log_mass: -0.5 * low * low - libm::log(low),
            shift: (low + 1.0 / low).min(high),
            variance: (1.0 / (low * low)).min((high - low) * (high - low)),
        };
    }
    if high < -5.0 {
        let Truncated { log_mass, shift, variance } = truncated(-high, -low);
        return Truncated { log_mass, shift: -shift, variance };
    }
    let density = |x: f64| if x.is_finite() { normal::density(x, 1.0) } else { 0.0 };
    let moment = |x: f64| if x.is_finite() { x * density(x) } else { 0.0 };
    let mass = (normal::below(high) - normal::below(low)).max(1e-12);
    let shift = ((density(low) - density(high)) / mass).clamp(low, high);
    let variance = (1.0 + (moment(low) - moment(high)) / mass - shift * shift).clamp(1e-6, 1.0);
    Truncated { log_mass: libm::log(mass), shift, variance }
}

/// How many sigma the heaviest component is beyond the bounds on distance; 0 within.
pub(super) fn beyond_sigmas(components: &[Component], bounds: &Interval) -> f64 {
    let heaviest = components.iter().max_by(|a, b| a.log_weight.total_cmp(&b.log_weight));
    heaviest.map_or(0.0, |component| {
        let distance_m = component.pose.position_m.norm();
        let ahead = component.pose.position_m / distance_m;
        let sigma_m = ahead.dot(&(component.position_covariance_m2 * ahead)).sqrt().max(1e-9);
        (bounds.min_m() - distance_m).max(distance_m - bounds.max_m()).max(0.0) / sigma_m
    })
}

/// Scales weights so that they add up to 1; `false` when there is no weight.
pub(super) fn normalise(components: &mut [Component]) -> bool {
    let best = components.iter().map(|component| component.log_weight).fold(f64::NEG_INFINITY, f64::max);
    if !best.is_finite() {
        return false;
    }
    let total: f64 = components.iter().map(|component| libm::exp(component.log_weight - best)).sum();
    let log_total = best + libm::log(total);
    for component in components.iter_mut() {
        component.log_weight -= log_total;
    }
    true
}

/// The logarithm of the sum of all weights.
pub(super) fn log_evidence(components: &[Component]) -> f64 {
    let best = components.iter().map(|component| component.log_weight).fold(f64::NEG_INFINITY, f64::max);
    if !best.is_finite() {
        return f64::NEG_INFINITY;
    }
    let total: f64 = components.iter().map(|component| libm::exp(component.log_weight - best)).sum();
    best + libm::log(total)
}

/// The mean and covariance of normalised components. `turns` is how many turns about the body's z axis leave it the same.
pub(super) fn summarise(components: &[Component], turns: usize) -> Option<Summary> {
    let heaviest = components.iter().max_by(|a, b| a.log_weight.total_cmp(&b.log_weight))?;
    Some(moments(components, &heaviest.pose.camera_from_body, turns))
}

/// Puts neighbouring slices together into modes, the heaviest first.
pub(super) fn modes(components: &mut [Component], turns: usize, modes: &mut Vec<Mode>) {
    modes.clear();
    components.sort_unstable_by(|a, b| a.hypothesis.cmp(&b.hypothesis).then(a.yaw_rad.total_cmp(&b.yaw_rad)));
    for hypothesis in components.chunk_by(|a, b| a.hypothesis == b.hypothesis) {
        for slices in hypothesis.chunks(SLICES_PER_MODE) {
            let weight: f64 = slices.iter().map(|slice| libm::exp(slice.log_weight)).sum();
            if weight < NEGLIGIBLE {
                continue;
            }
            let Some(told) = summarise(slices, turns) else { continue };
            modes.push(Mode {
                weight,
                pose: told.pose,
                position_covariance_m2: told.position_covariance_m2,
                orientation_covariance_rad2: told.orientation_covariance_rad2,
                position_orientation_covariance_m_rad: told.position_orientation_covariance_m_rad,
            });
        }
    }
    modes.sort_unstable_by(|a, b| b.weight.total_cmp(&a.weight));
    let total: f64 = modes.iter().map(|mode| mode.weight).sum();
    for mode in modes {
        mode.weight /= total;
    }
}

fn moments(components: &[Component], reference: &Rotation3<f64>, turns: usize) -> Summary {
    let mut total = 0.0;
    let (mut first_m, mut second_m2) = (Vector3::zeros(), Matrix3::zeros());
    let (mut turn, mut turn2) = (Vector3::zeros(), Matrix3::zeros());
    let mut both_m_rad = Matrix3::zeros();
    let (mut distance_m, mut distance2_m2) = (0.0, 0.0);
    for component in components {
        let weight = libm::exp(component.log_weight);
        let position_m = component.pose.position_m;
        let away_m = position_m.norm();
        // Bounds of 0 leave a component no direction.
        let ahead = position_m.try_normalize(0.0).unwrap_or_default();
        let covariance = component.position_covariance_m2;
        total += weight;
        first_m += weight * position_m;
        second_m2 += weight * (covariance + position_m * position_m.transpose());
        distance_m += weight * away_m;
        distance2_m2 += weight * (ahead.dot(&(covariance * ahead)) + away_m * away_m);
        let Nearest { off, symmetric } = nearest_turn(reference, &component.pose.camera_from_body, turns);
        let turned = symmetric.map_or(*component, |symmetric| component.turned(&symmetric));
        turn += weight * off;
        turn2 += weight * (turned.orientation_covariance_rad2 + off * off.transpose());
        both_m_rad += weight * (turned.position_orientation_covariance_m_rad + position_m * off.transpose());
    }
    let (mean_m, turn) = (first_m / total, turn / total);
    let distance_m = distance_m / total;
    Summary {
        pose: Pose { position_m: mean_m, camera_from_body: reference * Rotation3::new(turn) },
        position_covariance_m2: second_m2 / total - mean_m * mean_m.transpose(),
        orientation_covariance_rad2: turn2 / total - turn * turn.transpose(),
        position_orientation_covariance_m_rad: both_m_rad / total - mean_m * turn.transpose(),
        distance: Estimate {
            distance_m,
            sigma_m: (distance2_m2 / total - distance_m * distance_m).max(0.0).sqrt(),
        },
    }
}

/// From one attitude to another, where turns about the body's z axis count for nothing.
struct Nearest {
    /// What is left of the rotation, in the body frame: its yaw is the least that symmetry allows.
    off: Vector3<f64>,
    /// The turn of the symmetry that is taken off, where one is.
    symmetric: Option<Rotation3<f64>>,
}

fn nearest_turn(from: &Rotation3<f64>, to: &Rotation3<f64>, turns: usize) -> Nearest {
    let between = from.inverse() * to;
    let sector_rad = core::f64::consts::TAU / turns as f64;
    let matrix = between.matrix();
    let yaw_rad = libm::atan2(matrix.m21 - matrix.m12, matrix.m11 + matrix.m22);
    let sectors = (yaw_rad / sector_rad).round();
    if turns == 1 || sectors == 0.0 {
        return Nearest { off: turn_of(&between), symmetric: None };
    }
    let symmetric = Rotation3::from_axis_angle(&Vector3::z_axis(), -sectors * sector_rad);
    Nearest { off: turn_of(&(between * symmetric)), symmetric: Some(symmetric) }
}

impl Component {
    /// The same with a turn of its airframe's symmetry: its covariances are along the axes of the body, which turn.
    pub(super) fn turned(&self, symmetric: &Rotation3<f64>) -> Self {
        let axes = symmetric.matrix();
        Self {
            pose: Pose { camera_from_body: self.pose.camera_from_body * symmetric, ..self.pose },
            orientation_covariance_rad2: axes.transpose() * self.orientation_covariance_rad2 * axes,
            position_orientation_covariance_m_rad: self.position_orientation_covariance_m_rad * axes,
            ..*self
        }
    }
}

/// Axis times angle; by the quaternion, since the arc cosine of a matrix's trace is no number where rounding takes it past 1.
pub(crate) fn turn_of(rotation: &Rotation3<f64>) -> Vector3<f64> {
    UnitQuaternion::from_rotation_matrix(rotation).scaled_axis()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn attitudes_half_a_turn_apart_have_a_rotation_between_them() {
        for tilt in [0.0, 1e-12, 1e-9, 0.01, 0.3] {
            let from = Rotation3::new(Vector3::new(0.3, -0.9, 1.0 + tilt));
            for yaw_rad in [0.0, 1e-9, core::f64::consts::PI, core::f64::consts::PI - 1e-9] {
                let to = from * Rotation3::from_axis_angle(&Vector3::z_axis(), yaw_rad);
                let off = nearest_turn(&from, &to, 1).off;
                assert!((off.norm() - yaw_rad).abs() < 1e-7, "{yaw_rad}: {off}");
                assert!(
                    nearest_turn(&from, &to, 2).off.norm()
                        < 1e-7 + yaw_rad.min(core::f64::consts::PI - yaw_rad)
                );
            }
        }
    }
}
