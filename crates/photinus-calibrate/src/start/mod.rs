//! From nothing to a first lens and a pose per photo.
//!
//! A dozen focal lengths are tried with an equidistant lens about the middle of the image; each gives every photo a pose in
//! closed form, also past 90 deg (`planar.rs`). The best few are adjusted with the centre held: a free centre
//! runs away while the curve is still wrong.

mod planar;

use nalgebra::{Isometry3, Vector3};

use crate::adjust::{Loss, Pull, Scene, Task, View, all_of, fit_pose};
use crate::lens::{AFFINE, CENTRE, Lens};

pub(crate) use planar::{other_fold, planar_pose};

/// Residuals longer than this count less while nothing is known, px.
pub(crate) const ROUGH: Loss = Loss::SoftL1(3.0);

/// Focal lengths tried, and how many of them are adjusted.
const FOCALS: i32 = 12;
const KEPT: usize = 2;

/// The first scene: an equidistant lens about the middle of an image of `size_px`, and poses that go with it. `None` when no focal
/// length gives every photo a pose.
pub(crate) fn start(views: &[View], nominal_m: &[Vector3<f64>], size_px: [usize; 2]) -> Option<Scene> {
    let [width, height] = size_px.map(|side| side as f64);
    let middle = [0.5 * (width - 1.0), 0.5 * (height - 1.0)];
    let longer = width.max(height);
    let mut tried: Vec<(f64, Scene)> = (0..FOCALS)
        .filter_map(|i| {
            let focal_px = longer * 0.2 * libm::pow(7.0, f64::from(i) / f64::from(FOCALS - 1));
            let lens = Lens::equidistant(longer / 3.0, focal_px, middle);
            let posed: Option<Vec<_>> =
                views.iter().map(|view| pose_from_nothing(&lens, nominal_m, view)).collect();
            let posed = posed?;
            let cost = posed.iter().map(|(_, cost)| cost).sum();
            let camera_from_board = posed.into_iter().map(|(pose, _)| pose).collect();
            Some((cost, Scene { lens, board_m: nominal_m.to_vec(), camera_from_board }))
        })
        .collect();
    tried.sort_by(|a, b| a.0.total_cmp(&b.0));
    let adjusted = tried.iter().take(KEPT).filter_map(|(_, scene)| {
        let adjusted = flat(views, scene, &[CENTRE, CENTRE + 1, AFFINE, AFFINE + 1], Vec::new(), ROUGH)?;
        let folded = best_folds(views, &adjusted.scene, ROUGH);
        flat(views, &folded, &[CENTRE, CENTRE + 1, AFFINE, AFFINE + 1], Vec::new(), ROUGH)
    });
    adjusted.min_by(|a, b| a.cost.total_cmp(&b.cost)).map(|adjusted| adjusted.scene)
}

/// Adjusts lens and poses with the board as it is; `held` parameters of the lens stay.
pub(crate) fn flat(
    views: &[View],
    scene: &Scene,
    held: &[usize],
    pulls: Vec<Pull>,
    loss: Loss,
) -> Option<crate::adjust::Adjusted> {
    let mut free = all_of(&scene.lens);
    for &k in held {
        free[k] = false;
    }
    let task = Task { views, weights: None, free, pulls, board: None, loss, most_steps: 60 };
    task.adjust(scene)
}

/// A pose for one view without any guess, and what it costs.
pub(crate) fn pose_from_nothing(
    lens: &Lens,
    board_m: &[Vector3<f64>],
    view: &View,
) -> Option<(Isometry3<f64>, f64)> {
    let first = planar_pose(lens, board_m, view)?;
    let (pose, cost) = fit_pose(lens, board_m, view, &first, ROUGH)?;
    Some(better_fold(lens, board_m, view, &pose, cost, ROUGH))
}

/// A plane seen in a photo has two poses that look nearly alike: each view gets the cheaper one.
pub(crate) fn best_folds(views: &[View], scene: &Scene, loss: Loss) -> Scene {
    let mut scene = scene.clone();
    for (view, pose) in views.iter().zip(&mut scene.camera_from_board) {
        if let Some((fitted, cost)) = fit_pose(&scene.lens, &scene.board_m, view, pose, loss) {
            *pose = better_fold(&scene.lens, &scene.board_m, view, &fitted, cost, loss).0;
        }
    }
    scene
}

fn better_fold(
    lens: &Lens,
    board_m: &[Vector3<f64>],
    view: &View,
    pose: &Isometry3<f64>,
    cost: f64,
    loss: Loss,
) -> (Isometry3<f64>, f64) {
    let other = other_fold(pose).and_then(|other| fit_pose(lens, board_m, view, &other, loss));
    match other {
        Some((other, other_cost)) if other_cost < cost => (other, other_cost),
        _ => (*pose, cost),
    }
}

#[cfg(test)]
mod tests;
