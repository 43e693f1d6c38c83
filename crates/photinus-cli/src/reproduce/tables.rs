//! Series and rows as CSV, and the summary as a table to read (Markdown, as docs/reproduction.md holds it).

use std::fmt::Write as _;
use std::path::Path;

use photinus_io::Result;
use photinus_reproduce::{Report, Row};

use super::refuse;
use crate::page::escaped;

/// Digits that a number of the summary keeps.
const DIGITS: i32 = 4;

/// Writes every series of a report, a line per point.
///
/// # Errors
/// [`photinus_io::Error`] when the file cannot be written.
pub(super) fn save_data(folder: &Path, report: &Report) -> Result<()> {
    let mut text = "panel,series,x,y\n".to_owned();
    for panel in &report.panels {
        for series in panel.series.iter().filter(|series| !series.label.is_empty()) {
            let head = format!("{},{}", quoted(panel.title), quoted(&series.label));
            for (x, y) in &series.points {
                // nothing can go wrong when writing to a string
                let _ = writeln!(text, "{head},{x},{y}");
            }
        }
    }
    save(&folder.join(format!("figure-{}.csv", report.figure.name())), &text)
}

/// Writes summary.csv.
///
/// # Errors
/// [`photinus_io::Error`] when the file cannot be written.
pub(super) fn save_summary(folder: &Path, reports: &[Report]) -> Result<()> {
    let mut text = "quantity,paper,reproduced,ratio,tolerance,within,note\n".to_owned();
    for (report, row) in rows(reports) {
        let quantity = format!("{}: {}", report.figure.name(), row.quantity);
        let cells = [quoted(&quantity)].into_iter().chain(cells(row)).chain([quoted(&row.note)]);
        text.push_str(&cells.collect::<Vec<_>>().join(","));
        text.push('\n');
    }
    save(&folder.join("summary.csv"), &text)
}

/// The summary as a table, and how many rows are within their tolerance.
pub(super) fn to_read(reports: &[Report]) -> String {
    let mut text = "| figure | quantity | paper | reproduced | ratio | tolerance | within | note |\n\
                    |---|---|---|---|---|---|---|---|\n"
        .to_owned();
    for (report, row) in rows(reports) {
        let head = [report.figure.name().to_owned(), row.quantity.clone()];
        let cells = head.into_iter().chain(cells(row)).chain([row.note.to_string()]);
        // nothing can go wrong when writing to a string
        let _ = writeln!(text, "| {} |", cells.collect::<Vec<_>>().join(" | "));
    }
    let (within, held) = held(reports);
    let _ = writeln!(text, "\n{within} of {held} numbers with a tolerance are within it.");
    text
}

/// How many numbers are within their tolerance, and how many have one.
pub(super) fn held(reports: &[Report]) -> (usize, usize) {
    let held: Vec<bool> = rows(reports).filter_map(|(_, row)| row.is_within()).collect();
    (held.iter().filter(|within| **within).count(), held.len())
}

/// The numbers of a figure as a table of a page.
pub(super) fn html(report: &Report) -> String {
    if report.rows.is_empty() {
        return String::new();
    }
    let heads = ["quantity", "paper", "reproduced", "ratio", "tolerance", "within", "note"];
    let head: String = heads.iter().map(|head| format!("<th>{head}</th>")).collect();
    let row = |row: &Row| {
        let cells = [row.quantity.clone()].into_iter().chain(cells(row)).chain([row.note.to_string()]);
        let cells: String = cells.map(|cell| format!("<td>{}</td>", escaped(&cell))).collect();
        format!("<tr>{cells}</tr>\n")
    };
    let rows: String = report.rows.iter().map(row).collect();
    format!("<div class=\"wide\"><table class=\"worded\">\n<tr>{head}</tr>\n{rows}</table></div>")
}

fn rows(reports: &[Report]) -> impl Iterator<Item = (&Report, &Row)> {
    reports.iter().flat_map(|report| report.rows.iter().map(move |row| (report, row)))
}

/// Paper, reproduced, ratio, tolerance, within.
fn cells(row: &Row) -> [String; 5] {
    let number = |value: Option<f64>| value.map_or(String::new(), significant);
    let within = match row.is_within() {
        Some(true) => "yes",
        Some(false) => "NO",
        None => "",
    };
    [
        number(row.paper),
        significant(row.reproduced),
        number(row.ratio()),
        row.tolerance.to_string(),
        within.to_owned(),
    ]
}

/// A number with a few significant digits and no more.
fn significant(value: f64) -> String {
    if value.is_nan() {
        return "none".to_owned();
    }
    let magnitude = if value.abs() > 0.0 { libm::log10(value.abs()).floor() as i32 } else { 0 };
    let decimals = (DIGITS - 1 - magnitude).clamp(0, 9) as usize;
    let text = format!("{value:.decimals$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

/// A cell of CSV.
fn quoted(text: &str) -> String {
    if text.contains([',', '"', '\n']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}

fn save(path: &Path, text: &str) -> Result<()> {
    std::fs::write(path, text).map_err(|error| refuse(path, error))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_keep_four_digits() {
        for (value, text) in [
            (31.4704, "31.47"),
            (1.0, "1"),
            (0.0, "0"),
            (-0.0154, "-0.0154"),
            (1234.56, "1235"),
            (f64::NAN, "none"),
            (f64::INFINITY, "inf"),
            (1e300, &format!("{:.0}", 1e300)),
            (1e-30, "0"),
        ] {
            assert_eq!(significant(value), text, "{value}");
        }
    }

    #[test]
    fn cells_with_commas_are_quoted() {
        assert_eq!(quoted("a \"b\", c"), "\"a \"\"b\"\", c\"");
        assert_eq!(quoted("plain"), "plain");
    }
}
