//! A dataset folder: a recording or a simulation with all that is needed to run it.
//!
//! ```text
//! dataset.toml   what the camera, the airframe and the exposure are      -> DatasetInfo
//! frames.csv     which image was taken when, and where down was          -> FrameRow
//! images/        the frames
//! truth.jsonl    optional: where everything was, a line per frame        -> TruthFrame
//! ```

mod files;
mod frames_csv;
mod truth;
mod writer;

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::{Error, Place, Result, table, whole};
pub use frames_csv::{FrameRow, parse_frames_csv};
pub use truth::{TruthFrame, TruthLed, TruthNeighbour, parse_truth, read_truth};
pub use writer::DatasetWriter;

/// The file that makes a folder a dataset.
pub const DATASET_FILE: &str = "dataset.toml";
const FRAMES_FILE: &str = "frames.csv";
const TRUTH_FILE: &str = "truth.jsonl";

/// What dataset.toml says. Paths are relative to the folder.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DatasetInfo {
    /// Any camera file that Photinus reads.
    pub camera: PathBuf,
    /// Any airframe file that Photinus reads.
    pub airframe: PathBuf,
    /// Exposure of a frame, us.
    pub exposure_us: f64,
    /// Frames per second.
    pub rate_hz: f64,
    /// The spot-size curve of this camera, if it was measured.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub spot_curve: Option<PathBuf>,
    /// Where not to look, if something is in the way.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mask: Option<PathBuf>,
}

impl DatasetInfo {
    /// Reads the text of a dataset.toml; `path` is for the messages.
    ///
    /// # Errors
    /// [`Error`] for unknown or missing keys and for values that are none.
    pub fn parse(text: &str, path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        let info: Self = table::parse(text, path)?;
        info.check(path)?;
        Ok(info)
    }

    fn check(&self, path: &Path) -> Result<()> {
        for (key, value) in [("exposure_us", self.exposure_us), ("rate_hz", self.rate_hz)] {
            if !(value.is_finite() && value > 0.0) {
                return Err(Error::format(path, format!("{value} is not a positive number"))
                    .at(Place::Key(key.to_owned()))
                    .advise("give the value that the camera ran with"));
            }
        }
        let paths = [
            ("camera", Some(&self.camera)),
            ("airframe", Some(&self.airframe)),
            ("spot_curve", self.spot_curve.as_ref()),
            ("mask", self.mask.as_ref()),
        ];
        for (key, named) in paths {
            if named.is_some_and(|named| named.as_os_str().is_empty()) {
                return Err(Error::format(path, "the path is empty")
                    .at(Place::Key(key.to_owned()))
                    .advise("name a file in the dataset's folder"));
            }
        }
        Ok(())
    }
}

/// A dataset folder whose dataset.toml and frames.csv are in order. Images are opened when their turn comes.
#[derive(Clone, Debug, PartialEq)]
pub struct Dataset {
    folder: PathBuf,
    info: DatasetInfo,
    frames: Vec<FrameRow>,
}

impl Dataset {
    /// Reads a dataset folder.
    ///
    /// # Errors
    /// [`Error`] when dataset.toml or frames.csv is missing or not in order.
    pub fn read(folder: impl AsRef<Path>) -> Result<Self> {
        let folder = folder.as_ref().to_owned();
        let in_folder = |name: &str| {
            let path = folder.join(name);
            match path.is_file() {
                true => whole::read_text(&path).map(|text| (text, path)),
                false => Err(Error::format(&folder, format!("the folder holds no {name}"))
                    .advise("name the folder of a dataset, or list the image files themselves")),
            }
        };
        let (text, path) = in_folder(DATASET_FILE)?;
        let info = DatasetInfo::parse(&text, path)?;
        let (text, path) = in_folder(FRAMES_FILE)?;
        let frames = parse_frames_csv(&text, path)?;
        Ok(Self { folder, info, frames })
    }

    /// What dataset.toml says.
    pub fn info(&self) -> &DatasetInfo {
        &self.info
    }

    /// What frames.csv lists, in its order.
    pub fn frames(&self) -> &[FrameRow] {
        &self.frames
    }

    /// A path that dataset.toml or frames.csv names, as it can be opened.
    pub fn path(&self, named: impl AsRef<Path>) -> PathBuf {
        self.folder.join(named)
    }

    /// The truth of every frame that has one; `None` when the folder holds none.
    ///
    /// # Errors
    /// As [`read_truth`].
    pub fn truth(&self) -> Result<Option<Vec<TruthFrame>>> {
        let path = self.path(TRUTH_FILE);
        path.is_file().then(|| read_truth(path)).transpose()
    }
}

#[cfg(test)]
mod tests;
