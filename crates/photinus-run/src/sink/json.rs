//! Results as JSON lines: into a file that grows, to standard output, to whoever connects to a socket.

use std::fs::File;
use std::io::Write;
use std::path::Path;

use photinus_io::results::ResultsWriter;
use photinus_io::{Error, Result};

use super::{Address, Bystanders, Sink};
use crate::Entry;

/// JSON lines.
pub struct JsonLines {
    name: String,
    place: Place,
    line: Vec<u8>,
}

enum Place {
    Grows(Box<dyn Write + Send>),
    Bystanders(Bystanders),
}

impl JsonLines {
    /// Into a file; what it holds already stays, lines are added.
    ///
    /// # Errors
    /// [`Error`] when it cannot be opened.
    pub fn file(path: &Path) -> Result<Self> {
        let file =
            File::options().append(true).create(true).open(path).map_err(|error| Error::io(path, error))?;
        Ok(Self::new(path.display().to_string(), Place::Grows(Box::new(file))))
    }

    /// To standard output.
    pub fn standard() -> Self {
        Self::new("standard output".to_owned(), Place::Grows(Box::new(std::io::stdout())))
    }

    /// To everybody who connects.
    ///
    /// # Errors
    /// [`Error`] when the address is taken.
    pub fn socket(address: &Address) -> Result<Self> {
        Ok(Self::new(address.to_string(), Place::Bystanders(Bystanders::listen(address)?)))
    }

    fn new(place_name: String, place: Place) -> Self {
        Self { name: format!("json {place_name}"), place, line: Vec::new() }
    }
}

impl Sink for JsonLines {
    fn name(&self) -> String {
        self.name.clone()
    }

    fn frame(&mut self, entry: &Entry) -> Result<()> {
        self.line.clear();
        ResultsWriter::new(&mut self.line, &self.name).write(&entry.record)?;
        match &mut self.place {
            // One call for a line: a reader of the file never sees half of one.
            Place::Grows(file) => file.write_all(&self.line).map_err(|error| Error::io(&self.name, error)),
            Place::Bystanders(all) => {
                all.send(&self.line);
                Ok(())
            }
        }
    }

    fn idle(&mut self) -> Result<()> {
        if let Place::Bystanders(all) = &mut self.place {
            all.send(&[]);
        }
        Ok(())
    }

    fn finish(&mut self) -> Result<()> {
        match &mut self.place {
            Place::Grows(file) => file.flush().map_err(|error| Error::io(&self.name, error)),
            Place::Bystanders(all) => {
                all.send(&[]);
                Ok(())
            }
        }
    }
}
