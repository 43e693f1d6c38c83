//! Scores and their figures on a page.

use std::path::Path;

use photinus_io::Result;

use super::Drawn;
use crate::page::Page;

/// Writes `index.html` into the folder of the figures; `tables` are what the terminal shows.
///
/// # Errors
/// [`photinus_io::Error`] when it cannot be written.
pub(crate) fn write(folder: &Path, results: &Path, tables: &str, figures: &[Drawn]) -> Result<()> {
    let page = Page::new("Results beside ground truth")
        .text(&format!("{}, frame by frame, beside where everything truly was.", results.display()))
        .lines(tables);
    with_figures(page, "", figures).write(folder)
}

/// The page with these figures, which lie in `folder`, named from that of the page.
pub(crate) fn with_figures(page: Page, folder: &str, figures: &[Drawn]) -> Page {
    figures.iter().fold(page, |page, drawn| {
        page.figure(&format!("{folder}{}.svg", drawn.name), &drawn.title, drawn.caption)
    })
}
