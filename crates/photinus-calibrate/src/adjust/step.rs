//! Levenberg and Marquardt's way down.

use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3, Vector6};

use super::cholesky::Cholesky;
use super::normal::Normal;
use super::{Adjusted, Scene, Task};
use crate::lens::MOST_PARAMETERS;

/// A step that lowers the cost by less than this share is the last one.
const SMALL_GAIN: f64 = 1e-9;

pub(super) fn descend(task: &Task<'_>, first: &Scene) -> Option<Adjusted> {
    let mut scene = first.clone();
    let mut cost = task.cost(&scene)?;
    let mut damping = 1e-3;
    for _ in 0..task.most_steps {
        let normal = Normal::of(task, &scene)?;
        let Some((next, next_cost)) = better(task, &normal, &scene, cost, &mut damping) else { break };
        let gain = cost - next_cost;
        (scene, cost) = (next, next_cost);
        if gain <= SMALL_GAIN * cost {
            break;
        }
    }
    Some(Adjusted { scene, cost })
}

/// A scene that costs less, damped as much as that needs; `None` when there is none.
fn better(
    task: &Task<'_>,
    normal: &Normal,
    scene: &Scene,
    cost: f64,
    damping: &mut f64,
) -> Option<(Scene, f64)> {
    while *damping < 1e9 {
        if let Some(next) = moved(task, normal, scene, *damping)
            && let Some(next_cost) = task.cost(&next).filter(|next| *next < cost)
        {
            *damping = (*damping * 0.1).max(1e-12);
            return Some((next, next_cost));
        }
        *damping *= 8.0;
    }
    None
}

fn moved(task: &Task<'_>, normal: &Normal, scene: &Scene, damping: f64) -> Option<Scene> {
    let (matrix, gradient) = normal.reduced(task, damping)?;
    let step = Cholesky::new(&matrix)?.solve(&gradient);
    let pose_steps = normal.pose_steps(damping, &step)?;
    let mut parameters = *scene.lens.all_parameters();
    for k in 0..MOST_PARAMETERS {
        parameters[k] += step[k];
    }
    let mut board_m = scene.board_m.clone();
    if task.board.is_some() {
        for (led, place) in board_m.iter_mut().enumerate() {
            let at = MOST_PARAMETERS + 3 * led;
            *place += Vector3::new(step[at], step[at + 1], step[at + 2]);
        }
    }
    let camera_from_board =
        scene.camera_from_board.iter().zip(&pose_steps).map(|(pose, step)| moved_pose(pose, step)).collect();
    Some(Scene { lens: scene.lens.with_parameters(parameters), board_m, camera_from_board })
}

/// A pose turned by the first three numbers (rad, in the camera's axes) and shifted by the last three (m).
pub(super) fn moved_pose(pose: &Isometry3<f64>, step: &Vector6<f64>) -> Isometry3<f64> {
    let mut rotation = UnitQuaternion::from_scaled_axis(step.fixed_rows::<3>(0).into_owned()) * pose.rotation;
    rotation.renormalize();
    let shift: Vector3<f64> = step.fixed_rows::<3>(3).into_owned();
    Isometry3::from_parts(Translation3::from(pose.translation.vector + shift), rotation)
}
