//! Figures for a paper: how they look, and how they get onto the disk, each as PNG and SVG.

mod figure;
mod raster;
pub(crate) mod style;

use std::path::Path;

use kuva::render::render::Scene;
use photinus_io::{Error, Result};

pub(crate) use figure::{Figure, FigureFolder};

/// Pixels of a PNG for one of the SVG: sharp at the width of a column in print.
const PNG_SCALE: f32 = 2.5;

/// Writes `name`.svg and `name`.png into `folder`, and gives the text of the SVG.
///
/// # Errors
/// [`Error`] when a figure cannot be drawn or written.
pub(crate) fn save(folder: &Path, name: &str, figure: &Scene) -> Result<String> {
    let write = |name: &str, bytes: &[u8]| {
        let path = folder.join(name);
        std::fs::write(&path, bytes).map_err(|error| Error::io(&path, error))
    };
    let svg = kuva::backend::svg::SvgBackend::new().render_scene(figure);
    // With a view box a page can draw it smaller; without, it would cut it off.
    let view_box = format!("<svg viewBox=\"0 0 {} {}\" ", figure.width, figure.height);
    let svg = svg.replacen("<svg ", &view_box, 1);
    write(&format!("{name}.svg"), svg.as_bytes())?;
    let name = format!("{name}.png");
    let png = raster::png(&svg, PNG_SCALE);
    write(&name, &png.map_err(|reason| Error::format(folder.join(&name), reason))?)?;
    Ok(svg)
}
