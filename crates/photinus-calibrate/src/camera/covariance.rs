//! How sure the parameters are.
//!
//! Residuals of one photo lean together (light, focus and the board's tilt act on all its LEDs), so that sums over LEDs as if they
//! were independent promise too much, by up to twice. Each photo's own pull on the solution is therefore measured, with and without the
//! photo in the fit, and the covariance is raised until it explains those pulls over the field; it is never lowered.

use nalgebra::{DMatrix, DVector};
use photinus::camera::Camera;

use super::CalibrateError;
use super::bearings::Field;
use super::export::model_of;
use crate::adjust::{Cholesky, Loss, Normal, Scene, Task, View, hold};
use crate::grid::Grid;
use crate::lens::MOST_PARAMETERS;
use crate::solve::{Board, last_step, reach_rad};

/// By how much sigmas were raised above those of independent residuals.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Inflation {
    /// What the pulls of the photos ask for; below 1 when they happen to cancel.
    pub measured: f64,
    /// What was done: at least 1.
    pub applied: f64,
}

/// The file answers this far past the outermost LED, rad: other photos of the same lens may show one there.
const MARGIN_RAD: f64 = 0.035;

/// The camera with its field limit and its covariance.
pub(super) fn camera_of(
    views: &[View],
    scene: &Scene,
    grid: &Grid,
    size_px: [usize; 2],
    board: Board,
    loss: Loss,
) -> Result<(Camera, Inflation), CalibrateError> {
    let (model, by_lens) = model_of(&scene.lens)?;
    let reach_rad = reach_rad(views, scene);
    let bare = Camera::new(model.clone(), size_px[0], size_px[1], Some(reach_rad + MARGIN_RAD))
        .or_else(|_| Camera::new(model, size_px[0], size_px[1], Some(reach_rad)))?;
    let with = |covariance: &DMatrix<f64>| {
        bare.clone().with_calibration(symmetric_product(&by_lens, covariance)).map_err(CalibrateError::from)
    };

    let nominal_m = grid.nominal_m();
    let task = last_step(views, None, scene, &nominal_m, grid, board, loss);
    let unknown = Unknown::of(&task, scene).ok_or(CalibrateError::NoModel)?;
    let independent = with(&unknown.independent)?;
    let field = Field::of(&independent, reach_rad);
    let variance = |camera: &Camera| field.mean_variance(camera);
    let pulls = variance(&with(&unknown.pulls_with)?) * variance(&with(&unknown.pulls_without)?);
    // between a photo's pull with itself in the fit, which is too small, and without, which is too large
    let measured = libm::pow(pulls, 0.25) / variance(&independent).sqrt();
    let applied = if measured.is_finite() { measured.max(1.0) } else { 1.0 };
    let camera = with(&(unknown.independent * (applied * applied)))?;
    Ok((camera, Inflation { measured, applied }))
}

/// Covariances of the parameters of the lens, by three ways.
struct Unknown {
    /// As if all residuals were independent.
    independent: DMatrix<f64>,
    /// From what each photo pulls, the photo being in the fit.
    pulls_with: DMatrix<f64>,
    /// From what each photo pulls, the photo being left out of the fit.
    pulls_without: DMatrix<f64>,
}

impl Unknown {
    fn of(task: &Task<'_>, scene: &Scene) -> Option<Self> {
        let normal = Normal::of(task, scene)?;
        let (matrix, _) = normal.reduced(task, 0.0)?;
        let all = Cholesky::new(&matrix)?;
        let independent = all.inverse_block(MOST_PARAMETERS) * variance_px2(task, scene);
        let photos = task.views.len() as f64;
        let (mut pulls_with, mut pulls_without) = (
            DMatrix::zeros(MOST_PARAMETERS, MOST_PARAMETERS),
            DMatrix::zeros(MOST_PARAMETERS, MOST_PARAMETERS),
        );
        for photo in normal.photos() {
            let (own, mut gradient) = photo.reduced(0.0)?;
            let mut rest = &matrix - own;
            hold(&task.free, &mut rest, &mut gradient);
            add_square(&mut pulls_with, &all.solve(&gradient), photos / (photos - 1.0));
            // without one of few photos the rest may tell nothing
            let without = Cholesky::new(&rest).unwrap_or_else(|| all.clone());
            add_square(&mut pulls_without, &without.solve(&gradient), (photos - 1.0) / photos);
        }
        Some(Self { independent: held_at_zero(task, independent), pulls_with, pulls_without })
    }
}

/// Parameters that are not free are known.
fn held_at_zero(task: &Task<'_>, mut covariance: DMatrix<f64>) -> DMatrix<f64> {
    for (k, _) in task.free.iter().enumerate().filter(|(_, free)| !**free) {
        covariance[(k, k)] = 0.0;
    }
    covariance
}

fn add_square(sum: &mut DMatrix<f64>, step: &DVector<f64>, factor: f64) {
    for i in 0..sum.nrows() {
        for j in 0..sum.ncols() {
            sum[(i, j)] += factor * step[i] * step[j];
        }
    }
}

/// Variance of a residual along one axis, px^2, over what the unknowns leave free.
fn variance_px2(task: &Task<'_>, scene: &Scene) -> f64 {
    let (mut squares, mut weights, mut photos) = (0.0, 0.0, 0.0);
    for (view, pose) in task.views.iter().zip(&scene.camera_from_board) {
        photos += 1.0;
        for residual in scene.residuals_px(view, pose) {
            let (_, weight) = task.loss.cost_and_weight(residual.norm_squared());
            squares += weight * residual.norm_squared();
            weights += 2.0 * weight;
        }
    }
    let lens = task.free.iter().filter(|free| **free).count() as f64;
    let board = task.board.map_or(0.0, |board| 3.0 * board.nominal_m.len() as f64 - 7.0);
    squares / (weights - 6.0 * photos - lens - board).max(1.0)
}

/// A C A^T, summed in a written order.
fn symmetric_product(a: &DMatrix<f64>, c: &DMatrix<f64>) -> DMatrix<f64> {
    let row_times = |i: usize, j: usize| -> f64 { (0..c.nrows()).map(|k| a[(i, k)] * c[(k, j)]).sum() };
    let half = DMatrix::from_fn(a.nrows(), c.ncols(), row_times);
    let mut product = DMatrix::from_fn(a.nrows(), a.nrows(), |i, j| {
        if j > i { 0.0 } else { (0..c.ncols()).map(|k| half[(i, k)] * a[(j, k)]).sum() }
    });
    product.fill_upper_triangle_with_lower_triangle();
    product
}
