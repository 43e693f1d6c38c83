//! The same calibration from other photos: halves of them, and photos drawn with replacement. What comes out differently is
//! what is not known.

use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::{Rng as _, SeedableRng as _};

use super::{Calibration, Summary};
use crate::adjust::{Scene, View, fit_pose};
use crate::grid::Grid;
use crate::labels::turn_view;
use crate::lens::Lens;
use crate::solve::{Board, refit};

/// A calibration from one half of the photos, tried on the other.
#[derive(Clone, Debug)]
pub struct Half {
    /// The lens from this half.
    pub lens: Lens,
    /// Distances in the other half, with nothing but poses fitted there.
    pub held_out: Summary,
}

/// Both halves of one random split.
#[derive(Clone, Debug)]
pub struct Split {
    /// The halves; `None` where the adjustment failed.
    pub halves: [Option<Half>; 2],
}

/// Random numbers of one repeat: the same for the same number, everywhere.
fn random(kind: u64, repeat: u64) -> Pcg64Mcg {
    Pcg64Mcg::seed_from_u64(kind.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ repeat)
}

/// A whole number below `end`, without a bias that matters for so few.
fn below(rng: &mut Pcg64Mcg, end: usize) -> usize {
    ((u128::from(rng.next_u64()) * end as u128) >> 64) as usize
}

/// Which views are in the first half of split number `repeat`.
pub(crate) fn first_half(views: usize, repeat: u64) -> Vec<bool> {
    let mut rng = random(1, repeat);
    let mut order: Vec<usize> = (0..views).collect();
    for last in (1..views).rev() {
        order.swap(last, below(&mut rng, last + 1));
    }
    let mut is_first = vec![false; views];
    for &view in &order[..views / 2] {
        is_first[view] = true;
    }
    is_first
}

impl Calibration {
    /// Split number `repeat`: each half calibrated, and tried on the other.
    pub fn split(&self, repeat: u64) -> Split {
        let is_first = first_half(self.views.len(), repeat);
        let half = |first: bool| {
            held_out(&self.views, &self.scene, &self.grid, self.board, self.loss, |view| {
                is_first[view] == first
            })
        };
        Split { halves: [half(true), half(false)] }
    }

    /// The lens from as many photos drawn with replacement, draw number `repeat`; `None` where too few different ones were drawn.
    pub fn resampled(&self, repeat: u64) -> Option<Lens> {
        let mut rng = random(2, repeat);
        let mut weights = vec![0.0; self.views.len()];
        for _ in 0..self.views.len() {
            weights[below(&mut rng, self.views.len())] += 1.0;
        }
        let different = weights.iter().filter(|weight| **weight > 0.0).count();
        if different < super::LEAST_PHOTOS {
            return None;
        }
        refit(&self.views, Some(&weights), &self.scene, &self.grid, self.board, self.loss)
            .map(|scene| scene.lens)
    }
}

/// Calibrates with the views of which `is_trained` is true, and tries the result on the others: there each photo chooses its pose and
/// which way round it holds the board.
pub(super) fn held_out(
    views: &[View],
    near: &Scene,
    grid: &Grid,
    board: Board,
    loss: crate::adjust::Loss,
    is_trained: impl Fn(usize) -> bool,
) -> Option<Half> {
    let weights: Vec<f64> = (0..views.len()).map(|view| if is_trained(view) { 1.0 } else { 0.0 }).collect();
    let trained = refit(views, Some(&weights), near, grid, board, loss)?;
    let mut distances = Vec::new();
    for (index, (view, pose)) in views.iter().zip(&near.camera_from_board).enumerate() {
        if is_trained(index) {
            continue;
        }
        let tries = (0..grid.turns()).filter_map(|turn| {
            let (view, pose) = turn_view(view, pose, grid, turn);
            let (pose, cost) = fit_pose(&trained.lens, &trained.board_m, &view, &pose, loss)?;
            Some((cost, trained.residuals_px(&view, &pose)))
        });
        let (_, residuals) = tries.min_by(|a, b| a.0.total_cmp(&b.0))?;
        distances.extend(residuals.iter().map(|residual| residual.norm()));
    }
    Some(Half { lens: trained.lens, held_out: Summary::of(distances) })
}
