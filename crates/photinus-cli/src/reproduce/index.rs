//! The page of a reproduction: every figure that was made, with what there is to see in it and its numbers beside the paper's.

use std::path::Path;

use photinus_io::Result;
use photinus_reproduce::{Figure, Report};

use super::tables;
use crate::page::{Page, Player};

/// Writes `index.html` into `folder`.
///
/// # Errors
/// [`photinus_io::Error`] when it cannot be written.
pub(super) fn write(folder: &Path, reports: &[Report], player: Option<&Player>) -> Result<()> {
    let (within, held) = tables::held(reports);
    let page = Page::new("The founding paper, reproduced").text(&format!(
        "V. Walter, M. Saska, A. Franchi: Fast Mutual Relative Localization of UAVs using Ultraviolet LED Markers, ICUAS 2018, \
         in simulation. {within} of {held} numbers with a tolerance are within it. A number out of its tolerance is a finding, not a \
         failure: its note says why."
    ));
    let chapters: Vec<(String, String)> =
        reports.iter().map(|report| (anchor(report.figure), heading(report.figure))).collect();
    let page = reports.iter().fold(page.contents(&chapters), |page, report| of_figure(page, report, player));
    let links: Vec<(String, &str)> = reports
        .iter()
        .map(|report| (format!("figure-{}.csv", report.figure.name()), report.figure.title()))
        .collect();
    let links = [("summary.csv", "every number beside the paper's")]
        .into_iter()
        .chain(links.iter().map(|(file, title)| (file.as_str(), *title)));
    page.heading("Data").links(&links.collect::<Vec<_>>()).write(folder)
}

fn anchor(figure: Figure) -> String {
    format!("figure-{}", figure.name())
}

fn heading(figure: Figure) -> String {
    match figure.name().parse::<u32>() {
        Ok(number) => format!("Figure {number}: {}", figure.title()),
        Err(_) => capitalised(figure.title()),
    }
}

fn capitalised(words: &str) -> String {
    let mut letters = words.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}

fn of_figure(page: Page, report: &Report, player: Option<&Player>) -> Page {
    let (anchor, heading) = (anchor(report.figure), heading(report.figure));
    let page = page.chapter(&anchor, &heading);
    let page = match player.filter(|_| report.figure == Figure::Overlay) {
        Some(player) => page.player(player),
        None => page,
    };
    page.figure(&format!("{anchor}.svg"), &heading, report.figure.caption()).html(&tables::html(report))
}
