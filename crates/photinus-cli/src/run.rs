//! The loop that detect and locate share: a frame comes in, its record is filled in, written and counted.
//!
//! A frame that fails is reported, counted and skipped; what was written before it stays. So it is with a frame on which the
//! method itself panics: that is a fault of Photinus, but no reason to lose the frames after it.

use std::collections::HashSet;
use std::mem::discriminant;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use photinus_io::image::Conversion;
use photinus_io::{Error, Place, Result};

use crate::clock::Clock;
use crate::failure::Failure;
use crate::fault;
use crate::input::{Entries, Entry, Input};
use crate::interrupt;
use crate::odd_frame::Oddity;
use crate::output::{Claimed, Outputs};
use crate::resume::Done;
use crate::summary::Summary;
use crate::terminal::{Terminal, input_name};

/// After so many failed frames the others are only counted: the first ones say what is wrong.
const REPORTED_FAILURES: u64 = 10;

/// What is done with frames.
pub(crate) trait Work {
    /// Completes the record of a frame.
    ///
    /// # Errors
    /// Those of the method, told of the frame.
    fn fill(&mut self, entry: &mut Entry, clock: &mut Clock) -> Result<()>;

    /// Whether frames still tell something of their camera.
    fn learns(&self) -> bool;

    /// Learns from a frame what [`Self::fill`] would have learnt; what that refuses teaches nothing.
    fn learn(&mut self, entry: &mut Entry);

    /// What a user should know of the frame.
    fn remarks(&mut self) -> Vec<String> {
        Vec::new()
    }
}

/// Takes every frame of `input` through `work`, which completes its record, and writes it. What is `done` is skipped, once nothing is left to
/// learn from it; its last frame is made once more, to see that this run finds the same.
pub(crate) fn run(
    input: Input,
    outputs: Claimed,
    done: Option<&Done>,
    terminal: &mut Terminal,
    work: &mut impl Work,
) -> std::result::Result<(), Failure> {
    let (mut summary, mut clock, mut told) = (Summary::default(), Clock::new(), HashSet::new());
    let mut entries = input.entries;
    let again = match done {
        Some(done) => Some(go_on(done, &mut entries, &mut clock, work)?),
        None => None,
    };
    let mut outputs = outputs.open(done).map_err(Failure::input)?;
    terminal.start(input.count);
    if let Some(again) = again {
        outputs.write(&again, &mut clock, terminal)?;
        terminal.note(format_args!("{}: goes on after frame {}", place(&outputs), number(&again)));
    }
    while !interrupt::is_asked() {
        clock.skip();
        let Some(read) = entries.next() else { break };
        clock.lap("reading");
        let filled = read.and_then(|mut entry| {
            tell_conversions(&entry, &mut told, terminal);
            clock.skip();
            guarded(&mut entry, &mut clock, work)?;
            Ok(entry)
        });
        match filled {
            Ok(entry) => {
                outputs.write(&entry, &mut clock, terminal)?;
                tell_oddity(&entry, &mut summary, terminal);
                work.remarks().iter().for_each(|remark| terminal.warning(remark));
                summary.count(&entry.record);
            }
            Err(error) => {
                summary.failed += 1;
                if summary.failed <= REPORTED_FAILURES {
                    terminal.error(&error);
                }
            }
        }
        terminal.frame_done();
    }
    interrupt::look_away();
    terminal.finish();
    if summary.failed > REPORTED_FAILURES {
        terminal.error(format_args!("{} more frames failed", summary.failed - REPORTED_FAILURES));
    }
    let resumed = done.is_some();
    if summary.frames() > 0 || summary.failed > 0 || !resumed {
        terminal.summary(summary.text(&clock));
    }
    if interrupt::is_asked() {
        return Err(interrupted(&summary, &outputs));
    }
    match summary.failed {
        0 if summary.frames() == 0 && !resumed => {
            Err(Failure::Input(format!("{}: it holds no frame", input.name)))
        }
        0 if outputs.failed() => Err(Failure::Output),
        0 => Ok(()),
        _ => Err(Failure::Frames { all: summary.frames() == 0 && !resumed }),
    }
}

/// Learns from what is done, skips the rest of it and makes its last frame once more.
fn go_on(
    done: &Done,
    entries: &mut Entries,
    clock: &mut Clock,
    work: &mut impl Work,
) -> std::result::Result<Entry, Failure> {
    loop {
        if !work.learns() {
            entries.skip_to(done.frame());
        }
        let Some(read) = entries.next() else { return Err(done.never_reached()) };
        let Ok(mut entry) = read else { continue };
        if done.is_last(&entry.record) {
            guarded(&mut entry, clock, work).map_err(Failure::input)?;
            done.check(&entry.record)?;
            return Ok(entry);
        }
        if work.learns() {
            // What the method refused, or failed on, was told by the run before.
            let _ = catch_unwind(AssertUnwindSafe(|| work.learn(&mut entry)));
        }
    }
}

/// A panic on a frame is an error of that frame.
fn guarded(entry: &mut Entry, clock: &mut Clock, work: &mut impl Work) -> Result<()> {
    // Every buffer of the method is filled anew by the next frame.
    match catch_unwind(AssertUnwindSafe(|| work.fill(entry, clock))) {
        Ok(filled) => filled,
        Err(payload) => {
            let error = Error::format(&entry.record.source, fault::told(payload.as_ref()));
            Err(error.at(Place::Frame(number(entry))).advise(fault::ADVICE))
        }
    }
}

/// What was done before the run was ended, and how to go on.
fn interrupted(summary: &Summary, outputs: &Outputs) -> Failure {
    let done = format!("interrupted after {} frames", summary.frames());
    Failure::Interrupted(match outputs.results() {
        Some(path) => format!("{done}; {} holds them, --resume goes on after them", path.display()),
        None => done,
    })
}

fn place(outputs: &Outputs) -> String {
    outputs.results().map_or("results".to_owned(), |path| path.display().to_string())
}

fn number(entry: &Entry) -> u64 {
    entry.record.frame.unwrap_or_default()
}

/// Says of the first frame of a kind why nothing can be found in it; the summary counts the others.
fn tell_oddity(entry: &Entry, summary: &mut Summary, terminal: &Terminal) {
    let Some(oddity) = entry.image.as_ref().and_then(Oddity::of) else { return };
    if summary.count_odd(oddity) {
        let source = input_name(Path::new(&entry.record.source));
        terminal.warning(format_args!("{source}, frame {}: {oddity} (said once)", number(entry)));
    }
}

/// Says once of each kind what was done to stored samples.
fn tell_conversions(
    entry: &Entry,
    told: &mut HashSet<std::mem::Discriminant<Conversion>>,
    terminal: &Terminal,
) {
    for conversion in &entry.conversions {
        if told.insert(discriminant(conversion)) {
            let source = input_name(Path::new(&entry.record.source));
            terminal.note(format_args!("{source}: {conversion} (said once)"));
        }
    }
}
