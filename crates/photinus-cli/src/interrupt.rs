//! Ctrl-C and the request to end: enters a signal, leaves a wish that loops look at between frames.
//!
//! A loop that looks ends by itself, keeps what is whole and says where it ended. Other work is ended from here, after a
//! moment; so is a loop that waits for an input that never comes.

use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};

/// What a shell sees of a program that was interrupted.
pub(crate) const EXIT_CODE: u8 = 130;

static ASKED: AtomicBool = AtomicBool::new(false);
/// Whether a loop looks.
static LOOKED_AT: AtomicBool = AtomicBool::new(false);
/// Folders in the making, gone when nothing keeps them.
static UNFINISHED: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// Whether the run is to end. Whoever asks promises to end it soon.
pub(crate) fn is_asked() -> bool {
    LOOKED_AT.store(true, Ordering::Relaxed);
    ASKED.load(Ordering::Relaxed)
}

/// Nobody looks any more: what comes now is to be finished, or ended from here.
pub(crate) fn look_away() {
    LOOKED_AT.store(false, Ordering::Relaxed);
}

/// A folder in the making, to be removed when the program is ended from here.
pub(crate) fn unfinished(folder: PathBuf) {
    if let Ok(mut folders) = UNFINISHED.lock() {
        folders.push(folder);
    }
}

/// The exit code of an interrupted run.
pub(crate) fn exit_code() -> ExitCode {
    ExitCode::from(EXIT_CODE)
}

/// From now on signals come here. A file that grows past its limit gives an error of writing, as a full disk does.
#[cfg(unix)]
pub(crate) fn listen() {
    use signal_hook::consts::{SIGINT, SIGTERM, SIGXFSZ};
    // Without a thread or a handler the program still works, and a signal ends it as it always did.
    let _ = signal_hook::flag::register(SIGXFSZ, std::sync::Arc::new(AtomicBool::new(false)));
    let Ok(mut signals) = signal_hook::iterator::Signals::new([SIGINT, SIGTERM]) else { return };
    let _ = std::thread::Builder::new().name("signals".to_owned()).spawn(move || {
        for _ in &mut signals {
            if ASKED.swap(true, Ordering::Relaxed) || !LOOKED_AT.load(Ordering::Relaxed) {
                end("interrupted; what was not finished is gone");
            }
            std::thread::spawn(|| {
                std::thread::sleep(PATIENCE);
                // A loop that has ended is keeping what is whole: that takes as long as it takes.
                if LOOKED_AT.load(Ordering::Relaxed) {
                    end("interrupted while waiting; what was written is kept");
                }
            });
        }
    });
}

#[cfg(not(unix))]
pub(crate) fn listen() {}

/// So long may a frame take before the run is ended all the same.
#[cfg(unix)]
const PATIENCE: std::time::Duration = std::time::Duration::from_secs(3);

#[cfg(unix)]
#[expect(clippy::print_stderr, reason = "the terminal belongs to a thread that does not answer")]
fn end(line: &str) -> ! {
    if let Ok(folders) = UNFINISHED.lock() {
        // One that was kept meanwhile is not there any more.
        folders.iter().for_each(|folder| drop(std::fs::remove_dir_all(folder)));
    }
    eprintln!("{line}");
    std::process::exit(i32::from(EXIT_CODE))
}
