//! A dataset folder, written frame by frame.

use std::fs::File;
use std::io::{LineWriter, Write};
use std::path::{Path, PathBuf};

use nalgebra::{Unit, Vector3};
use photinus::frame::FrameView;

use super::frames_csv::COLUMNS;
use super::{DATASET_FILE, DatasetInfo, FRAMES_FILE, TRUTH_FILE, TruthFrame};
use crate::{Error, Place, Result, image, lines};

/// Writes a dataset folder. What was written before a crash is a dataset of its own.
#[derive(Debug)]
pub struct DatasetWriter {
    folder: PathBuf,
    frames: LineWriter<File>,
    truth: Option<LineWriter<File>>,
    next: u64,
    last_time_s: f64,
}

impl DatasetWriter {
    /// Starts a dataset in `folder`, which is made; the files that `info` names are the caller's to put there.
    ///
    /// # Errors
    /// [`Error`] when the folder holds a dataset already, cannot be written, or `info` is not in order.
    pub fn create(folder: impl AsRef<Path>, info: &DatasetInfo) -> Result<Self> {
        let folder = folder.as_ref().to_owned();
        let dataset_file = folder.join(DATASET_FILE);
        info.check(&dataset_file)?;
        let text = toml::to_string(info).map_err(|error| Error::format(&dataset_file, error.to_string()))?;
        let images = folder.join("images");
        std::fs::create_dir_all(&images).map_err(|error| Error::io(&images, error))?;
        let mut file = File::create_new(&dataset_file).map_err(|error| Error::io(&dataset_file, error))?;
        file.write_all(text.as_bytes()).map_err(|error| Error::io(&dataset_file, error))?;
        let frames = create(&folder.join(FRAMES_FILE), &format!("{}\n", COLUMNS.join(",")))?;
        Ok(Self { folder, frames, truth: None, next: 0, last_time_s: f64::NEG_INFINITY })
    }

    /// Adds a frame taken at `time_s`, with the direction of gravity in the camera frame where that is known, and
    /// gives its number, the next one.
    ///
    /// # Errors
    /// As [`DatasetWriter::numbered_frame`].
    pub fn frame(
        &mut self,
        frame: &FrameView<'_>,
        time_s: f64,
        gravity: Option<Unit<Vector3<f64>>>,
    ) -> Result<u64> {
        let number = self.next;
        self.numbered_frame(number, frame, time_s, gravity)?;
        Ok(number)
    }

    /// Adds a frame that has a number already, of those of another recording.
    ///
    /// # Errors
    /// [`Error`] when a file cannot be written, or when the number or the time does not come after that of the frame
    /// before.
    pub fn numbered_frame(
        &mut self,
        number: u64,
        frame: &FrameView<'_>,
        time_s: f64,
        gravity: Option<Unit<Vector3<f64>>>,
    ) -> Result<()> {
        let refuse = |reason: String| {
            Err(Error::format(self.folder.join(FRAMES_FILE), reason)
                .at(Place::Frame(number))
                .advise("write frames in the order in which they were taken"))
        };
        if number < self.next {
            return refuse(format!("number {number} does not come after the frame before"));
        }
        if !(time_s.is_finite() && time_s > self.last_time_s) {
            return refuse(format!("{time_s} s is no time after the frame before"));
        }
        let name = format!("images/{number:06}.png");
        image::write_png(self.folder.join(&name), frame)?;
        let down = gravity.map_or(",,".to_owned(), |g| format!("{},{},{}", g.x, g.y, g.z));
        writeln!(self.frames, "{number},{time_s},{name},{down}")
            .map_err(|error| Error::io(self.folder.join(FRAMES_FILE), error))?;
        (self.next, self.last_time_s) = (number.saturating_add(1), time_s);
        Ok(())
    }

    /// Adds the truth of a frame.
    ///
    /// # Errors
    /// [`Error`] when the file cannot be written or a number is not finite.
    pub fn truth(&mut self, truth: &TruthFrame) -> Result<()> {
        let path = self.folder.join(TRUTH_FILE);
        if !truth.is_finite() {
            return Err(Error::format(path, "a number of the truth is not finite")
                .at(Place::Frame(truth.frame))
                .advise("leave out what is not known"));
        }
        let file = match &mut self.truth {
            Some(file) => file,
            none => none.insert(create(&path, "")?),
        };
        lines::write_json(file, truth, &path)
    }
}

fn create(path: &Path, first: &str) -> Result<LineWriter<File>> {
    let mut file = LineWriter::new(File::create(path).map_err(|error| Error::io(path, error))?);
    file.write_all(first.as_bytes()).map_err(|error| Error::io(path, error))?;
    Ok(file)
}
