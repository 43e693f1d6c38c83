//! The report as a page that opens anywhere: one file, its figures within; each figure also as PNG and SVG beside it.
//!
//! ```text
//! found       the grid in the photo that shows most of it
//! residuals   how far LEDs are from where they are expected: by photo, by LED, over the image, as a histogram; models; the board
//! field       how sure bearings are over the image and by the angle off the axis; what two halves of the photos differ by; coverage
//! tables      what is told in words and numbers
//! ```

mod field;
mod found;
mod image;
mod residuals;
mod tables;

use std::path::Path;

use photinus_io::Result;

use super::report::CameraReport;
use crate::page::Page;
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
    let mut page =
        Page::new("Calibration of a camera").html(&tables::told(report)).html(&tables::warnings(report));
    page = page.html(&found::html(folder, report)?);
    for Shown { title, caption, mut figure } in
        residuals::figures(report).into_iter().chain(field::figures(report))
    {
        let name = figure.name.clone();
        figure.layout = figure.layout.with_title(title);
        page = page.svg(&figures.write(figure)?, &name, &caption);
    }
    page.heading("Parameters")
        .text(&format!(
            "As the camera file has them, with their standard deviations, which are raised {:.2} times above those of independent \
             residuals (measured: {:.2}).",
            report.inflation, report.inflation_measured
        ))
        .html(&tables::parameters(report))
        .heading("Photos")
        .html(&tables::photos(report))
        .heading("LEDs left out")
        .html(&tables::outliers(report))
        .write(folder)
}
