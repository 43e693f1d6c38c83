//! The loop that detect and locate share: a frame comes in, its record is filled in, written and counted.
//!
//! A frame that fails is reported, counted and skipped; what was written before it stays.

use std::collections::HashSet;
use std::mem::discriminant;
use std::path::Path;

use photinus_io::Result;
use photinus_io::image::Conversion;

use crate::clock::Clock;
use crate::failure::Failure;
use crate::input::{Entry, Input};
use crate::output::Outputs;
use crate::summary::Summary;
use crate::terminal::{Terminal, input_name};

/// After so many failed frames the others are only counted: the first ones say what is wrong.
const REPORTED_FAILURES: u64 = 10;

/// Takes every frame of `input` through `fill`, which completes its record, and gives `show` what is to be read by a
/// person.
pub(crate) fn run(
    input: Input,
    outputs: &mut Outputs,
    terminal: &mut Terminal,
    mut fill: impl FnMut(&mut Entry, &mut Clock) -> Result<()>,
    mut show: impl FnMut(&Entry, &Terminal) -> std::result::Result<(), Failure>,
) -> std::result::Result<(), Failure> {
    let (mut summary, mut clock, mut told) = (Summary::default(), Clock::new(), HashSet::new());
    terminal.start(input.count);
    let mut entries = input.entries;
    loop {
        clock.skip();
        let Some(read) = entries.next() else { break };
        clock.lap("reading");
        let filled = read.and_then(|mut entry| {
            tell_conversions(&entry, &mut told, terminal);
            clock.skip();
            fill(&mut entry, &mut clock)?;
            Ok(entry)
        });
        match filled {
            Ok(entry) => {
                clock.skip();
                outputs.write(&entry)?;
                show(&entry, terminal)?;
                clock.lap("writing");
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
    terminal.finish();
    if summary.failed > REPORTED_FAILURES {
        terminal.error(format_args!("{} more frames failed", summary.failed - REPORTED_FAILURES));
    }
    terminal.summary(summary.text(&clock));
    match summary.failed {
        0 => Ok(()),
        _ => Err(Failure::Frames { all: summary.frames() == 0 }),
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
