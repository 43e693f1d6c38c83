//! The normal equations, photo by photo, with the poses eliminated.

use nalgebra::{DMatrix, DVector, Isometry3, Matrix2x3, Matrix3, Matrix6, SMatrix, Vector6};

use super::{Loss, Scene, Task, View};
use crate::lens::MOST_PARAMETERS;

/// What one photo says about what all photos share, and about its own pose.
pub(crate) struct PhotoShare {
    /// J^T W J of the shared unknowns; the lower triangle counts.
    pub(crate) shared: DMatrix<f64>,
    pub(crate) shared_gradient: DVector<f64>,
    /// J_shared^T W J_pose, a row per shared unknown.
    across: Vec<Vector6<f64>>,
    pose: Matrix6<f64>,
    pose_gradient: Vector6<f64>,
}

/// The sums over all photos.
pub(crate) struct Normal {
    pub(crate) shared: DMatrix<f64>,
    pub(crate) gradient: DVector<f64>,
    photos: Vec<Option<PhotoShare>>,
}

impl PhotoShare {
    /// The share of one view; `None` where a point has no image. `shared` is how many unknowns all photos share, those
    /// after the lens's being the board's.
    pub(crate) fn of(
        scene: &Scene,
        view: &View,
        pose: &Isometry3<f64>,
        loss: Loss,
        weight: f64,
        shared: usize,
    ) -> Option<Self> {
        let mut share = Self {
            shared: DMatrix::zeros(shared, shared),
            shared_gradient: DVector::zeros(shared),
            across: vec![Vector6::zeros(); shared],
            pose: Matrix6::zeros(),
            pose_gradient: Vector6::zeros(),
        };
        let board_is_free = shared > MOST_PARAMETERS;
        let rotation = pose.rotation.to_rotation_matrix();
        for seen in &view.observations {
            let turned = rotation * scene.board_m[seen.led];
            let projection = scene.lens.project(&(turned + pose.translation.vector))?;
            let residual = seen.pixel - projection.pixel;
            let weight = weight * loss.cost_and_weight(residual.norm_squared()).1;

            let by_turn = -projection.by_point * turned.cross_matrix();
            let mut by_pose = SMatrix::<f64, 2, 6>::zeros();
            by_pose.fixed_columns_mut::<3>(0).copy_from(&by_turn);
            by_pose.fixed_columns_mut::<3>(3).copy_from(&projection.by_point);
            let weighted_pose = by_pose * weight;
            share.pose += weighted_pose.transpose() * by_pose;
            share.pose_gradient += weighted_pose.transpose() * residual;

            let by_lens = &projection.by_parameters;
            for i in 0..MOST_PARAMETERS {
                let column = by_lens.column(i) * weight;
                share.shared_gradient[i] += column.dot(&residual);
                for j in 0..=i {
                    share.shared[(i, j)] += column.dot(&by_lens.column(j));
                }
                share.across[i] += by_pose.transpose() * column;
            }
            if board_is_free {
                share.add_board(
                    seen.led,
                    &(projection.by_point * rotation.matrix()),
                    by_lens,
                    weight,
                    &residual,
                    &by_pose,
                );
            }
        }
        Some(share)
    }

    fn add_board(
        &mut self,
        led: usize,
        by_led: &Matrix2x3<f64>,
        by_lens: &crate::lens::ByParameters,
        weight: f64,
        residual: &nalgebra::Vector2<f64>,
        by_pose: &SMatrix<f64, 2, 6>,
    ) {
        let at = MOST_PARAMETERS + 3 * led;
        let weighted = by_led * weight;
        let own: Matrix3<f64> = weighted.transpose() * by_led;
        for i in 0..3 {
            let column = weighted.column(i);
            self.shared_gradient[at + i] += column.dot(residual);
            self.across[at + i] += by_pose.transpose() * column;
            for j in 0..=i {
                self.shared[(at + i, at + j)] += own[(i, j)];
            }
            for j in 0..MOST_PARAMETERS {
                self.shared[(at + i, j)] += column.dot(&by_lens.column(j));
            }
        }
    }

    /// Takes the pose out: what is left for the shared unknowns, with `damping` on the pose. The lower triangle counts.
    pub(crate) fn reduced(&self, damping: f64) -> Option<(DMatrix<f64>, DVector<f64>)> {
        let (mut matrix, mut gradient) = (self.shared.clone(), self.shared_gradient.clone());
        self.eliminate(damping, &mut matrix, &mut gradient)?;
        Some((matrix, gradient))
    }

    fn damped_pose(&self, damping: f64) -> Option<nalgebra::Cholesky<f64, nalgebra::Const<6>>> {
        let mut pose = self.pose;
        for k in 0..6 {
            pose[(k, k)] += damping * pose[(k, k)] + 1e-12;
        }
        pose.cholesky()
    }

