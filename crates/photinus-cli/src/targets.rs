//! What a run writes: enter the paths that a user names and the files that the run reads, leave places that may be written.
//!
//! One rule for every command: what is there stays, unless `--force` says otherwise; what the run reads stays even then; no
//! two outputs go to one place; a name says what is there. Pipes, devices and standard output hold nothing that could be lost.

use std::fs::File;
use std::path::{Path, PathBuf};

use photinus_io::whole::{Existing, WholeFile, WholeFolder, write_whole};
use photinus_io::{Error, Result};
use same_file::Handle;

use crate::ending::Content;
use crate::failure::Failure;
use crate::interrupt;

/// What the user says about files that are there already.
#[derive(Clone, Copy, Debug, Default, clap::Args)]
pub(crate) struct WriteArgs {
    /// Overwrite files that exist already; files that this run reads are never overwritten
    #[arg(long)]
    pub(crate) force: bool,
}

/// The places that a run reads and writes.
pub(crate) struct Targets {
    read: Vec<PathBuf>,
    claimed: Vec<PathBuf>,
    existing: Existing,
}

/// A file that may be written.
#[derive(Clone, Debug)]
pub(crate) struct FileTarget {
    path: PathBuf,
    existing: Existing,
}

/// A folder that may be written to.
#[derive(Clone, Debug)]
pub(crate) struct FolderTarget(PathBuf);

impl Targets {
    /// For a run that reads these files.
    pub(crate) fn new(args: WriteArgs, read: impl IntoIterator<Item = PathBuf>) -> Self {
        let existing = if args.force { Existing::Replace } else { Existing::Keep };
        Self { read: read.into_iter().collect(), claimed: Vec::new(), existing }
    }

    /// The file `path`, if it may be written and its name says what it will hold.
    pub(crate) fn file(&mut self, path: &Path, content: Content) -> std::result::Result<FileTarget, Failure> {
        let target = FileTarget { path: path.to_owned(), existing: self.existing };
        if is_standard(path) {
            self.claim(path.to_owned(), path)?;
            return Ok(target);
        }
        if path.is_dir() {
            return refuse(path, "it is a folder", "name a file, not a folder");
        }
        // What a path says when its last part is no file yet, and when it is another name of one that is.
        let place = whereabouts(path);
        if self.is_read(path) {
            return refuse(path, "this file is an input, it would be replaced", "write elsewhere");
        }
        self.claim(place, path)?;
        if path.is_file() && self.existing == Existing::Keep {
            return refuse(path, "it is there already", "write elsewhere, or over it with --force");
        }
        agree(path, content)?;
        target.probe().map_err(Failure::input)?;
        Ok(target)
    }

    /// The folder `path`, if it may be written to: it is not there, or empty, or `--force` is given; and nothing that the run
    /// reads is in it.
    pub(crate) fn folder(&mut self, path: &Path) -> std::result::Result<FolderTarget, Failure> {
        if path.exists() && !path.is_dir() {
            return refuse(path, "it is there already, and no folder", "name another folder");
        }
        let place = whereabouts(path);
        if self.read.iter().any(|file| whereabouts(file).starts_with(&place)) {
            return refuse(path, "a file in it is an input", "name another folder");
        }
        self.claim(place, path)?;
        let is_empty = |mut entries: std::fs::ReadDir| entries.next().is_none();
        let holds_something = path.exists() && !std::fs::read_dir(path).is_ok_and(is_empty);
        if holds_something && self.existing == Existing::Keep {
            let advice = "name another folder, or write into it with --force";
            return refuse(path, "it is there already", advice);
        }
        agree(path, Content::Folder)?;
        // A folder that cannot be made is noticed before the work.
        let around = path.ancestors().skip(1).find(|folder| folder.is_dir()).unwrap_or(Path::new(""));
        drop(WholeFolder::create(around.join("photinus")).map_err(Failure::input)?);
        Ok(FolderTarget(path.to_owned()))
    }

    fn is_read(&self, path: &Path) -> bool {
        let Ok(target) = Handle::from_path(path) else { return false };
        self.read.iter().any(|file| Handle::from_path(file).is_ok_and(|file| file == target))
    }

    fn claim(&mut self, place: PathBuf, named: &Path) -> std::result::Result<(), Failure> {
        // Two outputs may both go to one pipe or to /dev/null, but not to standard output: nobody could tell them apart.
        let is_shared = place.exists() && !place.is_file() && !place.is_dir();
        if self.claimed.contains(&place) && is_standard(named) {
            let reason = "two outputs both write to standard output: name a file for one of them";
            return Err(Failure::Input(reason.to_owned()));
        }
        if self.claimed.contains(&place) && !is_shared {
            let advice = "name another place for one of them";
            return refuse(named, "two outputs would be written here", advice);
        }
        self.claimed.push(place);
        Ok(())
    }
}

