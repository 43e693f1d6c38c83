//! Scores as figures for a paper.
//!
//! ```text
//! by_range   a number over distance: recall, centre, bearing, distance, bounds, NEES, l_A and l_B
//! over_time  the distance of one neighbour: truth, estimate, bounds, l_A and l_B
//! ```

mod by_range;
mod over_time;

use std::collections::BTreeSet;

use photinus_evaluate::Evaluation;
use photinus_io::Result;
use photinus_io::dataset::TruthFrame;

use crate::figure::FigureFolder;

/// Draws every figure for which there is something to show.
///
/// # Errors
/// [`photinus_io::Error`] when a figure cannot be drawn or written.
pub(crate) fn draw(folder: &FigureFolder, evaluation: &Evaluation<'_>, truth: &[TruthFrame]) -> Result<()> {
    let neighbours: BTreeSet<u32> =
        truth.iter().flat_map(|frame| &frame.neighbours).map(|neighbour| neighbour.id).collect();
    let over_time = neighbours.into_iter().filter_map(|id| over_time::distance(id, evaluation, truth));
    by_range::figures(evaluation)
        .into_iter()
        .chain(over_time)
        .try_for_each(|figure| folder.write(figure).map(drop))
}
