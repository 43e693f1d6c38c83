//! Health and notices as JSON lines, in a file that grows: `{"health":{...}}` once a second, `{"notice":{...}}` when something happens.

use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};

use photinus_io::{Error, Result};
use serde::Serialize;

use super::Sink;
use crate::Entry;
use crate::health::{Health, Notice};

/// Health in a file.
pub struct HealthLines {
    file: File,
    path: PathBuf,
}

#[derive(Serialize)]
#[serde(rename_all = "lowercase")]
enum Line<'a> {
    Health(&'a Health),
    Notice(&'a Notice),
}

impl HealthLines {
    /// Into a file; what it holds already stays, lines are added.
    ///
    /// # Errors
    /// [`Error`] when it cannot be opened.
    pub fn file(path: &Path) -> Result<Self> {
        let file =
            File::options().append(true).create(true).open(path).map_err(|error| Error::io(path, error))?;
        Ok(Self { file, path: path.to_owned() })
    }

    fn write(&mut self, line: &Line<'_>) -> Result<()> {
        let mut text = serde_json::to_string(line).map_err(|error| Error::io(&self.path, error.into()))?;
        text.push('\n');
        self.file.write_all(text.as_bytes()).map_err(|error| Error::io(&self.path, error))
    }
}

impl Sink for HealthLines {
    fn name(&self) -> String {
        format!("health {}", self.path.display())
    }

    fn frame(&mut self, _entry: &Entry) -> Result<()> {
        Ok(())
    }

    fn health(&mut self, health: &Health) -> Result<()> {
        self.write(&Line::Health(health))
    }

    fn notice(&mut self, notice: &Notice) -> Result<()> {
        self.write(&Line::Notice(notice))
    }
}
