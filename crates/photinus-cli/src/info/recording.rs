//! MCAP recordings, and bags of ROS 1.

use std::path::Path;

use photinus_io::Result;
use photinus_link::bag::{self, Bag};
use photinus_link::poses::pose_topics;
use photinus_link::recording::{Recording, Topic, image_topics};

use super::Report;
use crate::aligned::{Aligned, Side};

pub(super) fn mcap(path: &Path) -> Result<Report> {
    let recording = Recording::open(path)?;
    let mut report = Report::new("an MCAP recording");
    let images = image_topics(&recording);
    report.fact("images", listed(images.iter().map(|topic| topic.name.as_str())));
    tell(&mut report, recording.topics(), recording.span_ns());
    Ok(report)
}

pub(super) fn of_ros1(path: &Path) -> Result<Report> {
    let bag = Bag::open(path)?;
    let mut report = Report::new("a bag of ROS 1");
    let images = bag::image_topics(&bag);
    report.fact("images", listed(images.iter().map(|topic| topic.name.as_str())));
    tell(&mut report, bag.topics(), bag.span_ns());
    Ok(report)
}

/// Which topics there are, for how long, and which of them carry poses.
fn tell(report: &mut Report, topics: Vec<Topic>, span_ns: Option<(u64, u64)>) {
    let poses: Vec<Topic> = pose_topics(topics.clone()).collect();
    report.fact("poses", listed(poses.iter().map(|topic| topic.name.as_str())));
    if let Some((from_ns, to_ns)) = span_ns {
        report.fact("duration", format!("{:.1} s", to_ns.saturating_sub(from_ns) as f64 * 1e-9));
    }
    let mut table = Aligned::new(2, &[Side::Left, Side::Left, Side::Right]);
    table.row(["topic".to_owned(), "message".to_owned(), "count".to_owned()]);
    for topic in topics {
        let count = topic.messages.map_or_else(|| "?".to_owned(), |count| count.to_string());
        table.row([topic.name, topic.kind, count]);
    }
    report.tables.push(table);
}

fn listed<'a>(names: impl Iterator<Item = &'a str>) -> String {
    let names = names.collect::<Vec<_>>().join(", ");
    if names.is_empty() { "none".to_owned() } else { names }
}
