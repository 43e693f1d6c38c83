//! Scores as figures for a paper: each a PNG and an SVG.
//!
//! ```text
//! by_range   a number over distance: recall, centre, bearing, distance, bounds, NEES, l_A and l_B
//! over_time  the distance of one neighbour: truth, estimate, bounds, l_A and l_B
//! ```

mod by_range;
mod over_time;

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use kuva::prelude::{Layout, Plot};
use photinus_evaluate::Evaluation;
use photinus_io::dataset::TruthFrame;
use photinus_io::{Error, Result};

/// A figure: what is drawn, and on which axes.
struct Figure {
    name: String,
    plots: Vec<Plot>,
    layout: Layout,
}

/// A folder of figures.
pub(crate) struct PlotFolder(PathBuf);

impl PlotFolder {
    /// Makes the folder.
    ///
    /// # Errors
    /// [`Error`] when it cannot be made.
    pub(crate) fn create(folder: &Path) -> Result<Self> {
        std::fs::create_dir_all(folder).map_err(|error| {
            Error::io(folder, error).advise("name a folder that can be made and written to")
        })?;
        Ok(Self(folder.to_owned()))
    }

    /// Draws every figure for which there is something to show.
    ///
    /// # Errors
    /// [`Error`] when a figure cannot be drawn or written.
    pub(crate) fn draw(&self, evaluation: &Evaluation<'_>, truth: &[TruthFrame]) -> Result<()> {
        let neighbours: BTreeSet<u32> =
            truth.iter().flat_map(|frame| &frame.neighbours).map(|neighbour| neighbour.id).collect();
        let over_time = neighbours.into_iter().filter_map(|id| over_time::distance(id, evaluation, truth));
        by_range::figures(evaluation).into_iter().chain(over_time).try_for_each(|figure| self.write(figure))
    }

    fn write(&self, figure: Figure) -> Result<()> {
        let scene = kuva::render::render::render_multiple(figure.plots, figure.layout);
        crate::plots::save(&self.0, &figure.name, &scene).map(drop)
    }
}
