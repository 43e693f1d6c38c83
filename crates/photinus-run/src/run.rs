//! The one loop: a frame comes in, its record is filled in and handed on.
//!
//! A frame that fails is told, counted and skipped; what was handed on before it stays. So it is with a frame on which the
//! method itself panics: that is a fault of Photinus, but no reason to lose the frames after it.

use std::collections::HashSet;
use std::mem::discriminant;
use std::panic::{AssertUnwindSafe, catch_unwind};

use photinus_io::{Error, Place, Result};

use crate::{Clock, Entry, Oddity, Work, fault};

/// What stands at the end of the loop.
pub trait Outlet {
    /// Why the run ends early.
    type End;

    /// Whether the run is to end.
    fn is_over(&mut self) -> bool;

    /// Takes a frame whose record is whole, and why nothing can be found in it, if that is so.
    ///
    /// # Errors
    /// What ends the run.
    fn frame(
        &mut self,
        entry: Entry,
        oddity: Option<Oddity>,
        clock: &mut Clock,
    ) -> std::result::Result<(), Self::End>;

    /// Takes what went wrong with a frame, which is skipped.
    fn failed(&mut self, error: Error);

    /// Takes what was done differently from what a user may think, once of each kind.
    fn note(&mut self, text: String);

    /// Takes what a user should know.
    fn warn(&mut self, text: String);

    /// A frame is done, well or not.
    fn next(&mut self) {}
}

/// Takes every entry through `work`, which completes its record, and hands it on.
///
/// # Errors
/// What the outlet ends the run with.
pub fn run<O: Outlet>(
    mut entries: impl Iterator<Item = Result<Entry>>,
    work: &mut impl Work,
    outlet: &mut O,
    clock: &mut Clock,
) -> std::result::Result<(), O::End> {
    let mut told = HashSet::new();
    while !outlet.is_over() {
        clock.skip();
        let Some(read) = entries.next() else { break };
        clock.lap("reading");
        let filled = read.and_then(|mut entry| {
            for conversion in &entry.conversions {
                if told.insert(discriminant(conversion)) {
                    outlet.note(format!("{}: {conversion} (said once)", source_name(&entry)));
                }
            }
            clock.skip();
            guarded(&mut entry, clock, work)?;
            Ok(entry)
        });
        match filled {
            Ok(mut entry) => {
                let oddity = entry.image.as_ref().and_then(Oddity::of);
                if let Some(taken) = entry.taken {
                    entry.record.latency_s = Some(taken.elapsed().as_secs_f64());
                }
                outlet.frame(entry, oddity, clock)?;
                work.remarks().into_iter().for_each(|remark| outlet.warn(remark));
            }
            Err(error) => outlet.failed(error),
        }
        outlet.next();
    }
    Ok(())
}

/// Completes the record of a frame; a panic is an error of that frame.
///
/// # Errors
/// As [`Work::fill`].
pub fn guarded(entry: &mut Entry, clock: &mut Clock, work: &mut impl Work) -> Result<()> {
    // Every buffer of the method is filled anew by the next frame.
    match catch_unwind(AssertUnwindSafe(|| work.fill(entry, clock))) {
        Ok(filled) => filled,
        Err(payload) => {
            let error = Error::format(&entry.record.source, fault::told(payload.as_ref()));
            Err(error.at(Place::Frame(entry.number())).advise(fault::ADVICE))
        }
    }
}

/// What the source of a frame is called in messages.
pub fn source_name(entry: &Entry) -> &str {
    match entry.record.source.as_str() {
        "-" => "standard input",
        source => source,
    }
}
