//! The report as a page that opens anywhere: one file, its figures within; each figure also as PNG and SVG beside it.
//!
//! ```text
//! residuals   how far LEDs are from where they are expected: by photo, by LED, over the image, as a histogram; models; the board
//! field       how sure bearings are over the image and by the angle off the axis; what two halves of the photos differ by; coverage
//! tables      what is told in words and numbers
//! ```

mod field;
mod image;
mod residuals;
mod tables;

use std::path::Path;

use photinus_io::{Error, Result};

use super::report::CameraReport;
use crate::plots::{Figure, FigureFolder};

/// A figure with what there is to see in it.
struct Shown {
    title: &'static str,
    caption: String,
    figure: Figure,
}

/// Writes `index.html` and the figures into `folder`.
///
/// # Errors
/// [`Error`] when something cannot be drawn or written.
pub(super) fn write(folder: &Path, report: &CameraReport) -> Result<()> {
    let figures = FigureFolder::new(folder);
    let mut sections = String::new();
    for Shown { title, caption, mut figure } in
        residuals::figures(report).into_iter().chain(field::figures(report))
    {
        let name = figure.name.clone();
        figure.layout = figure.layout.with_title(title);
        // Names of clip paths would be the same in every figure of the page.
        let svg = figures.write(figure)?.replace("kuva-clip-", &format!("{name}-"));
        sections +=
            &format!("<figure>\n{svg}\n<figcaption>{}</figcaption>\n</figure>\n", tables::escaped(&caption));
    }
    let page = include_str!("page.html")
        .replace("{told}", &tables::told(report))
        .replace("{warnings}", &tables::warnings(report))
        .replace("{inflation}", &format!("{:.2}", report.inflation))
        .replace("{measured}", &format!("{:.2}", report.inflation_measured))
        .replace("{parameters}", &tables::parameters(report))
        .replace("{photos}", &tables::photos(report))
        .replace("{outliers}", &tables::outliers(report))
        .replace("{figures}", &sections);
    let path = folder.join("index.html");
    std::fs::write(&path, page).map_err(|error| Error::io(&path, error))
}
