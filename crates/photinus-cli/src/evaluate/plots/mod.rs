//! Scores as figures for a paper: each a PNG and an SVG.
//!
//! ```text
//! by_range   a number over distance: recall, centre, bearing, distance, bounds, NEES, l_A and l_B
//! over_time  the distance of one neighbour: truth, estimate, bounds, l_A and l_B; and the error of the estimate
//! page       all of them on a page, with the tables
//! ```

mod by_range;
mod over_time;
pub(crate) mod page;

use std::collections::BTreeSet;
use std::path::Path;

use kuva::prelude::{Layout, Plot};
use photinus_evaluate::Evaluation;
use photinus_io::Result;
use photinus_io::dataset::TruthFrame;

/// A figure: what is drawn, on which axes, and what there is to see in it.
struct Figure {
    name: String,
    title: String,
    caption: &'static str,
    plots: Vec<Plot>,
    layout: Layout,
}

/// A figure that lies in a folder.
pub(crate) struct Drawn {
    /// Its file without an ending: there is a PNG and an SVG.
    pub(crate) name: String,
    /// What it shows.
    pub(crate) title: String,
    /// What there is to see in it.
    pub(crate) caption: &'static str,
}

/// Draws every figure for which there is something to show into `folder`, and says which.
///
/// # Errors
/// [`photinus_io::Error`] when a figure cannot be drawn or written.
pub(crate) fn plot(folder: &Path, evaluation: &Evaluation<'_>, truth: &[TruthFrame]) -> Result<Vec<Drawn>> {
    let neighbours: BTreeSet<u32> =
        truth.iter().flat_map(|frame| &frame.neighbours).map(|neighbour| neighbour.id).collect();
    let is_only = neighbours.len() == 1;
    let whose = |id: u32| if is_only { String::new() } else { format!(" of neighbour {id}") };
    let over_time = neighbours.iter().flat_map(|&id| over_time::figures(id, &whose(id), evaluation, truth));
    let draw = |Figure { name, title, caption, plots, layout }: Figure| {
        let scene = kuva::render::render::render_multiple(
            plots,
            layout.with_title(title.clone()).with_title_size(15),
        );
        crate::plots::save(folder, &name, &scene)?;
        Ok(Drawn { name, title, caption })
    };
    let by_range = by_range::figures(evaluation).into_iter();
    // One flight is looked at first; of many neighbours, what they have in common.
    match is_only {
        true => over_time.chain(by_range).map(draw).collect(),
        false => by_range.chain(over_time).map(draw).collect(),
    }
}