    fn eliminate(&self, damping: f64, matrix: &mut DMatrix<f64>, gradient: &mut DVector<f64>) -> Option<()> {
        let cholesky = self.damped_pose(damping)?;
        let lower = cholesky.l();
        let solve = |v: &Vector6<f64>| lower.solve_lower_triangular(v);
        let own = solve(&self.pose_gradient)?;
        let rows: Option<Vec<Vector6<f64>>> = self.across.iter().map(solve).collect();
        let rows = rows?;
        let seen: Vec<usize> = (0..rows.len()).filter(|&i| rows[i] != Vector6::zeros()).collect();
        for (n, &i) in seen.iter().enumerate() {
            gradient[i] -= rows[i].dot(&own);
            for &j in &seen[..=n] {
                matrix[(i, j)] -= rows[i].dot(&rows[j]);
            }
        }
        Some(())
    }

    /// The step of the pose (turn, then shift) that goes with a step of the shared unknowns.
    fn pose_step(&self, damping: f64, shared_step: &DVector<f64>) -> Option<Vector6<f64>> {
        let mut right = self.pose_gradient;
        for (row, step) in self.across.iter().zip(shared_step.iter()) {
            right -= row * *step;
        }
        Some(self.damped_pose(damping)?.solve(&right))
    }
}

impl Normal {
    /// The normal equations of `task` at `scene`.
    pub(crate) fn of(task: &Task<'_>, scene: &Scene) -> Option<Self> {
        let shared = task.shared();
        let mut normal = Self {
            shared: DMatrix::zeros(shared, shared),
            gradient: DVector::zeros(shared),
            photos: Vec::with_capacity(task.views.len()),
        };
        for (index, (view, pose)) in task.views.iter().zip(&scene.camera_from_board).enumerate() {
            let weight = task.weight(index);
            let share = match weight > 0.0 {
                true => Some(PhotoShare::of(scene, view, pose, task.loss, weight, shared)?),
                false => None,
            };
            if let Some(share) = &share {
                normal.shared += &share.shared;
                normal.gradient += &share.shared_gradient;
            }
            normal.photos.push(share);
        }
        normal.add_pulls(task, scene);
        Some(normal)
    }

    fn add_pulls(&mut self, task: &Task<'_>, scene: &Scene) {
        for pull in &task.pulls {
            let weight = pull.px_per_unit * pull.px_per_unit;
            let k = pull.parameter;
            self.shared[(k, k)] += weight;
            self.gradient[k] += weight * (pull.to - scene.lens.all_parameters()[k]);
        }
        if let Some(board) = task.board {
            let weight = board.pull_px_per_m * board.pull_px_per_m;
            for (led, (nominal, now)) in board.nominal_m.iter().zip(&scene.board_m).enumerate() {
                for k in 0..3 {
                    let at = MOST_PARAMETERS + 3 * led + k;
                    self.shared[(at, at)] += weight;
                    self.gradient[at] += weight * (nominal[k] - now[k]);
                }
            }
        }
    }

    /// The reduced matrix and gradient of the shared unknowns; those that are not free have a 1 on the diagonal.
    pub(crate) fn reduced(&self, task: &Task<'_>, damping: f64) -> Option<(DMatrix<f64>, DVector<f64>)> {
        let (mut matrix, mut gradient) = (self.shared.clone(), self.gradient.clone());
        for k in 0..matrix.nrows() {
            matrix[(k, k)] *= 1.0 + damping;
        }
        for photo in self.photos.iter().flatten() {
            photo.eliminate(damping, &mut matrix, &mut gradient)?;
        }
        hold(&task.free, &mut matrix, &mut gradient);
        Some((matrix, gradient))
    }

    /// The step of each pose that goes with a step of the shared unknowns.
    pub(crate) fn pose_steps(&self, damping: f64, step: &DVector<f64>) -> Option<Vec<Vector6<f64>>> {
        let of = |photo: &Option<PhotoShare>| match photo {
            Some(photo) => photo.pose_step(damping, step),
            None => Some(Vector6::zeros()),
        };
        self.photos.iter().map(of).collect()
    }

    /// The share of each photo that counts.
    pub(crate) fn photos(&self) -> impl Iterator<Item = &PhotoShare> {
        self.photos.iter().flatten()
    }
}

/// Takes the parameters of the lens that are not free out of the equations.
pub(crate) fn hold(free: &[bool; MOST_PARAMETERS], matrix: &mut DMatrix<f64>, gradient: &mut DVector<f64>) {
    for (k, _) in free.iter().enumerate().filter(|(_, free)| !**free) {
        for other in 0..matrix.nrows() {
            matrix[(k, other)] = 0.0;
            matrix[(other, k)] = 0.0;
        }
        matrix[(k, k)] = 1.0;
        gradient[k] = 0.0;
    }
}
