//! Which model, and whether the board: by the error on photos that were held out.

use super::repeats::{first_half, held_out};
use super::{BoardChoice, CalibrateError};
use crate::adjust::{Scene, View};
use crate::grid::Grid;
use crate::labels::Agreement;
use crate::lens::LensModel;
use crate::solve::{Board, in_model, loss_for, settle};

/// A model that was compared.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Candidate {
    /// The model.
    pub model: LensModel,
    /// Mean distance in the photos it was adjusted to, px.
    pub mean_px: f64,
    /// Mean distance in photos held out, median over the splits, px; `None` where it was not tried or failed.
    pub held_out_px: Option<f64>,
    /// Whether it was taken.
    pub chosen: bool,
}

/// Splits over which models are compared.
const SPLITS: u64 = 4;
/// A simpler model that is worse by no more than this share is taken.
const CLOSE: f64 = 1.05;
/// Fewer photos than this do not tell where the LEDs are.
const LEAST_PHOTOS_FOR_BOARD: usize = 6;

/// Whether the places of the LEDs are to be found.
pub(super) fn choose_board(
    views: &[View],
    scene: &Scene,
    grid: &Grid,
    choice: BoardChoice,
    agreement: &Agreement,
) -> Result<Board, CalibrateError> {
    let reason = match choice {
        BoardChoice::Flat => return Ok(Board::Flat),
        _ if views.len() < LEAST_PHOTOS_FOR_BOARD => {
            Some(format!("{} photos, at least {LEAST_PHOTOS_FOR_BOARD} are needed", views.len()))
        }
        _ => doubt(views, scene, grid, agreement),
    };
    match (reason, choice) {
        (None, _) => Ok(Board::Solved),
        (Some(reason), BoardChoice::Solve) => Err(CalibrateError::BoardUnsupported { reason }),
        (Some(_), _) => Ok(Board::Flat),
    }
}

/// Why the photos do not tell where the LEDs are; `None` when they do.
fn doubt(views: &[View], scene: &Scene, grid: &Grid, agreement: &Agreement) -> Option<String> {
    if agreement.correlation < agreement.chance {
        return Some(format!(
            "what is left of one photo agrees with the others by {:.2}, chance gives up to {:.2}",
            agreement.correlation, agreement.chance
        ));
    }
    let error = |board: Board| {
        let settled = settle(views, scene, grid, board)?;
        held_out_px(views, &settled, grid, board)
    };
    match (error(Board::Flat), error(Board::Solved)) {
        (Some(flat), Some(solved)) if solved < 0.95 * flat => None,
        (Some(flat), Some(solved)) => Some(format!(
            "photos held out are missed by {solved:.3} px with the places found, by {flat:.3} px with a flat board"
        )),
        _ => Some("the adjustment with a free board fails on half of the photos".to_owned()),
    }
}

/// Median over the splits of the mean distance in photos held out, px.
fn held_out_px(views: &[View], scene: &Scene, grid: &Grid, board: Board) -> Option<f64> {
    if views.len() < 2 * super::LEAST_PHOTOS {
        return None;
    }
    let loss = loss_for(views, None, scene);
    let mut errors = Vec::new();
    for repeat in 0..SPLITS {
        let is_first = first_half(views.len(), repeat);
        for first in [true, false] {
            errors.push(
                held_out(views, scene, grid, board, loss, |view| is_first[view] == first)?.held_out.mean_px,
            );
        }
    }
    errors.sort_by(f64::total_cmp);
    Some(0.5 * (errors[(errors.len() - 1) / 2] + errors[errors.len() / 2])).filter(|error| error.is_finite())
}

/// The scene with the model that misses held-out photos least, or a simpler one that is nearly as good; all that were compared.
pub(super) fn choose_model(
    views: &[View],
    scene: &Scene,
    grid: &Grid,
    board: Board,
    models: &[LensModel],
) -> Result<(Scene, Vec<Candidate>), CalibrateError> {
    let mut tried: Vec<(Candidate, Scene)> = Vec::new();
    for &model in models {
        let Some(settled) = settle(views, &in_model(views, scene, model), grid, board) else { continue };
        let means = super::misfits::means_px(views, &settled);
        let mean_px = means.iter().sum::<f64>() / means.len() as f64;
        let compare = models.len() > 1;
        let held_out_px = if compare { held_out_px(views, &settled, grid, board) } else { None };
        tried.push((Candidate { model, mean_px, held_out_px, chosen: false }, settled));
    }
    let none_held_out = tried.iter().all(|(candidate, _)| candidate.held_out_px.is_none());
    let error = |candidate: &Candidate| match candidate.held_out_px {
        None if none_held_out => candidate.mean_px,
        held_out => held_out.unwrap_or(f64::INFINITY),
    };
    let best = tried.iter().map(|(candidate, _)| error(candidate)).fold(f64::INFINITY, f64::min);
    let chosen = tried
        .iter()
        .enumerate()
        .filter(|(_, (candidate, _))| error(candidate) <= CLOSE * best)
        .min_by_key(|(_, (candidate, _))| (candidate.model.parameters(), candidate.model))
        .map(|(index, _)| index)
        .ok_or(CalibrateError::NoModel)?;
    tried[chosen].0.chosen = true;
    let candidates = tried.iter().map(|(candidate, _)| *candidate).collect();
    Ok((tried.swap_remove(chosen).1, candidates))
}
