//! Results and spot curves.

use std::path::Path;

use photinus_io::Result;
use photinus_io::dataset::read_truth;
use photinus_io::results::read_results;
use photinus_io::spot_curve::{SpotCurveFile, read_spot_curve};

use super::Report;
use crate::aligned::{Aligned, Side};
use crate::summary::Summary;

/// After this many bad lines the others are only counted.
const REPORTED_LINES: u64 = 5;

pub(super) fn results(path: &Path) -> Result<Report> {
    let mut report = Report::new("results, or spots in place of frames");
    let mut summary = Summary::default();
    let mut times_s: Option<(f64, f64)> = None;
    for record in read_results(path)? {
        match record {
            Ok(record) => {
                summary.count(&record);
                if let Some(time_s) = record.time_s {
                    let (first_s, last_s) = times_s.unwrap_or((time_s, time_s));
                    times_s = Some((first_s.min(time_s), last_s.max(time_s)));
                }
            }
            Err(error) => {
                summary.failed += 1;
                report.is_broken = true;
                if summary.failed <= REPORTED_LINES {
                    report.notes.push(error.to_string());
                }
            }
        }
    }
    if let Some((first_s, last_s)) = times_s {
        summary.span(first_s, last_s);
    }
    report.facts = summary.counts(2);
    Ok(report)
}

/// Where everything was, frame by frame.
pub(super) fn truth(path: &Path) -> Result<Report> {
    let frames = read_truth(path)?;
    let mut report = Report::new("ground truth");
    report.fact("frames", frames.len().to_string());
    if let (Some(first), Some(last)) = (frames.first(), frames.last()) {
        report.fact("time", format!("{:.3} to {:.3} s", first.time_s, last.time_s));
    }
    let neighbours = || frames.iter().flat_map(|frame| &frame.neighbours);
    report.fact("neighbours", format!("{} over all frames", neighbours().count()));
    let (near_m, far_m) = neighbours()
        .map(|neighbour| neighbour.distance_m)
        .fold((f64::INFINITY, 0.0_f64), |(near_m, far_m), m| (near_m.min(m), far_m.max(m)));
    if near_m <= far_m {
        report.fact("distance", format!("{near_m:.2} to {far_m:.2} m"));
    }
    Ok(report)
}

pub(super) fn spot_curve(path: &Path) -> Result<Report> {
    let SpotCurveFile { curve, exposure_us, threshold } = read_spot_curve(path)?;
    let mut report = Report::new("a curve of spot sizes");
    let known = |value: Option<String>| value.unwrap_or_else(|| "not stated".to_owned());
    report.fact("exposure", known(exposure_us.map(|us| format!("{us} us"))));
    report.fact("threshold", known(threshold.map(|level| level.to_string())));
    let mut table = Aligned::new(2, &[Side::Right; 3]);
    table.row(["distance m", "smallest px", "largest px"]);
    for distance_m in [0.5, 1.0, 2.0, 4.0, 8.0, 16.0] {
        let (smallest, largest) = (curve.min_area_px(distance_m), curve.max_area_px(distance_m));
        table.row([distance_m.to_string(), smallest.to_string(), largest.to_string()]);
    }
    report.tables.push(table);
    Ok(report)
}
