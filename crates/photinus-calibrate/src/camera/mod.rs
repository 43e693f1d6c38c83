//! Ordered photos -> a calibrated camera: the whole flow on one page.
//!
//! ```text
//! views -> from nothing (solve.rs) -> photos that do not fit -> labels -> board? -> which model -> outliers -> the camera
//! ```
//!
//! What leaves is a [`Calibration`]. Its repeats (halves of the photos, photos drawn with replacement) are functions of a number, each
//! independent of the others, so that a program may run them side by side and still get the same result.

mod bearings;
mod covariance;
mod coverage;
mod error;
mod export;
mod kannala_brandt;
mod misfits;
mod repeats;
mod residuals;
mod selection;
mod warnings;

use nalgebra::Isometry3;
use photinus::camera::Camera;

use crate::adjust::{Loss, Scene, View};
use crate::grid::Grid;
use crate::labels::Agreement;
use crate::lens::{Lens, LensModel};
use crate::photo::Photo;
use crate::solve::{Board, from_nothing, resolve_labels};

pub use bearings::{Difference, Field, RING_RAD, Ring};
pub use covariance::Inflation;
pub use coverage::{Coverage, Lack, Part, STRIP};
pub use error::CalibrateError;
pub use export::{Export, ExportError, ocam_of};
pub use kannala_brandt::kannala_brandt_of;
pub use misfits::{Misfit, MisfitReason};
pub use repeats::{Half, Split};
pub use residuals::{Outlier, Residual, Summary};
pub use selection::Candidate;
pub use warnings::Warning;

/// What to do about the board.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BoardChoice {
    /// Take the LEDs to be exactly on the grid.
    Flat,
    /// Find their places, or fail when the photos do not tell them.
    Solve,
    /// Find their places if the photos tell them.
    Auto,
}

/// What a user may choose.
#[derive(Clone, Debug)]
pub struct Choices {
    /// Models to choose among by held-out error; one is taken as it is.
    pub models: Vec<LensModel>,
    /// What to do about the board.
    pub board: BoardChoice,
}

/// A calibrated camera with all that it rests on.
#[derive(Clone, Debug)]
pub struct Calibration {
    pub(crate) grid: Grid,
    pub(crate) size_px: [usize; 2],
    pub(crate) views: Vec<View>,
    pub(crate) scene: Scene,
    pub(crate) board: Board,
    pub(crate) loss: Loss,
    board_choice: BoardChoice,
    misfits: Vec<Misfit>,
    agreement: Agreement,
    candidates: Vec<Candidate>,
    outliers: Vec<Outlier>,
    camera: Camera,
    inflation: Inflation,
    sigma_px: f64,
}

/// Least photos that a calibration can rest on.
pub const LEAST_PHOTOS: usize = 3;

/// Calibrates the camera that took `views` with images of `size_px`; `progress` hears what is being done.
///
/// # Errors
/// [`CalibrateError`] when the photos are too few or all alike, nothing fits them, or the board was to be solved and cannot be.
pub fn calibrate(
    views: &[View],
    grid: &Grid,
    size_px: [usize; 2],
    choices: &Choices,
    mut progress: impl FnMut(&str),
) -> Result<Calibration, CalibrateError> {
    if views.len() < LEAST_PHOTOS {
        return Err(CalibrateError::TooFewPhotos { usable: views.len() });
    }
    progress("starting from nothing");
    let ladder = LensModel::kannala_brandt(2).ok_or(CalibrateError::NoStart)?;
    let mut views = views.to_vec();
    let (mut scene, misfits) =
        misfits::fit_without(&mut views, grid, size_px, |views| from_nothing(views, grid, size_px, ladder))?;
    misfits::refuse_one_pose(&scene)?;

    progress("telling which way round the board is");
    let agreement = resolve_labels(&mut views, &mut scene, grid);
    let board = selection::choose_board(&views, &scene, grid, choices.board, &agreement)?;

    progress("comparing models");
    let (scene, candidates) = selection::choose_model(&views, &scene, grid, board, &choices.models)?;

    progress("leaving out outliers");
    let (scene, outliers) = residuals::without_outliers(&mut views, scene, grid, board)?;
    let loss = crate::solve::loss_for(&views, None, &scene);
    let sigma_px = crate::solve::sigma_px(&views, None, &scene);
    let (camera, inflation) = covariance::camera_of(&views, &scene, grid, size_px, board, loss)?;
    Ok(Calibration {
        grid: *grid,
        size_px,
        views,
        scene,
        board,
        loss,
        board_choice: choices.board,
        misfits,
        agreement,
        candidates,
        outliers,
        camera,
        inflation,
        sigma_px,
    })
}

impl Calibration {
    /// The camera, with its field limit and its covariance.
    pub fn camera(&self) -> &Camera {
        &self.camera
    }

    /// The grid as it was said.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// Columns and rows of the photos.
    pub fn size_px(&self) -> [usize; 2] {
        self.size_px
    }

    /// The lens.
    pub fn lens(&self) -> &Lens {
        &self.scene.lens
    }

    /// Lens, places of the LEDs, a pose per view.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The photos used with the LEDs used, all labelled the same way round.
    pub fn views(&self) -> &[View] {
        &self.views
    }

    /// Whether the places of the LEDs were found.
    pub fn board(&self) -> Board {
        self.board
    }

    /// How well the photos agree on where the LEDs are.
    pub fn agreement(&self) -> &Agreement {
        &self.agreement
    }

    /// Photos that were left out because they do not fit the others.
    pub fn misfits(&self) -> &[Misfit] {
        &self.misfits
    }

    /// LEDs of photos that were left out.
    pub fn outliers(&self) -> &[Outlier] {
        &self.outliers
    }

    /// The models that were compared.
    pub fn candidates(&self) -> &[Candidate] {
        &self.candidates
    }

    /// How much the covariance was raised above what independent residuals would give.
    pub fn inflation(&self) -> Inflation {
        self.inflation
    }

    /// Standard deviation of a residual along one axis, from the median, px.
    pub fn sigma_px(&self) -> f64 {
        self.sigma_px
    }

    /// Pose of each view: camera from board.
    pub fn poses(&self) -> &[Isometry3<f64>] {
        &self.scene.camera_from_board
    }

    /// All that a user should know or do about this calibration.
    pub fn warnings(&self, photos: &[Photo]) -> Vec<Warning> {
        warnings::of(self, photos)
    }
}

#[cfg(test)]
mod tests;
