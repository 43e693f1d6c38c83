//! A predicted state and the spots said to be its markers -> the state with them, and how likely that was.
//!
//! The update of an error-state Kalman filter, iterated: down the sum of the prior's squared error and the measurement's cost, by Gauss and Newton; B. M.
//! Bell, F. W. Cathey, "The iterated Kalman filter update as a Gauss-Newton method", IEEE Trans. Autom. Control 38 (1993). The measurement brings its
//! robustness (Huber), markers that merge, and light. How likely it was is Laplace's integral around the summit, as for poses.

use super::component::{Component, Covariance, Step};
use crate::pose::{Measurement, Normal};

/// Most steps to a summit.
const MOST_STEPS: usize = 12;
/// A step that gains less than this, nats, is the last.
const SMALL_GAIN: f64 = 1e-6;
/// A step that does not gain is halved so often.
const HALVINGS: usize = 4;

/// A predicted state, as updates need it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Prior {
    pub(super) component: Component,
    information: Covariance,
    /// Logarithm of the determinant of the information.
    log_determinant: f64,
}

/// A state with a frame's spots.
#[derive(Clone, Copy, Debug)]
pub(super) struct Updated {
    pub(super) component: Component,
    /// Logarithm of the density of all the frame's observations.
    pub(super) log_evidence: f64,
    /// Logarithm of the light of an LED of intensity 1 at 1 m, where a spot has a light.
    pub(super) log_power: Option<f64>,
}

impl Prior {
    /// `None` where the matrix is not a covariance.
    pub(super) fn of(component: &Component) -> Option<Self> {
        let (information, log_determinant) = inverse(component.covariance)?;
        Some(Self { component: *component, information, log_determinant })
    }

    /// The state with a measurement, the nearest to `start`.
    pub(super) fn update(&self, measurement: &Measurement<'_>, start: &Component) -> Option<Updated> {
        let mut here = self.at(measurement, *start);
        for _ in 0..MOST_STEPS {
            let step = -here.information().cholesky()?.solve(&here.gradient());
            let gain = -here.gradient().dot(&step);
            if gain.is_nan() || gain < SMALL_GAIN {
                break;
            }
            let mut length = 1.0;
            let mut next = None;
            for _ in 0..HALVINGS {
                let there = self.at(measurement, here.state.stepped(&(step * length)));
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
        let unseen = measurement.visibility_nats(&here.state.pose, here.normal.log_power);
        let log_evidence = 0.5 * (self.log_determinant + log_determinant) - here.nats - unseen;
        if !log_evidence.is_finite() {
            return None;
        }
        let component = Component { covariance, ..here.state };
        Some(Updated { component, log_evidence, log_power: here.normal.log_power })
    }

    fn at(&self, measurement: &Measurement<'_>, state: Component) -> Here<'_> {
        let off = self.component.step_to(&state);
        let pull = self.information * off;
        let normal = measurement.at(&state.pose);
        Here { prior: self, state, nats: 0.5 * off.dot(&pull) + normal.nats, pull, normal }
    }
}

/// A state on the way to the summit.
#[derive(Clone, Copy)]
struct Here<'a> {
    prior: &'a Prior,
    state: Component,
    nats: f64,
    /// The gradient of the prior's part.
    pull: Step,
    normal: Normal,
}

impl Here<'_> {
    /// Of a step of a pose the first three are in distances.
    fn gradient(&self) -> Step {
        let per_m = 1.0 / self.state.pose.position_m.norm();
        let mut gradient = self.pull;
        for axis in 0..3 {
            gradient[axis] += self.normal.gradient[axis] * per_m;
            gradient[axis + 6] += self.normal.gradient[axis + 3];
        }
        gradient
    }

    fn information(&self) -> Covariance {
        let per_m = 1.0 / self.state.pose.position_m.norm();
        let scale = |axis: usize| if axis < 3 { per_m } else { 1.0 };
        let place = |axis: usize| if axis < 3 { axis } else { axis + 3 };
        let mut information = self.prior.information;
        for column in 0..6 {
            for line in 0..6 {
                information[(place(line), place(column))] +=
                    self.normal.information[(line, column)] * scale(line) * scale(column);
            }
        }
        information
    }
}

/// The inverse of a symmetric positive matrix, symmetric, and the logarithm of the determinant of the inverse.
fn inverse(matrix: Covariance) -> Option<(Covariance, f64)> {
    let factor = matrix.cholesky()?;
    let log_root: f64 = (0..9).map(|axis| libm::log(factor.l_dirty()[(axis, axis)])).sum();
    let inverse = factor.inverse();
    Some(((inverse + inverse.transpose()) * 0.5, -2.0 * log_root))
}
