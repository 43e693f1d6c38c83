//! The only place that prints: results to standard output, everything else to standard error.
//!
//! `error:` means that something is missing from the result, `warning:` that there is something to do, `note:` that
//! something was taken differently from what a file says.

use std::borrow::Cow;
use std::fmt::Display;
use std::io::Write;
use std::path::Path;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use photinus_io::Error;

use crate::failure::Failure;

/// Work shorter than this shows no progress.
const PATIENCE: Duration = Duration::from_secs(1);

/// What an input is called in messages.
pub(crate) fn input_name(path: &Path) -> Cow<'_, str> {
    match path.as_os_str() == "-" {
        true => "standard input".into(),
        false => path.to_string_lossy(),
    }
}

/// Where the program talks.
pub(crate) struct Terminal {
    quiet: bool,
    started: Instant,
    bar: ProgressBar,
}

impl Terminal {
    /// A terminal that says nothing but errors and results when `quiet`.
    pub(crate) fn new(quiet: bool) -> Self {
        Self { quiet, started: Instant::now(), bar: ProgressBar::hidden() }
    }

    /// Begins work on this many frames, where that is known.
    pub(crate) fn start(&mut self, frames: Option<u64>) {
        let template = match frames {
            Some(_) => "{wide_bar} {pos}/{len} frames, {eta} left",
            None => "{spinner} {pos} frames, {per_sec}",
        };
        self.begin(frames, template);
    }

    /// Begins work on this many recordings.
    pub(crate) fn start_recordings(&mut self, recordings: usize) {
        self.begin(Some(recordings as u64), "{wide_bar} {pos}/{len} recordings, {eta} left");
    }

    fn begin(&mut self, steps: Option<u64>, template: &str) {
        self.bar = ProgressBar::with_draw_target(steps, ProgressDrawTarget::hidden());
        if let Ok(style) = ProgressStyle::with_template(template) {
            self.bar.set_style(style);
        }
        self.started = Instant::now();
    }

    /// A frame is done. The bar hides itself where standard error is no terminal.
    pub(crate) fn frame_done(&self) {
        if !self.quiet && self.bar.is_hidden() && self.started.elapsed() > PATIENCE {
            self.bar.set_draw_target(ProgressDrawTarget::stderr());
        }
        self.bar.inc(1);
    }

    /// A recording is done.
    pub(crate) fn recording_done(&self) {
        self.frame_done();
    }

    /// The work is over.
    pub(crate) fn finish(&self) {
        self.bar.finish_and_clear();
    }

    /// Something is missing from the result.
    pub(crate) fn error(&self, message: impl Display) {
        self.say(format_args!("error: {message}"));
    }

    /// There is something to do.
    pub(crate) fn warning(&self, message: impl Display) {
        if !self.quiet {
            self.say(format_args!("warning: {message}"));
        }
    }

    /// Something was taken differently from what a file says.
    pub(crate) fn note(&self, message: impl Display) {
        if !self.quiet {
            self.say(format_args!("note: {message}"));
        }
    }

    /// What was done, at the end.
    pub(crate) fn summary(&self, text: impl Display) {
        if !self.quiet {
            self.say(format_args!("{text}"));
        }
    }

    /// A line of the result.
    pub(crate) fn result(&self, line: impl Display) -> Result<(), Failure> {
        self.line(line).map_err(Failure::running)
    }

    /// A line of the result.
    ///
    /// # Errors
    /// [`Error`] when standard output is closed or full.
    pub(crate) fn line(&self, line: impl Display) -> photinus_io::Result<()> {
        let written = self.bar.suspend(|| writeln!(std::io::stdout(), "{line}"));
        written.map_err(|error| Error::io("standard output", error))
    }

    fn say(&self, line: impl Display) {
        // There is nowhere left to complain about a closed standard error.
        let _ = self.bar.suspend(|| writeln!(std::io::stderr(), "{line}"));
    }
}
