//! Figures for a paper or a report: each a PNG and an SVG in one folder. `style` says how they look.

pub(crate) mod style;

use std::path::{Path, PathBuf};

use kuva::prelude::{Layout, Plot};
use photinus_io::{Error, Result};

/// Pixels of a PNG for one of the SVG: sharp at the width of a column in print.
const PNG_SCALE: f32 = 2.5;

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

    /// Writes a figure as PNG and SVG, and gives the text of the SVG.
    ///
    /// # Errors
    /// [`Error`] when it cannot be drawn or written.
    pub(crate) fn write(&self, figure: Figure) -> Result<String> {
        let scene = kuva::render::render::render_multiple(figure.plots, figure.layout);
        let svg = kuva::backend::svg::SvgBackend::new().render_scene(&scene);
        self.save(&format!("{}.svg", figure.name), svg.as_bytes())?;
        let name = format!("{}.png", figure.name);
        let png = kuva::RasterBackend::new().with_scale(PNG_SCALE).render_scene(&scene);
        let png = png.map_err(|reason| Error::format(self.0.join(&name), reason))?;
        self.save(&name, &png)?;
        Ok(svg)
    }

    fn save(&self, name: &str, bytes: &[u8]) -> Result<()> {
        let path = self.0.join(name);
        std::fs::write(&path, bytes).map_err(|error| Error::io(&path, error))
    }
}
