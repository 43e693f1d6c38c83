//! What detect and locate have in common around the loop: a stopped run is gone on with, outputs are opened, frames are counted, and at the end it is
//! told what was found.

use std::panic::{AssertUnwindSafe, catch_unwind};

use photinus_io::Error;
use photinus_run::{Clock, Entry, Oddity, Outlet, Work, guarded, source_name};

use crate::failure::Failure;
use crate::input::{Entries, Input};
use crate::interrupt;
use crate::output::{Claimed, Outputs};
use crate::resume::Done;
use crate::summary::Summary;
use crate::terminal::Terminal;

/// After this many failed frames the others are only counted: the first ones say what is wrong.
const REPORTED_FAILURES: u64 = 10;

/// Takes every frame of `input` through `work`, which completes its record, and writes it. What is `done` is skipped, once nothing is left to
/// learn from it; its last frame is made once more, to see that this run finds the same.
pub(crate) fn run(
    input: Input,
    outputs: Claimed,
    done: Option<&Done>,
    terminal: &mut Terminal,
    work: &mut impl Work,
) -> std::result::Result<(), Failure> {
    let mut clock = Clock::new();
    let mut entries = input.entries;
    let again = match done {
        Some(done) => Some(go_on(done, &mut entries, &mut clock, work)?),
        None => None,
    };
    let mut outputs = outputs.open(done).map_err(Failure::input)?;
    terminal.start(input.count);
    if let Some(again) = again {
        outputs.write(&again, &mut clock, terminal)?;
        terminal.note(format_args!("{}: goes on after frame {}", place(&outputs), again.number()));
    }
    let mut desk = Desk { outputs, summary: Summary::default(), terminal };
    photinus_run::run(entries, work, &mut desk, &mut clock)?;
    let Desk { outputs, summary, terminal } = desk;
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

/// The end of the loop: writes and counts frames, and tells what went wrong.
struct Desk<'a> {
    outputs: Outputs,
    summary: Summary,
    terminal: &'a mut Terminal,
}

impl Outlet for Desk<'_> {
    type End = Failure;

    fn is_over(&mut self) -> bool {
        interrupt::is_asked()
    }

    fn frame(
        &mut self,
        entry: Entry,
        oddity: Option<Oddity>,
        clock: &mut Clock,
    ) -> std::result::Result<(), Failure> {
        self.outputs.write(&entry, clock, self.terminal)?;
        // The summary counts those that are not told.
        if let Some(oddity) = oddity
            && self.summary.count_odd(oddity)
        {
            let (source, frame) = (source_name(&entry), entry.number());
            self.terminal.warning(format_args!("{source}, frame {frame}: {oddity} (said once)"));
        }
        self.summary.count(&entry.record);
        Ok(())
    }

    fn failed(&mut self, error: Error) {
        self.summary.failed += 1;
        if self.summary.failed <= REPORTED_FAILURES {
            self.terminal.error(&error);
        }
    }

    fn note(&mut self, text: String) {
        self.terminal.note(text);
    }

    fn warn(&mut self, text: String) {
        self.terminal.warning(text);
    }

    fn next(&mut self) {
        self.terminal.frame_done();
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
