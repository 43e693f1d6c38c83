//! The grid as it was found, drawn over the photo that shows most of it.

use std::fmt::Write;
use std::path::Path;

use photinus_io::Result;
use photinus_io::image::{read_image, write_png};

use crate::calibrate::report::{CameraReport, ResidualReport};
use crate::page::escaped;

/// The photo beside the page.
const PHOTO: &str = "found.png";

/// Writes the photo into `folder`, and gives it with the grid over it as HTML; nothing where there is no photo, as with a table of
/// corners.
///
/// # Errors
/// [`photinus_io::Error`] when the photo cannot be written.
pub(super) fn html(folder: &Path, report: &CameraReport) -> Result<String> {
    let leds = |photo: usize| report.residuals.iter().filter(move |led| led.photo == photo);
    let Some(best) = (0..report.photos.len()).max_by_key(|&photo| (leds(photo).count(), usize::MAX - photo))
    else {
        return Ok(String::new());
    };
    let name = &report.photos[best].name;
    let Ok(file) = read_image(name) else { return Ok(String::new()) };
    write_png(folder.join(PHOTO), &file.image.view())?;
    let leds: Vec<&ResidualReport> = leds(best).collect();
    let (width, height) = (report.width_px, report.height_px);
    let radius = width as f64 / 120.0;
    let mut svg = format!(
        "<svg class=\"photo\" viewBox=\"-0.5 -0.5 {width} {height}\"><image href=\"{PHOTO}\" x=\"-0.5\" y=\"-0.5\" width=\"{width}\" \
         height=\"{height}\"/><g fill=\"none\" stroke=\"#56B4E9\" stroke-width=\"{:.2}\">",
        radius / 4.0
    );
    let mut line = |mut run: Vec<&ResidualReport>, along: fn(&ResidualReport) -> usize| {
        run.sort_by_key(|led| along(led));
        let points: Vec<String> = run.iter().map(|led| format!("{:.1},{:.1}", led.u_px, led.v_px)).collect();
        // Writing to a String cannot fail.
        let _ = write!(svg, "<polyline points=\"{}\"/>", points.join(" "));
    };
    for row in 0..report.grid_rows {
        line(leds.iter().copied().filter(|led| led.row == row).collect(), |led| led.column);
    }
    for column in 0..report.grid_columns {
        line(leds.iter().copied().filter(|led| led.column == column).collect(), |led| led.row);
    }
    for led in &leds {
        let _ = write!(svg, "<circle cx=\"{:.1}\" cy=\"{:.1}\" r=\"{radius:.1}\"/>", led.u_px, led.v_px);
    }
    svg += "</g>";
    if let Some(first) = leds.iter().find(|led| led.row == 0 && led.column == 0) {
        let _ = write!(
            svg,
            "<circle cx=\"{:.1}\" cy=\"{:.1}\" r=\"{:.1}\" fill=\"none\" stroke=\"#E69F00\" stroke-width=\"{:.2}\"/>",
            first.u_px,
            first.v_px,
            1.8 * radius,
            radius / 3.0
        );
    }
    let file_name = Path::new(name).file_name().map_or(name.into(), |name| name.to_string_lossy());
    Ok(format!(
        "<figure>\n<h3>The grid as it was found</h3>\n{svg}</svg>\n<figcaption>{}: each LED that is used, rows and columns joined; the \
         orange circle is LED 0, 0.</figcaption>\n</figure>\n",
        escaped(&file_name)
    ))
}
