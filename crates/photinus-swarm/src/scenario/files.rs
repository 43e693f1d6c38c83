//! Files that a scenario names: from its folder, or from what the program carries.

use std::path::{Path, PathBuf};

use photinus::identity::CodeBook;
use photinus_io::airframe::{AirframeFile, parse_airframe};
use photinus_io::camera::parse_camera;
use photinus_io::codes::parse_codes;
use photinus_io::{CameraFile, Error, Place, Result};

/// Texts by name: what the program carries.
const CARRIED: [(&str, &str); 7] = [
    ("airframes/hexarotor-0.4.toml", include_str!("../../carried/airframes/hexarotor-0.4.toml")),
    ("airframes/octorotor-0.5.toml", include_str!("../../carried/airframes/octorotor-0.5.toml")),
    ("airframes/quadrotor-0.245.toml", include_str!("../../carried/airframes/quadrotor-0.245.toml")),
    ("cameras/bluefox-dsl215.toml", include_str!("../../carried/cameras/bluefox-dsl215.toml")),
    ("cameras/small-fisheye-960x600.toml", include_str!("../../carried/cameras/small-fisheye-960x600.toml")),
    ("codes/l14-d3-r3.txt", include_str!("../../carried/codes/l14-d3-r3.txt")),
    ("codes/l18-d3-r3.txt", include_str!("../../carried/codes/l18-d3-r3.txt")),
];

/// Where a scenario's files are looked for.
#[derive(Clone, Copy, Debug)]
pub struct Library<'a> {
    /// The scenario's file: paths are relative to its folder.
    pub scenario: &'a Path,
}

impl Library<'_> {
    /// The airframe that a key names.
    ///
    /// # Errors
    /// [`Error`] where there is no such file, or it is no airframe.
    pub fn airframe(&self, key: &str, file: &Path) -> Result<AirframeFile> {
        let (path, bytes) = self.read(key, file)?;
        let text = String::from_utf8(bytes).map_err(|_| Error::format(&path, "it is no text"))?;
        parse_airframe(&text, &path)
    }

    /// The camera that a key names.
    ///
    /// # Errors
    /// [`Error`] where there is no such file, or it is no camera.
    pub fn camera(&self, key: &str, file: &Path) -> Result<CameraFile> {
        let (path, bytes) = self.read(key, file)?;
        parse_camera(&bytes, &path)
    }

    /// The book of words that a key names.
    ///
    /// # Errors
    /// [`Error`] where there is no such file, or it is no book.
    pub fn codes(&self, key: &str, file: &Path) -> Result<CodeBook> {
        let (path, bytes) = self.read(key, file)?;
        let text = String::from_utf8(bytes).map_err(|_| Error::format(&path, "it is no text"))?;
        parse_codes(&text, &path)
    }

    fn read(&self, key: &str, file: &Path) -> Result<(PathBuf, Vec<u8>)> {
        let path = self.scenario.parent().map_or_else(|| file.to_owned(), |folder| folder.join(file));
        if path.is_file() {
            let bytes = std::fs::read(&path).map_err(|error| Error::io(&path, error))?;
            return Ok((path, bytes));
        }
        if let Some((_, text)) = CARRIED.iter().find(|(name, _)| Path::new(name) == file) {
            return Ok((file.to_owned(), text.as_bytes().to_vec()));
        }
        let names = CARRIED.map(|(name, _)| name).join(", ");
        let reason = format!("there is no file {}", path.display());
        Err(Error::format(self.scenario, reason)
            .at(Place::Key(key.to_owned()))
            .advise(format!("paths are taken from the scenario's folder; the program carries {names}")))
    }
}
