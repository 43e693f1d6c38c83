//! A folder of figures that a page shows, too.

use std::path::{Path, PathBuf};

use kuva::prelude::{Layout, Plot};
use photinus_io::Result;

use super::save;

/// A figure: what is drawn, and on which axes.
pub(crate) struct Figure {
    /// Its file name, without an ending.
    pub(crate) name: String,
    /// What is drawn.
    pub(crate) plots: Vec<Plot>,
    /// On which axes.
    pub(crate) layout: Layout,
}

/// A folder of figures.
pub(crate) struct FigureFolder(PathBuf);

impl FigureFolder {
    /// A folder that is there.
    pub(crate) fn new(folder: &Path) -> Self {
        Self(folder.to_owned())
    }

    /// Writes a figure as PNG and SVG, and gives the text of the SVG for a page, where a map of colours is of class `map`.
    ///
    /// # Errors
    /// [`Error`] when it cannot be drawn or written.
    pub(crate) fn write(&self, figure: Figure) -> Result<String> {
        let is_map = figure.plots.iter().any(|plot| matches!(plot, Plot::Heatmap(_)));
        let scene = kuva::render::render::render_multiple(figure.plots, figure.layout);
        let svg = save(&self.0, &figure.name, &scene)?;
        Ok(if is_map { svg.replacen("<svg ", "<svg class=\"map\" ", 1) } else { svg })
    }
}
