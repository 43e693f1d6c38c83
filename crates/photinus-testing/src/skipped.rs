//! The list of what was skipped in one run: a file in the target folder, a line per test.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

/// Lists of runs that broke off before their last test are removed after this long.
const OLD: Duration = Duration::from_hours(24);

/// The list of one run.
pub struct Skipped(PathBuf);

impl Skipped {
    /// The list of the run that this test program is part of: that of the Cargo which started it, so that two runs at once
    /// do not mix.
    ///
    /// # Panics
    /// When the folder of the program cannot be found.
    #[must_use]
    pub fn of_this_run() -> Self {
        let program = std::env::current_exe().expect("a test knows its own program");
        // <target>/<profile>/deps/<program>
        let profile = program.ancestors().nth(2).expect("a test program has a folder");
        Self::in_folder(&profile.join("skipped-tests"), run())
    }

    /// The list of run `number` in `folder`.
    #[must_use]
    pub fn in_folder(folder: &Path, number: u32) -> Self {
        Self(folder.join(format!("{number}.txt")))
    }

    /// Lists the test that calls as skipped, and prints why.
    pub fn current_test(why: &str) {
        let program = std::env::current_exe().unwrap_or_default();
        let file = program.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        // Cargo adds a hash to the name of the target.
        let target = file.rsplit_once('-').map_or(file.as_str(), |(target, _)| target);
        // A test runs in a thread of its own, named after it.
        let thread = std::thread::current();
        let line = format!("{target} {}: {why}", thread.name().unwrap_or_default());
        #[expect(clippy::print_stdout, reason = "a test that skips says so")]
        {
            println!("skipped: {line}");
        }
        Self::of_this_run().add(&line);
    }

    /// Adds a line, whole whatever others write at the same time.
    ///
    /// # Panics
    /// When it cannot be written: a skip that is not listed would pass for a test that ran.
    pub fn add(&self, line: &str) {
        if let Some(folder) = self.0.parent() {
            std::fs::create_dir_all(folder).expect("the target folder can be written to");
        }
        let file = std::fs::OpenOptions::new().create(true).append(true).open(&self.0);
        file.and_then(|mut file| file.write_all(format!("{line}\n").as_bytes())).expect("a line is added");
    }

    /// What is listed, each line once, sorted; the list is empty afterwards, and forgotten ones are removed.
    #[must_use]
    pub fn take(&self) -> Vec<String> {
        let text = std::fs::read_to_string(&self.0).unwrap_or_default();
        let _ = std::fs::remove_file(&self.0);
        let beside = self.0.parent().and_then(|folder| std::fs::read_dir(folder).ok());
        for list in beside.into_iter().flatten().flatten() {
            let written = list.metadata().and_then(|metadata| metadata.modified());
            let is_old = |at| SystemTime::now().duration_since(at).is_ok_and(|age| age > OLD);
            if written.is_ok_and(is_old) {
                let _ = std::fs::remove_file(list.path());
            }
        }
        let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
        lines.sort();
        lines.dedup();
        lines
    }
}

#[cfg(unix)]
fn run() -> u32 {
    std::os::unix::process::parent_id()
}

/// Elsewhere nobody tells who started a program: runs share one list.
#[cfg(not(unix))]
fn run() -> u32 {
    0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_line_of_every_thread_is_listed_once_and_then_gone() {
        let folder = std::env::temp_dir().join(format!("photinus-testing-{}", std::process::id()));
        let (list, other) = (Skipped::in_folder(&folder, 1), Skipped::in_folder(&folder, 2));
        std::thread::scope(|scope| {
            for thread in 0..4 {
                let list = &list;
                scope.spawn(move || (0..50).for_each(|line| list.add(&format!("{thread} {line:02}"))));
            }
        });
        list.add("0 00");
        other.add("of another run");
        let lines = list.take();
        assert_eq!((lines.len(), lines[0].as_str(), lines[199].as_str()), (200, "0 00", "3 49"));
        assert!(list.take().is_empty());
        assert_eq!(other.take(), ["of another run"]);
        std::fs::remove_dir_all(folder).expect("the folder is there");
    }

    #[test]
    fn a_test_is_listed_under_its_name() {
        let list = Skipped::in_folder(&std::env::temp_dir(), std::process::id());
        let file = std::env::current_exe().expect("a program");
        assert!(Skipped::of_this_run().0.starts_with(file.ancestors().nth(2).expect("a folder")));
        assert!(list.take().is_empty());
        let thread = std::thread::current();
        assert_eq!(thread.name(), Some("skipped::tests::a_test_is_listed_under_its_name"));
    }
}
