//! Many recordings: each is located by itself, so many at once as there are cores, and its results have their name when they are whole.
//! What has its results is not done again, so that the same command goes on after a crash.

use std::num::NonZeroUsize;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use photinus_io::Error;
use photinus_io::results::ResultsWriter;
use photinus_io::whole::WholeFile;
use photinus_run::{Clock, Entry, Oddity, Outlet, fault};

use super::Args;
use super::place::{self, Place};
use crate::ending::Content;
use crate::failure::Failure;
use crate::interrupt;
use crate::targets::Targets;
use crate::terminal::Terminal;

/// What the user says about many recordings.
#[derive(Debug, clap::Args)]
pub(super) struct BatchArgs {
    /// Locate every INPUT by itself, on all cores: results go to DIR/INPUT.jsonl, and what is there already is not done again
    #[arg(long, value_name = "DIR", conflicts_with_all = ["out", "csv", "overlay", "resume", "spots"])]
    pub(super) out_dir: Option<PathBuf>,
    /// Beside each file of --out-dir, its neighbours as a Parquet table: DIR/INPUT.parquet
    #[cfg(feature = "parquet")]
    #[arg(long, requires = "out_dir")]
    parquet: bool,
    /// So many recordings at once [default: as many as there are cores]
    #[arg(long, value_name = "N", requires = "out_dir")]
    jobs: Option<NonZeroUsize>,
}

/// What became of recordings.
#[derive(Default)]
struct Tally {
    done: usize,
    before: usize,
    failed: usize,
    frames: u64,
    bad_frames: u64,
}

/// Locates every input of the command line into a folder.
pub(super) fn run(args: &Args, folder: &Path, terminal: &mut Terminal) -> Result<(), Failure> {
    if args.input.inputs.is_empty() {
        return Err(Failure::Input("no recordings: name dataset folders, videos or recordings".to_owned()));
    }
    let places = place::places(folder, &args.input.inputs).map_err(Failure::input)?;
    place::open(folder, args.output.write.force).map_err(Failure::input)?;
    let (tally, next) = (Mutex::new(Tally::default()), AtomicUsize::new(0));
    terminal.start_recordings(places.len());
    let terminal = &*terminal;
    let work = || {
        while !interrupt::is_asked()
            && let Some(place) = places.get(next.fetch_add(1, Ordering::Relaxed))
        {
            let located = guarded(args, place, terminal);
            if let Ok(mut tally) = tally.lock() {
                tally.count(located, terminal);
            }
            terminal.recording_done();
        }
    };
    std::thread::scope(|scope| {
        for _ in 0..args.batch.threads(places.len()) {
            scope.spawn(work);
        }
    });
    interrupt::look_away();
    terminal.finish();
    let tally = tally.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);
    terminal.summary(tally.told());
    tally.end()
}

impl BatchArgs {
    fn threads(&self, recordings: usize) -> usize {
        let cores = || std::thread::available_parallelism().unwrap_or(NonZeroUsize::MIN);
        self.jobs.unwrap_or_else(cores).get().min(recordings)
    }
}

impl Tally {
    fn count(&mut self, located: Result<Option<Counted>, Failure>, terminal: &Terminal) {
        match located {
            Ok(None) => self.before += 1,
            Ok(Some(counted)) => {
                self.done += 1;
                self.frames += counted.frames;
                self.bad_frames += counted.failed;
            }
            // Told at the end, once for all.
            Err(Failure::Interrupted(_)) => {}
            Err(failure) => {
                self.failed += 1;
                failure.message().into_iter().for_each(|message| terminal.error(message));
            }
        }
    }

    fn told(&self) -> String {
        let mut told = format!("{} recordings located, {} frames", self.done, self.frames);
        for (count, what) in [
            (self.bad_frames, "frames failed"),
            (self.before as u64, "recordings were done before"),
            (self.failed as u64, "recordings failed"),
        ] {
            if count > 0 {
                told += &format!("; {count} {what}");
            }
        }
        told
    }

    fn end(&self) -> Result<(), Failure> {
        if interrupt::is_asked() {
            let done = self.done + self.before;
            return Err(Failure::Interrupted(format!(
                "interrupted after {done} recordings; the same command goes on after them"
            )));
        }
        match self.failed as u64 + self.bad_frames {
            0 => Ok(()),
            _ => Err(Failure::Frames { all: self.done + self.before == 0 }),
        }
    }
}

/// A panic is a failure of its recording: the others go on.
fn guarded(args: &Args, place: &Place, terminal: &Terminal) -> Result<Option<Counted>, Failure> {
    catch_unwind(AssertUnwindSafe(|| finished(args, place, terminal))).unwrap_or_else(|payload| {
        let told = fault::told(payload.as_ref());
        Err(Failure::Running(format!("{}: {told}; {}", place.input.display(), fault::ADVICE)))
    })
}

/// Sees to it that the results of a recording are there; what was done for it, unless they were there before.
fn finished(args: &Args, place: &Place, terminal: &Terminal) -> Result<Option<Counted>, Failure> {
    let is_new = args.output.write.force || !place.results.is_file();
    let counted = is_new.then(|| locate(args, place, terminal)).transpose()?;
    #[cfg(feature = "parquet")]
    if args.batch.parquet && (is_new || !place.table().is_file()) {
        super::table::tabulate(&place.results, &place.table()).map_err(Failure::running)?;
    }
    Ok(counted)
}

fn locate(args: &Args, place: &Place, terminal: &Terminal) -> Result<Counted, Failure> {
    let input = args.input.only(&place.input).open()?;
    let kinds = args.kinds(&input, terminal)?;
    let mut views = args.views(&input, &kinds, terminal)?;
    if let Some(around) = place.results.parent() {
        std::fs::create_dir_all(around).map_err(|error| Failure::input(Error::io(around, error)))?;
    }
    let read = input.files.iter().cloned().chain(args.files());
    let target = Targets::new(args.output.write, read).file(&place.results, Content::JsonLines)?;
    let results = ResultsWriter::new(target.whole().map_err(Failure::input)?, &place.results);
    let mut shelf = Shelf { results, counted: Counted::default(), terminal };
    photinus_run::run(input.entries, &mut views, &mut shelf, &mut Clock::new())?;
    if interrupt::is_asked() {
        return Err(Failure::Interrupted(String::new()));
    }
    if shelf.counted.frames == 0 {
        return Err(Failure::Running(format!("{}: it has no frame that could be used", input.name)));
    }
    shelf.results.finish().and_then(WholeFile::keep).map_err(Failure::running)?;
    Ok(shelf.counted)
}

/// Frames of a recording.
#[derive(Clone, Copy, Default)]
struct Counted {
    frames: u64,
    failed: u64,
}

/// The results of one recording in the making.
struct Shelf<'a> {
    results: ResultsWriter<WholeFile>,
    counted: Counted,
    terminal: &'a Terminal,
}

impl Outlet for Shelf<'_> {
    type End = Failure;

    fn is_over(&mut self) -> bool {
        interrupt::is_asked()
    }

    fn frame(&mut self, entry: Entry, _: Option<Oddity>, _: &mut Clock) -> Result<(), Failure> {
        self.counted.frames += 1;
        self.results.write(&entry.record).map_err(Failure::running)
    }

    fn failed(&mut self, error: Error) {
        // The first says what is wrong; the others are counted.
        if self.counted.failed == 0 {
            self.terminal.error(&error);
        }
        self.counted.failed += 1;
    }

    fn note(&mut self, text: String) {
        self.terminal.note(text);
    }

    fn warn(&mut self, text: String) {
        self.terminal.warning(text);
    }
}
