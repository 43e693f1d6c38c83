//! Ordered photos -> lens, board and poses: the ladder from nothing to the best fit. Read this first.
//!
//! Each rung starts where the one below ended and frees a little more; skipping one is how a calibration ends in a wrong
//! minimum (a centre far outside the image, a board bent through itself).

use nalgebra::Vector3;

use crate::adjust::{FreeBoard, Loss, Pull, Scene, Task, View, all_of};
use crate::grid::Grid;
use crate::labels::{Agreement, agreement, turn_view};
use crate::lens::{AFFINE, CENTRE, LensModel};
use crate::start::{ROUGH, best_folds, flat, start};

/// Whether the LEDs are taken to be where the drawing says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Board {
    /// Exactly on the grid.
    Flat,
    /// Near the grid: their places are found, too.
    Solved,
}

/// How far an LED of a hand-made board may be from its place, in pitches: the pull that fixes the board's freedom to move.
const BOARD_SIGMA_PITCHES: f64 = 0.1;
/// Residuals longer than this count less at the end, px, at least.
const LEAST_LOSS_PX: f64 = 0.1;
/// The same in standard deviations of the residuals.
const LOSS_SIGMAS: f64 = 3.0;

/// Lens and poses from nothing, with a flat board, all parameters of `model` free. `None` when no start was found.
pub(crate) fn from_nothing(
    views: &[View],
    grid: &Grid,
    size_px: [usize; 2],
    model: LensModel,
) -> Option<Scene> {
    let first = start(views, &grid.nominal_m(), size_px)?;
    let affine = [AFFINE, AFFINE + 1];
    let about = |scene: &Scene| {
        let sigma_px = 0.05 * size_px[0].max(size_px[1]) as f64;
        let centre = scene.lens.centre_px();
        let pull =
            |axis: usize| Pull { parameter: CENTRE + axis, to: centre[axis], px_per_unit: 1.0 / sigma_px };
        vec![pull(0), pull(1)]
    };
    let middle_model = LensModel::kannala_brandt(2)?;
    let curved = Scene { lens: first.lens.in_model(middle_model, reach_rad(views, &first)), ..first };
    let centred = flat(views, &curved, &affine, about(&curved), ROUGH)?.scene;
    let folded = best_folds(views, &centred, ROUGH);
    let curved = flat(views, &folded, &affine, Vec::new(), ROUGH)?.scene;
    climb(views, &in_model(views, &curved, model))
}

/// All parameters free, from a scene that is near.
fn climb(views: &[View], near: &Scene) -> Option<Scene> {
    let folded = best_folds(views, near, ROUGH);
    let all = flat(views, &folded, &[], square(views, &folded), ROUGH)?.scene;
    flat(views, &all, &[], square(views, &all), loss_for(views, None, &all)).map(|adjusted| adjusted.scene)
}

/// Pixels are square to within this, unless the photos clearly say otherwise.
const SQUARE: f64 = 0.0003;

/// What holds c near 1 and d near 0 where they already are: photos that all hold the board upright cannot tell a wide
/// board from wide pixels.
fn square(views: &[View], near: &Scene) -> Vec<Pull> {
    let p = near.lens.all_parameters();
    let px_per_unit = sigma_px(views, None, near) / SQUARE;
    let values = [(AFFINE, 1.0), (AFFINE + 1, 0.0)];
    let near_enough = |&(parameter, to): &(usize, f64)| (p[parameter] - to).abs() < 5.0 * SQUARE;
    values
        .into_iter()
        .filter(near_enough)
        .map(|(parameter, to)| Pull { parameter, to, px_per_unit })
        .collect()
}

/// The same scene with a lens of another model.
pub(crate) fn in_model(views: &[View], scene: &Scene, model: LensModel) -> Scene {
    Scene { lens: scene.lens.in_model(model, reach_rad(views, scene)), ..scene.clone() }
}

/// Turns the labels of views so that all hold the grid the same way round.
pub(crate) fn resolve_labels(views: &mut [View], scene: &mut Scene, grid: &Grid) -> Agreement {
    let agreement = agreement(views, scene, grid);
    for ((view, pose), &turn) in views.iter_mut().zip(&mut scene.camera_from_board).zip(&agreement.turns) {
        (*view, *pose) = turn_view(view, pose, grid, turn);
    }
    agreement
}

/// A task with everything free, as the last step runs it.
pub(crate) fn last_step<'a>(
    views: &'a [View],
    weights: Option<&'a [f64]>,
    near: &Scene,
    nominal_m: &'a [Vector3<f64>],
    grid: &Grid,
    board: Board,
    loss: Loss,
) -> Task<'a> {
    let free_board = match board {
        Board::Flat => None,
        Board::Solved => Some(FreeBoard {
            nominal_m,
            pull_px_per_m: LEAST_LOSS_PX / (BOARD_SIGMA_PITCHES * grid.pitch_m()),
        }),
    };
    Task {
        views,
        weights,
        free: all_of(&near.lens),
        pulls: square(views, near),
        board: free_board,
        loss,
        most_steps: 40,
    }
}

/// Adjusts a scene that is near with all parameters free, the loss following the residuals.
pub(crate) fn settle(views: &[View], near: &Scene, grid: &Grid, board: Board) -> Option<Scene> {
    let flat = climb(views, near)?;
    match board {
        Board::Flat => Some(flat),
        Board::Solved => {
            let first = refit(views, None, &flat, grid, board, loss_for(views, None, &flat))?;
            refit(views, None, &first, grid, board, loss_for(views, None, &first))
        }
    }
}

/// Adjusts a scene that is near with all parameters free; each view counts as often as its weight says.
pub(crate) fn refit(
    views: &[View],
    weights: Option<&[f64]>,
    near: &Scene,
    grid: &Grid,
    board: Board,
    loss: Loss,
) -> Option<Scene> {
    let nominal_m = grid.nominal_m();
    last_step(views, weights, near, &nominal_m, grid, board, loss).adjust(near).map(|adjusted| adjusted.scene)
}

/// A loss that takes ordinary residuals as they are and lets go of the others.
pub(crate) fn loss_for(views: &[View], weights: Option<&[f64]>, scene: &Scene) -> Loss {
    Loss::Cauchy((LOSS_SIGMAS * sigma_px(views, weights, scene)).max(LEAST_LOSS_PX))
}

/// Standard deviation of a residual along one axis, from the median length, px.
pub(crate) fn sigma_px(views: &[View], weights: Option<&[f64]>, scene: &Scene) -> f64 {
    let mut lengths: Vec<f64> = Vec::new();
    for (index, (view, pose)) in views.iter().zip(&scene.camera_from_board).enumerate() {
        if weights.is_none_or(|weights| weights[index] > 0.0) {
            lengths.extend(scene.residuals_px(view, pose).iter().map(|residual| residual.norm()));
        }
    }
    lengths.sort_by(f64::total_cmp);
    // the median of a Rayleigh distribution is 1.1774 sigma
    lengths.get(lengths.len() / 2).map_or(0.0, |median| median / 1.1774)
}

/// The largest angle off the axis of an LED, rad.
pub(crate) fn reach_rad(views: &[View], scene: &Scene) -> f64 {
    let angles = views.iter().zip(&scene.camera_from_board).flat_map(|(view, pose)| {
        view.observations.iter().map(move |seen| {
            let point = pose * nalgebra::Point3::from(scene.board_m[seen.led]);
            libm::atan2(libm::hypot(point.x, point.y), point.z)
        })
    });
    angles.fold(0.1, f64::max).min(3.0)
}
