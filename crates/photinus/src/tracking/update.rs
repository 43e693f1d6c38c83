//! A predicted state and the spots said to be its markers -> the state with them, and how likely that was.
//!
//! The update of an error-state Kalman filter, iterated: down the sum of the prior's squared error and the measurement's cost, by Gauss and Newton; B. M.
//! Bell, F. W. Cathey, "The iterated Kalman filter update as a Gauss-Newton method", IEEE Trans. Autom. Control 38 (1993). The measurement brings its
//! robustness (Huber), markers that merge, and light. How likely it was is Laplace's integral around the summit, as for poses. No spot tells how fast the
//! pose changes: the search is over the pose alone, and its rates follow from what the prediction says about both.

use nalgebra::{Matrix4x6, Matrix6};

use super::component::{Component, Covariance, POSE, PoseStep, RATES, pose_after, pose_step};
use crate::pose::{Measurement, Normal, Pose};

/// Most steps to a summit.
const MOST_STEPS: usize = 12;
/// A step that gains less than this, nats, is the last.
const SMALL_GAIN: f64 = 1e-4;
/// A step that does not gain is halved so often.
const HALVINGS: usize = 4;

/// A predicted state, as updates need it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Prior {
    pub(super) component: Component,
    /// Of the pose.
    information: Matrix6<f64>,
    /// Logarithm of the determinant of the information.
    log_determinant: f64,
    /// What an error of the pose says of those of its rates.
    rates_by_pose: Matrix4x6<f64>,
}

/// A state with a frame's spots.
#[derive(Clone, Copy, Debug)]
pub(super) struct Updated {
    pub(super) component: Component,
    /// Logarithm of the density of all the frame's observations.
    pub(super) log_evidence: f64,
    /// What of it is for how wide the prediction is: the narrower, the more.
    pub(super) log_spread: f64,
    /// Logarithm of the light of an LED of intensity 1 at 1 m, where a spot has a light.
    pub(super) log_power: Option<f64>,
}

impl Prior {
    /// `None` where the matrix is not a covariance.
    pub(super) fn of(component: &Component) -> Option<Self> {
        let (information, log_determinant) = inverse(component.pose_covariance())?;
        let (_, with_pose) = component.rates_covariances();
        let rates_by_pose = with_pose * information;
        Some(Self { component: *component, information, log_determinant, rates_by_pose })
    }

    /// The state with a measurement, the nearest to `start`; `None` also where it counts for nothing with certainty, which is asked of the most that the evidence can
    /// be: of what the width of the prediction gives, and of the rest.
    pub(super) fn update(
        &self,
        measurement: &Measurement<'_>,
        start: &Pose,
        is_nothing: impl Fn(f64, f64) -> bool,
    ) -> Option<Updated> {
        let mut here = self.at(measurement, *start);
        for _ in 0..MOST_STEPS {
            let factor = here.information().cholesky()?;
            let step = -factor.solve(&here.gradient());
            let gain = -here.gradient().dot(&step);
            if gain.is_nan() || gain < SMALL_GAIN {
                break;
            }
            // The summit is about half of `gain` away, or all of it along Huber's lines; markers that are not seen add no evidence.
            let log_spread = 0.5 * self.log_determinant - log_root(factor.l_dirty());
            if is_nothing(log_spread, gain - here.nats) {
                return None;
            }
            let mut length = 1.0;
            let mut next = None;
            for _ in 0..HALVINGS {
                let there = self.at(measurement, pose_after(&here.pose, &(step * length)));
                if there.nats < here.nats {
                    next = Some(there);
                    break;
                }
                length *= 0.5;
            }
            match next {
                Some(there) => here = there,
                None => break,
            }
        }
        let (covariance, log_determinant) = inverse(here.information())?;
        let mut silent = self.component.silent;
        let unseen = measurement.visibility(&here.pose, here.normal.log_power, |marker, unseen| {
            silent.learn(marker, unseen);
        });
        let log_spread = 0.5 * (self.log_determinant + log_determinant);
        let log_evidence = log_spread - here.nats - unseen;
        if !log_evidence.is_finite() || is_nothing(log_spread, -here.nats - unseen) {
            return None;
        }
        let component = Component { silent, ..self.with(&here, &covariance) };
        Some(Updated { component, log_evidence, log_spread, log_power: here.normal.log_power })
    }

    fn at(&self, measurement: &Measurement<'_>, pose: Pose) -> Here<'_> {
        let off = pose_step(&self.component.pose, &pose);
        let pull = self.information * off;
        let normal = measurement.at(&pose);
        Here { prior: self, pose, nats: 0.5 * off.dot(&pull) + normal.nats, pull, normal }
    }

    /// The state whose pose is told with this covariance.
    fn with(&self, here: &Here<'_>, covariance: &Matrix6<f64>) -> Component {
        let by_pose = &self.rates_by_pose;
        let off = pose_step(&self.component.pose, &here.pose);
        let crossed = by_pose * covariance;
        let (of_rates, with_pose) = self.component.rates_covariances();
        let rates = of_rates - by_pose * with_pose.transpose() + crossed * by_pose.transpose();
        let rates = (rates + rates.transpose()) * 0.5;
        let mut whole = Covariance::zeros();
        for (line, to_line) in POSE.into_iter().enumerate() {
            for (column, to_column) in POSE.into_iter().enumerate() {
                whole[(to_line, to_column)] = covariance[(line, column)];
            }
            for (rate, to_rate) in RATES.into_iter().enumerate() {
                whole[(to_rate, to_line)] = crossed[(rate, line)];
                whole[(to_line, to_rate)] = crossed[(rate, line)];
            }
        }
        for (line, to_line) in RATES.into_iter().enumerate() {
            for (column, to_column) in RATES.into_iter().enumerate() {
                whole[(to_line, to_column)] = rates[(line, column)];
            }
        }
        Component { pose: here.pose, covariance: whole, ..self.component.with_rates_off(&(by_pose * off)) }
    }
}

/// A pose on the way to the summit.
#[derive(Clone, Copy)]
struct Here<'a> {
    prior: &'a Prior,
    pose: Pose,
    nats: f64,
    /// The gradient of the prior's part.
    pull: PoseStep,
    normal: Normal,
}

impl Here<'_> {
    /// Of a step of a pose the first three are in distances.
    fn gradient(&self) -> PoseStep {
        let per_m = 1.0 / self.pose.position_m.norm();
        let mut gradient = self.pull + self.normal.gradient;
        for axis in 0..3 {
            gradient[axis] = self.pull[axis] + self.normal.gradient[axis] * per_m;
        }
        gradient
    }

    fn information(&self) -> Matrix6<f64> {
        let per_m = 1.0 / self.pose.position_m.norm();
        let scale = |axis: usize| if axis < 3 { per_m } else { 1.0 };
        Matrix6::from_fn(|line, column| {
            let own = self.normal.information[(line, column)] * scale(line) * scale(column);
            self.prior.information[(line, column)] + own
        })
    }
}

/// The inverse of a symmetric positive matrix, symmetric, and the logarithm of the determinant of the inverse.
fn inverse(matrix: Matrix6<f64>) -> Option<(Matrix6<f64>, f64)> {
    let factor = matrix.cholesky()?;
    let inverse = factor.inverse();
    Some(((inverse + inverse.transpose()) * 0.5, -2.0 * log_root(factor.l_dirty())))
}

/// Half the logarithm of the determinant of a matrix, by its Cholesky factor.
fn log_root(factor: &Matrix6<f64>) -> f64 {
    (0..6).map(|axis| libm::log(factor[(axis, axis)])).sum()
}
