//! Figures for a paper: how they look, and how they get onto the disk, each as PNG and SVG.

mod figure;
pub(crate) mod style;

use std::path::Path;

use kuva::render::render::Scene;
use photinus_io::{Error, Result};

pub(crate) use figure::{Figure, FigureFolder};

/// Pixels of a PNG for one of the SVG: sharp at the width of a column in print.
const PNG_SCALE: f32 = 2.5;

/// Writes `name`.svg and `name`.png into `folder`.
///
/// # Errors
/// [`Error`] when a figure cannot be drawn or written.
pub(crate) fn save(folder: &Path, name: &str, figure: &Scene) -> Result<()> {
    let write = |name: &str, bytes: &[u8]| {
        let path = folder.join(name);
        std::fs::write(&path, bytes).map_err(|error| Error::io(&path, error))
    };
    write(&format!("{name}.svg"), kuva::backend::svg::SvgBackend::new().render_scene(figure).as_bytes())?;
    let name = format!("{name}.png");
    let png = kuva::RasterBackend::new().with_scale(PNG_SCALE).render_scene(figure);
    write(&name, &png.map_err(|reason| Error::format(folder.join(&name), reason))?)
}
