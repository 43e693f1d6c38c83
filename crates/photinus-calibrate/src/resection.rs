//! The pose of a camera from what it sees of what is known in the body frame: Levenberg-Marquardt on bearings.

use nalgebra::{Matrix2x6, Matrix3, Matrix6, Unit, UnitQuaternion, Vector2, Vector3, Vector6};

use crate::robust::Loss;
use crate::sighted::Sighted;

/// What is known of something seen, in the body frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Known {
    /// The direction to it: it is far away.
    Direction(Unit<Vector3<f64>>),
    /// Where it is, m.
    Position(Vector3<f64>),
}

/// Something seen, of which something is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Observation {
    /// Where it is seen.
    pub sighted: Sighted,
    /// What is known of it.
    pub known: Known,
}

/// Where a camera is and how it is turned.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Pose {
    pub(crate) body_from_camera: UnitQuaternion<f64>,
    /// The camera's centre in the body frame.
    pub(crate) centre_m: Vector3<f64>,
}

/// What of a pose is not known beforehand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Free {
    Rotation,
    RotationAndCentre,
}

/// A pose that fits, its cost, and the information in (turn about the body's axes, centre): of residuals in sigmas.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Refined {
    pub(crate) pose: Pose,
    pub(crate) cost: f64,
    pub(crate) information: Matrix6<f64>,
}

const PASSES: usize = 40;

impl Pose {
    /// From what was seen to what this pose predicts, in sigmas along the image's axes, with the derivative by (turn about the
    /// body's axes, centre). `None` for something in the camera's centre.
    pub(crate) fn residual(&self, observation: &Observation) -> Option<(Vector2<f64>, Matrix2x6<f64>)> {
        let camera_from_body = self.body_from_camera.to_rotation_matrix().inverse();
        let (from_centre, moves) = match observation.known {
            Known::Direction(direction) => (direction.into_inner(), Matrix3::zeros()),
            Known::Position(position_m) => (position_m - self.centre_m, -camera_from_body.matrix()),
        };
        let (residual, by_point) = observation.sighted.residual(&(camera_from_body * from_centre))?;
        let mut jacobian = Matrix2x6::zeros();
        let turns = camera_from_body.matrix() * from_centre.cross_matrix();
        jacobian.fixed_columns_mut::<3>(0).copy_from(&(by_point * turns));
        jacobian.fixed_columns_mut::<3>(3).copy_from(&(by_point * moves));
        Some((residual, jacobian))
    }

    /// This pose after a turn about the body's axes and a move.
    pub(crate) fn moved(&self, step: &Vector6<f64>) -> Self {
        let turn = UnitQuaternion::from_scaled_axis(Vector3::new(step[0], step[1], step[2]));
        Self {
            body_from_camera: turn * self.body_from_camera,
            centre_m: self.centre_m + Vector3::new(step[3], step[4], step[5]),
        }
    }
}

/// The pose of least cost near `start`; `None` when something is seen in the camera's centre.
pub(crate) fn refine(observations: &[Observation], start: Pose, free: Free, loss: Loss) -> Option<Refined> {
    let mut pose = start;
    let (mut cost, mut information, mut gradient) = equations(observations, &pose, free, loss)?;
    let mut damping = 1e-3;
    for _ in 0..PASSES {
        let damped = information + Matrix6::from_diagonal(&(information.diagonal() * damping));
        let Some(factors) = damped.cholesky() else { break };
        let step = factors.solve(&-gradient);
        let next = pose.moved(&step);
        match equations(observations, &next, free, loss) {
            Some(after) if after.0 < cost => {
                let gain = cost - after.0;
                pose = next;
                (cost, information, gradient) = after;
                damping = f64::max(damping * 0.2, 1e-12);
                if gain < 1e-10 * cost {
                    break;
                }
            }
            _ if damping > 1e9 => break,
            _ => damping *= 6.0,
        }
    }
    Some(Refined { pose, cost, information })
}

/// Cost, information and gradient at a pose.
fn equations(
    observations: &[Observation],
    pose: &Pose,
    free: Free,
    loss: Loss,
) -> Option<(f64, Matrix6<f64>, Vector6<f64>)> {
    let (mut cost, mut information, mut gradient) = (0.0, Matrix6::zeros(), Vector6::zeros());
    for observation in observations {
        let (residual, jacobian) = pose.residual(observation)?;
        let (share, weight) = loss.cost_and_weight(residual.norm_squared());
        cost += share;
        information += jacobian.transpose() * jacobian * weight;
        gradient += jacobian.transpose() * residual * weight;
    }
    if free == Free::Rotation {
        for axis in 3..6 {
            information.row_mut(axis).fill(0.0);
            information.column_mut(axis).fill(0.0);
            information[(axis, axis)] = 1.0;
            gradient[axis] = 0.0;
        }
    }
    cost.is_finite().then_some((cost, information, gradient))
}
