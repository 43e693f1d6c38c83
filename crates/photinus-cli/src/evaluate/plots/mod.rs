//! Scores as figures for a paper: each a PNG and an SVG.
//!
//! ```text
//! by_range   a number over distance: recall, centre, bearing, distance, bounds, NEES, l_A and l_B
//! over_time  the distance of one neighbour: truth, estimate, bounds, l_A and l_B
//! ```

mod by_range;
mod over_time;

use std::collections::BTreeSet;
use std::path::Path;

use kuva::prelude::{Layout, Plot};
use photinus_evaluate::Evaluation;
use photinus_io::Result;
use photinus_io::dataset::TruthFrame;

/// A figure: what is drawn, and on which axes.
struct Figure {
    name: String,
    plots: Vec<Plot>,
    layout: Layout,
}

/// Draws every figure for which there is something to show into `folder`.
///
/// # Errors
/// [`photinus_io::Error`] when a figure cannot be drawn or written.
pub(crate) fn plot(folder: &Path, evaluation: &Evaluation<'_>, truth: &[TruthFrame]) -> Result<()> {
    let neighbours: BTreeSet<u32> =
        truth.iter().flat_map(|frame| &frame.neighbours).map(|neighbour| neighbour.id).collect();
    let over_time = neighbours.into_iter().filter_map(|id| over_time::distance(id, evaluation, truth));
    by_range::figures(evaluation).into_iter().chain(over_time).try_for_each(|figure| {
        let scene = kuva::render::render::render_multiple(figure.plots, figure.layout);
        crate::plots::save(folder, &figure.name, &scene).map(drop)
    })
}
