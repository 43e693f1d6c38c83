//! Where the normal equations of a scene lead to.

use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3, Vector6};
use photinus::solve::Descent;

use super::cholesky::Cholesky;
use super::normal::Normal;
use super::{Scene, Task};
use crate::lens::MOST_PARAMETERS;

/// Lens, board and poses, all together.
impl Descent for Task<'_> {
    type Place = Scene;
    type Normal = Normal;

    fn cost(&self, scene: &Scene) -> Option<f64> {
        Task::cost(self, scene)
    }

    fn normal(&self, scene: &Scene) -> Option<Normal> {
        Normal::of(self, scene)
    }

    fn stepped(&self, scene: &Scene, normal: &Normal, damping: f64) -> Option<Scene> {
        let (matrix, gradient) = normal.reduced(self, damping)?;
        let step = Cholesky::new(&matrix)?.solve(&gradient);
        let pose_steps = normal.pose_steps(damping, &step)?;
        let mut parameters = *scene.lens.all_parameters();
        for k in 0..MOST_PARAMETERS {
            parameters[k] += step[k];
        }
        let mut board_m = scene.board_m.clone();
        if self.board.is_some() {
            for (led, place) in board_m.iter_mut().enumerate() {
                let at = MOST_PARAMETERS + 3 * led;
                *place += Vector3::new(step[at], step[at + 1], step[at + 2]);
            }
        }
        let moved = |(pose, step)| moved_pose(pose, step);
        let camera_from_board = scene.camera_from_board.iter().zip(&pose_steps).map(moved).collect();
        Some(Scene { lens: scene.lens.with_parameters(parameters), board_m, camera_from_board })
    }
}

/// A pose turned by the first three numbers (rad, in the camera's axes) and shifted by the last three (m).
pub(super) fn moved_pose(pose: &Isometry3<f64>, step: &Vector6<f64>) -> Isometry3<f64> {
    let mut rotation = UnitQuaternion::from_scaled_axis(step.fixed_rows::<3>(0).into_owned()) * pose.rotation;
    rotation.renormalize();
    let shift: Vector3<f64> = step.fixed_rows::<3>(3).into_owned();
    Isometry3::from_parts(Translation3::from(pose.translation.vector + shift), rotation)
}
