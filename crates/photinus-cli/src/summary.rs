//! What a run found, in a few lines.

use std::collections::BTreeMap;

use photinus_io::results::FrameRecord;

use crate::aligned::{Aligned, Side};
use photinus_run::Clock;
use photinus_run::Oddity;
use photinus_run::Quantiles;

/// Reasons of rejection that are told apart; spots of other programs may bring any number.
const MOST_REASONS: usize = 32;

/// What was counted over the frames of a run.
#[derive(Debug, Default)]
pub(crate) struct Summary {
    /// Frames that could not be read or worked on.
    pub(crate) failed: u64,
    frames: u64,
    spots: usize,
    /// Those of them that are less likely markers than clutter.
    unlikely: usize,
    rejected: BTreeMap<String, usize>,
    neighbours: usize,
    frames_with_neighbours: u64,
    incomplete: u64,
    distances_m: Quantiles,
    odd: BTreeMap<&'static str, u64>,
    span_s: Option<(f64, f64)>,
}

impl Summary {
    /// Counts a frame.
    pub(crate) fn count(&mut self, record: &FrameRecord) {
        self.frames += 1;
        self.spots += record.spots.len();
        self.unlikely += record.spots.iter().filter(|spot| spot.marker_log_odds < 0.0).count();
        for rejected in &record.rejected {
            let is_new = !self.rejected.contains_key(&rejected.reason);
            let others = is_new && self.rejected.len() >= MOST_REASONS;
            let reason = if others { "others" } else { &rejected.reason };
            *self.rejected.entry(reason.to_owned()).or_default() += 1;
        }
        self.neighbours += record.neighbours.len();
        self.frames_with_neighbours += u64::from(!record.neighbours.is_empty());
        self.incomplete += u64::from(record.incomplete);
        let estimates = record.neighbours.iter().filter_map(|neighbour| neighbour.distance_m.estimate);
        estimates.for_each(|distance_m| self.distances_m.add(distance_m));
    }

    /// Counts a frame in which nothing can be found; whether it is the first of its kind.
    pub(crate) fn count_odd(&mut self, oddity: Oddity) -> bool {
        let count = self.odd.entry(oddity.kind()).or_default();
        *count += 1;
        *count == 1
    }

    /// When the first and the last frame were taken, s.
    pub(crate) fn span(&mut self, first_s: f64, last_s: f64) {
        self.span_s = Some((first_s, last_s));
    }

    /// Frames that came through.
    pub(crate) fn frames(&self) -> u64 {
        self.frames
    }

    /// What was counted, without times.
    pub(crate) fn counts(&self, indent: usize) -> Aligned {
        let mut table = Aligned::new(indent, &[]);
        let frames = match self.failed {
            0 => self.frames.to_string(),
            failed => format!("{} done, {failed} failed", self.frames),
        };
        table.row(["frames".to_owned(), frames]);
        if self.frames == 0 {
            return table;
        }
        if let Some((first_s, last_s)) = self.span_s {
            table.row(["time".to_owned(), format!("{first_s:.3} to {last_s:.3} s")]);
        }
        table.row(["spots".to_owned(), format!("{}{}{}", self.spots, self.per_frame(), self.unlikely())]);
        table.row(["rejected".to_owned(), self.reasons()]);
        for (kind, count) in &self.odd {
            table.row(["odd".to_owned(), format!("{count} frames are {kind}: nothing can be found in them")]);
        }
        if self.incomplete > 0 {
            let told = format!(
                "frames that held more than the budget: {}; --budget allows for more",
                self.incomplete
            );
            table.row(["incomplete".to_owned(), told]);
        }
        if self.neighbours > 0 {
            let seen = format!("{} in {} of the frames", self.neighbours, self.frames_with_neighbours);
            table.row(["neighbours".to_owned(), seen]);
        }
        if let Some(text) = self.distances() {
            table.row(["distance".to_owned(), text]);
        }
        table
    }

    /// What was counted, and the time per frame of each stage.
    pub(crate) fn text(&self, clock: &Clock) -> String {
        let mut times = Aligned::new(0, &[Side::Left, Side::Right, Side::Right, Side::Right, Side::Right]);
        times.row(["ms per frame", "p50", "p99", "p99.9", "longest"]);
        for stage in clock.stages() {
            let laps = &stage.laps_ms;
            let told = [laps.at(0.5), laps.at(0.99), laps.at(0.999), laps.largest()];
            let [p50, p99, p999, longest] = told.map(|ms| ms.map_or(String::new(), |ms| format!("{ms:.2}")));
            times.row([format!("  {}", stage.name), p50, p99, p999, longest]);
        }
        match self.frames {
            0 => self.counts(0).to_string(),
            _ => format!("{}\n{times}", self.counts(0)),
        }
    }

    fn per_frame(&self) -> String {
        match self.frames {
            0 | 1 => String::new(),
            frames => format!(", {:.1} per frame", self.spots as f64 / frames as f64),
        }
    }

    fn unlikely(&self) -> String {
        match self.unlikely {
            0 => String::new(),
            unlikely => format!("; {unlikely} more likely clutter than markers"),
        }
    }

    fn reasons(&self) -> String {
        let all: usize = self.rejected.values().sum();
        let reasons: Vec<String> =
            self.rejected.iter().map(|(reason, count)| format!("{count} {reason}")).collect();
        match reasons.as_slice() {
            [] => "none".to_owned(),
            [one] => one.clone(),
            several => format!("{all}: {}", several.join(", ")),
        }
    }

    fn distances(&self) -> Option<String> {
        let distances = &self.distances_m;
        let (first, last) = (distances.smallest()?, distances.largest()?);
        Some(match (distances.count(), distances.at(0.5)) {
            (2.., Some(median)) => format!("median {median:.2} m, from {first:.2} to {last:.2} m"),
            _ => format!("{first:.2} m"),
        })
    }
}
