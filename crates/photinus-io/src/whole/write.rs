//! What is written goes under a temporary name beside its target and takes the target's name when it is whole.

use std::ffi::OsString;
use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};

use tempfile::{Builder, NamedTempFile};

use crate::{Error, Result};

/// How a temporary name ends.
const SUFFIX: &str = ".partial";

/// What becomes of a file that has the name already.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Existing {
    /// It stays: writing is refused.
    Keep,
    /// It is replaced by what is written.
    Replace,
}

/// A file in the making; unless it is kept, nothing of it stays. Symbolic links are followed; devices and pipes are written
/// to as they are, since they can have no other name.
#[derive(Debug)]
pub struct WholeFile {
    sink: Sink,
    target: PathBuf,
    existing: Existing,
}

#[derive(Debug)]
enum Sink {
    Beside(NamedTempFile),
    Direct(File),
}

impl WholeFile {
    /// Begins a file at `path`.
    ///
    /// # Errors
    /// [`Error`] when its folder is missing or cannot be written to, or when `path` is a folder.
    pub fn create(path: impl AsRef<Path>, existing: Existing) -> Result<Self> {
        let path = path.as_ref();
        // What is not there yet has no canonical path, and is no link.
        let target = path.canonicalize().unwrap_or_else(|_| path.to_owned());
        if target.is_dir() {
            return Err(Error::format(path, "it is a folder").advise("name a file, not a folder"));
        }
        let sink = if target.exists() && !target.is_file() {
            File::options().write(true).open(&target).map(Sink::Direct)
        } else {
            let prefix = prefix_of(&target);
            let create = |path: &Path| File::options().write(true).create_new(true).open(path);
            let made = Builder::new().prefix(&prefix).suffix(SUFFIX).make_in(folder_of(&target), create);
            made.map(Sink::Beside)
        };
        let sink = sink.map_err(|error| refuse(path, error))?;
        Ok(Self { sink, target, existing })
    }

    /// It is whole: gives it its name.
    ///
    /// # Errors
    /// [`Error`] when the disk is full, or when another file has the name by now and is to stay.
    pub fn keep(mut self) -> Result<()> {
        self.flush().map_err(|error| refuse(&self.target, error))?;
        let Sink::Beside(file) = self.sink else { return Ok(()) };
        let kept = match self.existing {
            Existing::Replace => file.persist(&self.target),
            Existing::Keep => file.persist_noclobber(&self.target),
        };
        kept.map(drop).map_err(|error| refuse(&self.target, error.error))
    }
}

impl Write for WholeFile {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        match &mut self.sink {
            Sink::Beside(file) => file.as_file_mut().write(bytes),
            Sink::Direct(file) => file.write(bytes),
        }
    }

    fn flush(&mut self) -> std::io::Result<()> {
        match &mut self.sink {
            Sink::Beside(file) => file.as_file_mut().flush(),
            Sink::Direct(file) => file.flush(),
        }
    }
}

/// Writes all of a file or nothing.
///
/// # Errors
/// As [`WholeFile::create`] and [`WholeFile::keep`].
pub fn write_whole(path: impl AsRef<Path>, bytes: &[u8], existing: Existing) -> Result<()> {
    let path = path.as_ref();
    let mut file = WholeFile::create(path, existing)?;
    file.write_all(bytes).map_err(|error| refuse(path, error))?;
    file.keep()
}

/// A folder in the making; unless it is kept, nothing of it stays.
#[derive(Debug)]
pub struct WholeFolder {
    making: Making,
    target: PathBuf,
}

/// A folder that goes with what is in it, unless it has got another name by then.
#[derive(Debug)]
struct Making(PathBuf);

