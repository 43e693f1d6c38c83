//! Photos that do not belong: of something else, mirrored, from another camera.

use nalgebra::Vector2;

use super::CalibrateError;
use crate::adjust::{Observation, Scene, View};
use crate::grid::Grid;
use crate::start::pose_from_nothing;

/// A photo that was left out.
#[derive(Clone, Debug, PartialEq)]
pub struct Misfit {
    /// Which photo.
    pub photo: usize,
    /// Mean distance of its LEDs from where the calibration without it expects them, px.
    pub mean_px: f64,
    /// What seems to be the matter.
    pub reason: MisfitReason,
}

/// What seems to be the matter with a photo.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MisfitReason {
    /// It fits when it is mirrored left to right.
    Mirrored,
    /// It fits in no way.
    Foreign,
}

/// A photo whose mean residual is this many times that of the middle one does not belong ...
const TIMES_MEDIAN: f64 = 6.0;
/// ... if it is longer than this, too, px.
const LEAST_PX: f64 = 1.0;
/// A calibration that misses by more than this fits nothing, px.
const NOTHING_FITS_PX: f64 = 8.0;

/// Fits the views, leaves the worst misfit out, and again, until none is left.
pub(super) fn fit_without(
    views: &mut Vec<View>,
    grid: &Grid,
    size_px: [usize; 2],
    fit: impl Fn(&[View]) -> Option<Scene>,
) -> Result<(Scene, Vec<Misfit>), CalibrateError> {
    let mut left_out: Vec<View> = Vec::new();
    loop {
        let scene = fit(views).ok_or(CalibrateError::NoStart)?;
        let means = means_px(views, &scene);
        let mut sorted = means.clone();
        sorted.sort_by(f64::total_cmp);
        let median = sorted[sorted.len() / 2];
        let worst = (0..means.len()).max_by(|&a, &b| means[a].total_cmp(&means[b])).unwrap_or(0);
        if means[worst] <= (TIMES_MEDIAN * median).max(LEAST_PX) {
            if median >= NOTHING_FITS_PX {
                return Err(CalibrateError::NothingFits { mean_px: median });
            }
            let misfits = left_out.iter().map(|view| judge(view, &scene, grid, size_px, median)).collect();
            return Ok((scene, misfits));
        }
        left_out.push(views.remove(worst));
        if views.len() < super::LEAST_PHOTOS {
            return Err(CalibrateError::NothingFits { mean_px: means[worst] });
        }
    }
}

/// Mean residual of each view, px.
pub(super) fn means_px(views: &[View], scene: &Scene) -> Vec<f64> {
    let mean = |(view, pose): (&View, _)| {
        let lengths = scene.residuals_px(view, pose);
        lengths.iter().map(|residual| residual.norm()).sum::<f64>() / lengths.len().max(1) as f64
    };
    views.iter().zip(&scene.camera_from_board).map(mean).collect()
}

fn judge(view: &View, scene: &Scene, grid: &Grid, size_px: [usize; 2], median_px: f64) -> Misfit {
    let mirror = |seen: &Observation| {
        let (column, row) = (seen.led % grid.columns(), seen.led / grid.columns());
        let pixel = Vector2::new(size_px[0] as f64 - 1.0 - seen.pixel.x, seen.pixel.y);
        Observation { led: row * grid.columns() + grid.columns() - 1 - column, pixel }
    };
    let mirrored = View { photo: view.photo, observations: view.observations.iter().map(mirror).collect() };
    let mean = |view: &View| alone_px(view, scene);
    let (mean_px, mirrored_px) = (mean(view), mean(&mirrored));
    let fits = mirrored_px < (2.5 * median_px).max(0.3 * mean_px) && mirrored_px < 0.5 * mean_px;
    let reason = if fits { MisfitReason::Mirrored } else { MisfitReason::Foreign };
    Misfit { photo: view.photo, mean_px, reason }
}

/// Mean residual of a view that the scene does not contain, with the best pose, px.
fn alone_px(view: &View, scene: &Scene) -> f64 {
    let Some((pose, _)) = pose_from_nothing(&scene.lens, &scene.board_m, view) else { return f64::INFINITY };
    let lengths = scene.residuals_px(view, &pose);
    lengths.iter().map(|residual| residual.norm()).sum::<f64>() / lengths.len().max(1) as f64
}

/// Refuses photos that all show the board in one pose.
pub(super) fn refuse_one_pose(scene: &Scene) -> Result<(), CalibrateError> {
    let (mut spread_deg, mut spread_share) = (0.0_f64, 0.0_f64);
    for (n, a) in scene.camera_from_board.iter().enumerate() {
        for b in &scene.camera_from_board[n + 1..] {
            spread_deg = spread_deg.max(a.rotation.angle_to(&b.rotation).to_degrees());
            let distance = a.translation.vector.norm().max(b.translation.vector.norm());
            let shift = (a.translation.vector - b.translation.vector).norm();
            spread_share = spread_share.max(100.0 * shift / distance);
        }
    }
    if spread_deg < 5.0 && spread_share < 8.0 {
        return Err(CalibrateError::OnePose { spread_deg, spread_share });
    }
    Ok(())
}
