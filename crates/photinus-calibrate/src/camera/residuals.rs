//! How far the photos' LEDs are from where the calibration expects them.

use nalgebra::Vector2;

use super::{CalibrateError, Calibration};
use crate::adjust::{Scene, View};
use crate::grid::Grid;
use crate::solve::{Board, loss_for, refit, sigma_px};

/// One LED in one photo.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Residual {
    /// Which photo.
    pub photo: usize,
    /// Which LED.
    pub led: usize,
    /// Where it is seen, (u, v) in px.
    pub seen: Vector2<f64>,
    /// Seen minus expected, px.
    pub off_px: Vector2<f64>,
}

/// An LED of a photo that was left out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outlier {
    /// Which LED of which photo, and how far off it was.
    pub residual: Residual,
    /// Standard deviation of the others along one axis, px.
    pub sigma_px: f64,
}

/// Distances of several LEDs, px.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Summary {
    /// How many.
    pub count: usize,
    /// Mean distance.
    pub mean_px: f64,
    /// Root mean square distance.
    pub rms_px: f64,
    /// Largest distance.
    pub max_px: f64,
}

/// An LED farther off than this many standard deviations is left out ...
const OUTLIER_SIGMAS: f64 = 6.0;
/// ... if it is this far off, too, px.
const OUTLIER_PX: f64 = 0.25;

impl Summary {
    /// Of these distances, px.
    pub fn of(distances: impl IntoIterator<Item = f64>) -> Self {
        let mut summary = Self::default();
        for distance in distances {
            summary.count += 1;
            summary.mean_px += distance;
            summary.rms_px += distance * distance;
            summary.max_px = summary.max_px.max(distance);
        }
        let count = summary.count.max(1) as f64;
        Self { mean_px: summary.mean_px / count, rms_px: (summary.rms_px / count).sqrt(), ..summary }
    }
}

impl Calibration {
    /// All residuals, photo by photo.
    pub fn residuals(&self) -> Vec<Residual> {
        all(&self.views, &self.scene)
    }
}

fn all(views: &[View], scene: &Scene) -> Vec<Residual> {
    let of_view = |(view, pose): (&View, _)| {
        let off = scene.residuals_px(view, pose);
        let residual = |(seen, off_px): (&crate::adjust::Observation, Vector2<f64>)| Residual {
            photo: view.photo,
            led: seen.led,
            seen: seen.pixel,
            off_px,
        };
        view.observations.iter().zip(off).map(residual).collect::<Vec<_>>()
    };
    views.iter().zip(&scene.camera_from_board).flat_map(of_view).collect()
}

/// Takes LEDs that are far off out of the views and fits again.
pub(super) fn without_outliers(
    views: &mut [View],
    mut scene: Scene,
    grid: &Grid,
    board: Board,
) -> Result<(Scene, Vec<Outlier>), CalibrateError> {
    let mut outliers = Vec::new();
    for _ in 0..3 {
        let sigma_px = sigma_px(views, None, &scene);
        let limit_px = (OUTLIER_SIGMAS * sigma_px).max(OUTLIER_PX);
        let far: Vec<Residual> = all(views, &scene)
            .into_iter()
            .filter(|residual| residual.off_px.norm().total_cmp(&limit_px).is_gt())
            .collect();
        if far.is_empty() {
            break;
        }
        for view in views.iter_mut() {
            let is_far =
                |led: usize| far.iter().any(|residual| residual.photo == view.photo && residual.led == led);
            let kept = view.observations.iter().filter(|seen| !is_far(seen.led)).copied().collect();
            view.observations = kept;
        }
        outliers.extend(far.into_iter().map(|residual| Outlier { residual, sigma_px }));
        let loss = loss_for(views, None, &scene);
        scene = refit(views, None, &scene, grid, board, loss).ok_or(CalibrateError::NoModel)?;
    }
    Ok((scene, outliers))
}
