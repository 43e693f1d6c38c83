//! MCAP recordings.

use std::path::Path;

use photinus_io::Result;
use photinus_link::recording::{Recording, image_topics};

use super::Report;
use crate::aligned::{Aligned, Side};

pub(super) fn report(path: &Path) -> Result<Report> {
    let recording = Recording::open(path)?;
    let mut report = Report::new("an MCAP recording");
    let images = image_topics(&recording);
    let names = images.iter().map(|topic| topic.name.as_str()).collect::<Vec<_>>().join(", ");
    report.fact("images", if names.is_empty() { "none".to_owned() } else { names });
    let mut table = Aligned::new(2, &[Side::Left, Side::Left, Side::Right]);
    table.row(["topic".to_owned(), "message".to_owned(), "count".to_owned()]);
    for topic in recording.topics() {
        let count = topic.messages.map_or_else(|| "?".to_owned(), |count| count.to_string());
        table.row([topic.name, topic.kind, count]);
    }
    report.tables.push(table);
    Ok(report)
}