impl Drop for Making {
    fn drop(&mut self) {
        // What cannot be removed has a name that says whose it is.
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

impl WholeFolder {
    /// Begins a folder that is to be `path`.
    ///
    /// # Errors
    /// [`Error`] when the folder around it is missing or cannot be written to.
    pub fn create(path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        let target = path.canonicalize().unwrap_or_else(|_| path.to_owned());
        let prefix = prefix_of(&target);
        let create = |path: &Path| std::fs::create_dir(path);
        let made = Builder::new().prefix(&prefix).suffix(SUFFIX).make_in(folder_of(&target), create);
        let (_, making) = made
            .and_then(|made| made.keep().map_err(|error| error.error))
            .map_err(|error| refuse(path, error))?;
        Ok(Self { making: Making(making), target })
    }

    /// Where to write what belongs into it.
    pub fn path(&self) -> &Path {
        &self.making.0
    }

    /// It is whole: gives it its name. Of a folder that is there already, files of the same names are replaced and the others
    /// stay.
    ///
    /// # Errors
    /// [`Error`] when the operating system refuses.
    pub fn keep(self) -> Result<()> {
        let moved = match self.target.is_dir() {
            true => merge(&self.making.0, &self.target),
            false => std::fs::rename(&self.making.0, &self.target),
        };
        moved.map_err(|error| refuse(&self.target, error))?;
        // After a rename there is nothing left to remove, after a merge empty folders only.
        drop(self.making);
        Ok(())
    }

    /// The same error, told of the folder's name to be in place of its temporary one.
    #[must_use]
    pub fn tell(&self, mut error: Error) -> Error {
        if let Ok(inside) = error.file.strip_prefix(&self.making.0) {
            error.file = self.target.join(inside);
        }
        error
    }
}

/// Moves every file of one folder into another.
fn merge(from: &Path, into: &Path) -> std::io::Result<()> {
    std::fs::create_dir_all(into)?;
    for entry in std::fs::read_dir(from)? {
        let entry = entry?;
        let target = into.join(entry.file_name());
        match entry.file_type()?.is_dir() {
            true => merge(&entry.path(), &target)?,
            false => std::fs::rename(entry.path(), target)?,
        }
    }
    Ok(())
}

/// The beginning of a temporary name, which says whose it is: `.camera.toml.x7f3a9.partial`.
fn prefix_of(target: &Path) -> OsString {
    let mut prefix = OsString::from(".");
    prefix.push(target.file_name().unwrap_or_default());
    prefix.push(".");
    prefix
}

/// The folder that a target stands in.
fn folder_of(target: &Path) -> &Path {
    match target.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

fn refuse(path: &Path, error: std::io::Error) -> Error {
    let advice = match error.kind() {
        std::io::ErrorKind::NotFound => "make its folder first, or write elsewhere",
        std::io::ErrorKind::AlreadyExists => "it was made by somebody else meanwhile; write elsewhere",
        std::io::ErrorKind::StorageFull => "free some space and run again",
        _ => "write elsewhere, or change the permissions",
    };
    Error::io(path, error).advise(advice)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scratch::Folder;

    fn names(folder: &Path) -> Vec<String> {
        let mut names: Vec<String> = std::fs::read_dir(folder)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned())
            .collect();
        names.sort();
        names
    }

    #[test]
    fn a_file_has_its_name_when_it_is_whole_and_not_before() {
        let folder = Folder::new("whole-file");
        let path = folder.path().join("a.toml");
        let mut file = WholeFile::create(&path, Existing::Keep).unwrap();
        file.write_all(b"half").unwrap();
        assert!(!path.exists());
        drop(file);
        assert_eq!(names(folder.path()), [""; 0], "nothing of it stays");
        write_whole(&path, b"whole", Existing::Keep).unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), b"whole");
        assert_eq!(names(folder.path()), ["a.toml"]);
    }

    #[test]
    fn what_has_the_name_already_stays_unless_it_may_go() {
        let folder = Folder::new("whole-existing");
        let path = folder.file("a.toml", b"mine");
        let message = write_whole(&path, b"new", Existing::Keep).unwrap_err().to_string();
        assert!(message.contains("a.toml: ") && message.contains("write elsewhere"), "{message}");
        assert_eq!(std::fs::read(&path).unwrap(), b"mine");
        write_whole(&path, b"new", Existing::Replace).unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), b"new");
        assert!(write_whole(folder.path(), b"new", Existing::Replace).is_err(), "a folder is no file");
    }

    #[cfg(unix)]
    #[test]
    fn a_link_is_followed_and_stays_a_link() {
        use std::os::unix::fs::{PermissionsExt, symlink};
        let folder = Folder::new("whole-link");
        let (target, link) = (folder.file("real", b"old"), folder.path().join("link"));
        symlink(&target, &link).unwrap();
        write_whole(&link, b"new", Existing::Replace).unwrap();
        assert_eq!(std::fs::read(&target).unwrap(), b"new");
        assert!(link.is_symlink());
        let mode = |path: &Path| std::fs::metadata(path).unwrap().permissions().mode();
        let ordinary = folder.file("ordinary", b"");
        assert_eq!(mode(&target), mode(&ordinary), "no more private than other files");
    }

    #[test]
    fn a_folder_has_its_name_when_it_is_whole() {
        let folder = Folder::new("whole-folder");
        let path = folder.path().join("set");
        let making = WholeFolder::create(&path).unwrap();
        std::fs::create_dir(making.path().join("images")).unwrap();
        std::fs::write(making.path().join("images/0.png"), b"0").unwrap();
        let error = making.tell(Error::format(making.path().join("images/1.png"), "full"));
        assert_eq!(error.file, path.join("images/1.png"));
        assert!(!path.exists());
        making.keep().unwrap();
        assert_eq!(std::fs::read(path.join("images/0.png")).unwrap(), b"0");
        assert_eq!(names(folder.path()), ["set"]);
        drop(WholeFolder::create(folder.path().join("never")).unwrap());
        assert_eq!(names(folder.path()), ["set"]);
    }

    #[test]
    fn a_folder_that_is_there_keeps_its_other_files() {
        let folder = Folder::new("whole-merge");
        let path = folder.path().join("set");
        std::fs::create_dir_all(path.join("images")).unwrap();
        std::fs::write(path.join("images/0.png"), b"old").unwrap();
        std::fs::write(path.join("images/mine.png"), b"mine").unwrap();
        let making = WholeFolder::create(&path).unwrap();
        std::fs::create_dir(making.path().join("images")).unwrap();
        std::fs::write(making.path().join("images/0.png"), b"new").unwrap();
        making.keep().unwrap();
        assert_eq!(std::fs::read(path.join("images/0.png")).unwrap(), b"new");
        assert_eq!(std::fs::read(path.join("images/mine.png")).unwrap(), b"mine");
        assert_eq!(names(folder.path()), ["set"]);
    }
}
