//! A plan on a page, with its figures beside it.

use std::path::Path;

use photinus_io::{Error, Result};
use photinus_plan::Plan;

use super::{figures, told};
use crate::page::Page;
use crate::plots::FigureFolder;

/// Writes page, figures and `plan.json` into `folder`.
///
/// # Errors
/// [`Error`] when something cannot be written.
pub(super) fn write(folder: &Path, plan: &Plan) -> Result<()> {
    let mut page = Page::new("A set-up, planned")
        .text("The least errors that the light and the pixels allow. Whether plans hold: docs/planning.md.")
        .lines(&told::ranges(plan))
        .heading("Over distance and heading");
    let figure_folder = FigureFolder::new(folder);
    for figures::Drawn { figure, caption } in figures::all(plan) {
        let name = figure.name.clone();
        page = page.svg(&figure_folder.write(figure)?, &name, caption);
    }
    page = page.lines(&told::over_distance(plan)).heading("Layouts").lines(&told::layouts(plan));
    if let Some(battery) = &plan.battery {
        page = page.heading("Battery").text(&told::battery(battery));
    }
    page = page.heading("Eyes").text(&told::eyes(&plan.eyes));
    let path = folder.join("plan.json");
    let json = serde_json::to_string_pretty(plan).map_err(|error| Error::format(&path, error.to_string()))?;
    std::fs::write(&path, json + "\n").map_err(|error| Error::io(&path, error))?;
    page.heading("Data").links(&[("plan.json", "every number")]).write(folder)
}
