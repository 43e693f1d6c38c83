//! Frames of several files in the order of their times: what is fast and drops nothing.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use photinus_io::{Error, Result};

use super::lane::Lane;
use crate::Entry;
use crate::source::{Next, Source};

/// Frames of several sources, the earliest first; of the same time, in the order of the sources. Those that a run followed together come as it took them in.
pub(super) struct Merged {
    sources: Vec<Box<dyn Source>>,
    lanes: Vec<Arc<Lane>>,
    /// What each source gives next; `None` when it has ended.
    heads: Vec<Option<Result<Entry>>>,
    /// Which source the last frame was of.
    at: Arc<AtomicUsize>,
}

impl Merged {
    pub(super) fn new(
        mut sources: Vec<Box<dyn Source>>,
        lanes: Vec<Arc<Lane>>,
        at: Arc<AtomicUsize>,
    ) -> Self {
        let heads = sources.iter_mut().map(|source| head(source.as_mut())).collect();
        Self { sources, lanes, heads, at }
    }
}

impl Iterator for Merged {
    type Item = Result<Entry>;

    fn next(&mut self) -> Option<Self::Item> {
        let time_s = |head: &Result<Entry>| match head {
            Ok(entry) => entry.record.time_s.unwrap_or(f64::NEG_INFINITY),
            // What is wrong is told when its turn would have come at the latest.
            Err(_) => f64::NEG_INFINITY,
        };
        let there =
            self.heads.iter().enumerate().filter_map(|(number, head)| Some((number, time_s(head.as_ref()?))));
        let (earliest, _) = there.min_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0)))?;
        let order = |number: usize| self.heads[number].as_ref()?.as_ref().ok()?.moved.together;
        let of_run = (0..self.heads.len()).filter_map(|number| Some((order(number)?.order, number))).min();
        let number = order(earliest).and(of_run).map_or(earliest, |(_, number)| number);
        // The frame that is given now was exposed before this was wished for.
        if let Some(exposure_us) = self.lanes[number].slot.take_wish() {
            let _ = self.sources[number].expose(exposure_us);
        }
        let next = head(self.sources[number].as_mut());
        self.at.store(number, Ordering::Relaxed);
        let entry = std::mem::replace(&mut self.heads[number], next)?;
        Some(entry.map(|mut entry| {
            entry.camera = number;
            entry.record.camera = Some(self.lanes[number].name.clone());
            entry
        }))
    }
}

/// What a source gives next. One that is lost has ended: of files nothing comes back.
fn head(source: &mut dyn Source) -> Option<Result<Entry>> {
    match source.next() {
        Next::Frame(entry) => Some(Ok(entry)),
        Next::Bad(error) | Next::Lost(error) => Some(Err::<_, Error>(error)),
        Next::End => None,
    }
}
