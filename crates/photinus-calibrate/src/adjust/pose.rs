//! One photo alone: its cost, and its pose with the lens and the board as they are.

use nalgebra::{Isometry3, Matrix6, Vector3, Vector6};
use photinus::solve::{Descent, descend, step};

use super::step::moved_pose;
use super::{Loss, View};
use crate::lens::Lens;

const MOST_STEPS: u32 = 40;

/// What one view costs; `None` where a point has no image.
pub(crate) fn pose_cost(
    lens: &Lens,
    board_m: &[Vector3<f64>],
    view: &View,
    pose: &Isometry3<f64>,
    loss: Loss,
) -> Option<f64> {
    let rotation = pose.rotation.to_rotation_matrix();
    let mut cost = 0.0;
    for seen in &view.observations {
        let point = rotation * board_m[seen.led] + pose.translation.vector;
        cost += loss.cost_and_weight((seen.pixel - lens.pixel(&point)?).norm_squared()).0;
    }
    cost.is_finite().then_some(cost)
}

/// The pose near `first` that costs least, and what it costs; `None` when `first` cannot be evaluated.
pub(crate) fn fit_pose(
    lens: &Lens,
    board_m: &[Vector3<f64>],
    view: &View,
    first: &Isometry3<f64>,
    loss: Loss,
) -> Option<(Isometry3<f64>, f64)> {
    descend(&Photo { lens, board_m, view, loss }, *first, MOST_STEPS)
}

/// One photo, with the lens and the board as they are.
struct Photo<'a> {
    lens: &'a Lens,
    board_m: &'a [Vector3<f64>],
    view: &'a View,
    loss: Loss,
}

impl Descent for Photo<'_> {
    type Place = Isometry3<f64>;
    type Normal = (Matrix6<f64>, Vector6<f64>);

    fn cost(&self, pose: &Isometry3<f64>) -> Option<f64> {
        pose_cost(self.lens, self.board_m, self.view, pose, self.loss)
    }

    fn normal(&self, pose: &Isometry3<f64>) -> Option<Self::Normal> {
        normal(self.lens, self.board_m, self.view, pose, self.loss)
    }

    fn stepped(
        &self,
        pose: &Isometry3<f64>,
        (normal, downhill): &Self::Normal,
        damping: f64,
    ) -> Option<Isometry3<f64>> {
        step(normal, downhill, damping).map(|step| moved_pose(pose, &step))
    }
}

fn normal(
    lens: &Lens,
    board_m: &[Vector3<f64>],
    view: &View,
    pose: &Isometry3<f64>,
    loss: Loss,
) -> Option<(Matrix6<f64>, Vector6<f64>)> {
    let rotation = pose.rotation.to_rotation_matrix();
    let (mut matrix, mut gradient) = (Matrix6::zeros(), Vector6::zeros());
    for seen in &view.observations {
        let turned = rotation * board_m[seen.led];
        let projection = lens.project(&(turned + pose.translation.vector))?;
        let residual = seen.pixel - projection.pixel;
        let weight = loss.cost_and_weight(residual.norm_squared()).1;
        let by_turn = -projection.by_point * turned.cross_matrix();
        for i in 0..6 {
            let column = |k: usize| {
                if k < 3 {
                    by_turn.column(k).into_owned()
                } else {
                    projection.by_point.column(k - 3).into_owned()
                }
            };
            let own = column(i) * weight;
            gradient[i] += own.dot(&residual);
            for j in 0..6 {
                matrix[(i, j)] += own.dot(&column(j));
            }
        }
    }
    Some((matrix, gradient))
}