impl FileTarget {
    /// What it is called in messages.
    pub(crate) fn name(&self) -> &Path {
        if self.is_standard() { Path::new("standard output") } else { &self.path }
    }

    /// The path as it was named.
    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// Whether it is, or will be, a file, and not a pipe, a device or standard output.
    pub(crate) fn is_file(&self) -> bool {
        !self.is_standard() && (self.path.is_file() || !self.path.exists())
    }

    /// Whether it is standard output.
    pub(crate) fn is_standard(&self) -> bool {
        is_standard(&self.path)
    }

    /// A file that grows in its place from nothing: what is in it when the run is stopped stays.
    ///
    /// # Errors
    /// [`Error`] when it cannot be opened, or was made by somebody else meanwhile.
    pub(crate) fn grow(&self) -> Result<File> {
        let mut options = File::options();
        options.write(true);
        match self.existing {
            Existing::Keep if !self.path.exists() => options.create_new(true),
            _ => options.create(true).truncate(true),
        };
        options.open(&self.path).map_err(|error| Error::io(&self.path, error))
    }

    /// A file that has its name when it is whole.
    ///
    /// # Errors
    /// As [`WholeFile::create`].
    pub(crate) fn whole(&self) -> Result<WholeFile> {
        WholeFile::create(&self.path, self.existing)
    }

    /// Where a file is made that another crate writes, until [`Self::take`].
    pub(crate) fn part(&self) -> PathBuf {
        let mut name = self.path.clone().into_os_string();
        name.push(".part");
        name.into()
    }

    /// What was made at [`Self::part`] is whole: gives it its name.
    ///
    /// # Errors
    /// When the system refuses.
    pub(crate) fn take(&self) -> Result<()> {
        std::fs::rename(self.part(), &self.path).map_err(|error| Error::io(&self.path, error))
    }

    /// Writes all of it at once.
    ///
    /// # Errors
    /// As [`write_whole`].
    pub(crate) fn write(&self, bytes: &[u8]) -> Result<()> {
        write_whole(&self.path, bytes, self.existing)
    }

    /// Whether it can be written is noticed before the work, not after.
    fn probe(&self) -> Result<()> {
        if self.is_file() { self.whole().map(drop) } else { Ok(()) }
    }
}

impl FolderTarget {
    /// The path as it was named.
    pub(crate) fn path(&self) -> &Path {
        &self.0
    }

    /// A folder that has its name when it is whole.
    ///
    /// # Errors
    /// As [`WholeFolder::create`].
    pub(crate) fn whole(&self) -> Result<WholeFolder> {
        if let Some(around) = self.0.parent() {
            std::fs::create_dir_all(around).map_err(|error| unmade(&self.0, error))?;
        }
        let making = WholeFolder::create(&self.0)?;
        interrupt::unfinished(making.path().to_owned());
        Ok(making)
    }

    /// A folder that grows in its place, file by file.
    ///
    /// # Errors
    /// [`Error`] when it cannot be made.
    pub(crate) fn grow(&self) -> Result<PathBuf> {
        std::fs::create_dir_all(&self.0).map_err(|error| unmade(&self.0, error))?;
        Ok(self.0.clone())
    }
}

/// Refuses a name that says another thing than what will be there.
fn agree(path: &Path, content: Content) -> std::result::Result<(), Failure> {
    match content.disagreement(path) {
        Some((reason, advice)) => refuse(path, &reason, &advice),
        None => Ok(()),
    }
}

fn unmade(folder: &Path, error: std::io::Error) -> Error {
    Error::io(folder, error).advise("name a folder that can be made and written to")
}

fn is_standard(path: &Path) -> bool {
    path.as_os_str() == "-"
}

/// The path that a file has, or will have: links are followed as far as they are there.
fn whereabouts(path: &Path) -> PathBuf {
    if let Ok(path) = path.canonicalize() {
        return path;
    }
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    match (folder.canonicalize(), path.file_name()) {
        (Ok(folder), Some(name)) => folder.join(name),
        _ => path.to_owned(),
    }
}

fn refuse<T>(path: &Path, reason: &str, advice: &str) -> std::result::Result<T, Failure> {
    Err(Failure::input(Error::format(path, reason).advise(advice)))
}
