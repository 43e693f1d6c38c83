//! What kind of file a path names: enters a path or the beginning of a file, leaves its [`Kind`].
//!
//! The content decides, never the name. Every reader that refuses a file, `info` and `convert` ask here, so that a file has one
//! name wherever it is spoken of.
//!
//! ```text
//! binary  pictures, videos, archives, by their first bytes
//! text    cameras, airframes, tables, results, by their first line and their keys
//! keys    the keys at the top of a JSON, TOML or YAML text, however it goes on
//! ```

mod binary;
mod keys;
#[cfg(test)]
mod tests;
mod text;

use std::fmt;
use std::io::Read;
use std::path::{Path, PathBuf};

use crate::dataset::DATASET_FILE;
use crate::whole::open_regular;
use crate::{CameraFormat, Error, Result};
pub(crate) use text::is_kalibr_camera;

/// As much of a file as tells what it is.
const HEAD_BYTES: u64 = 64 << 10;

/// The kinds of files and folders.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A folder with a dataset.toml.
    Dataset,
    /// A folder with images and no dataset.toml.
    ImageFolder,
    /// Any other folder.
    Folder,
    /// A still image.
    Image,
    /// A Y4M video.
    Video,
    /// An MCAP recording, such as a bag of ROS 2.
    Recording,
    /// A bag of ROS 1.
    Bag,
    /// A file of other programs that Photinus does not read.
    Foreign(Foreign),
    /// A camera.
    Camera(CameraFormat),
    /// An airframe, or an LED layout.
    Airframe,
    /// Code words that LEDs blink.
    Blink,
    /// How large spots are by distance.
    SpotCurve,
    /// How a camera sits on its vehicle.
    Mounting,
    /// The scene of a simulation.
    Scene,
    /// A scene's table of a lens, or of a point spread.
    PointSpread,
    /// A scene's table of a sensor.
    Sensor,
    /// The dataset.toml of a dataset.
    DatasetTable,
    /// The vehicles.toml of a dataset.
    Vehicles,
    /// The truth.jsonl of a dataset.
    Truth,
    /// Results, or spots in their place, as JSON lines.
    Results,
    /// Scores, as `evaluate --json` writes them.
    Scores,
    /// The report.json of a camera calibration.
    CalibrationReport,
    /// Spot curves with their errors, as `calibrate spot-size --json` writes them.
    SpotSizeReport,
    /// A page for a browser, as reports are.
    Page,
    /// A drawing as SVG, as figures are.
    Drawing,
    /// A table with named columns.
    Table(Table),
    /// A text with keys that no file of Photinus has.
    Keys(Syntax),
    /// Text that is nothing else.
    Text,
    /// Bytes that are nothing else.
    Binary,
    /// Nothing, or nothing but comments.
    Empty,
}

/// Files of other programs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Foreign {
    /// MP4, MOV.
    Mp4,
    /// MKV, WebM.
    Matroska,
    /// AVI.
    Avi,
    /// A database, as older bags of ROS 2 are.
    Sqlite,
    /// gzip.
    Gzip,
    /// ZIP.
    Zip,
    /// PDF.
    Pdf,
}

/// Tables with named columns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Table {
    /// The frames.csv of a dataset.
    Frames,
    /// The imu.csv of a dataset.
    Gyro,
    /// The direction of gravity over time.
    Gravity,
    /// The odometry.csv of a dataset.
    Odometry,
    /// Poses over time.
    Poses,
    /// Results, a row per neighbour.
    Results,
    /// Points of a grid in photos.
    Corners,
    /// Spot sizes at known distances.
    SpotSizes,
    /// LEDs in photos of an airframe.
    LedSightings,
    /// Places in the image of known directions or positions.
    KnownSightings,
    /// The points of a figure of `reproduce`.
    Figure,
    /// The summary of `reproduce`.
    Summary,
    /// Columns that no table of Photinus has.
    Unknown,
}

/// How keys are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Syntax {
    /// `key = value`
    Toml,
    /// `key: value`
    Yaml,
    /// `{"key": value}`
    Json,
}

impl Kind {
    /// The kind of a file or folder.
    ///
    /// # Errors
    /// [`Error`] when it cannot be read, or is standard input, which can be read only once.
    pub fn of(path: &Path) -> Result<Self> {
        if path.as_os_str() == "-" {
            let refused = Error::format(path, "what it holds can be told of files only");
            return Err(refused.advise("save it to a file first"));
        }
        if path.is_dir() {
            return Self::of_folder(path);
        }
        let mut head = Vec::new();
        open_regular(path)?
            .take(HEAD_BYTES)
            .read_to_end(&mut head)
            .map_err(|error| Error::io(path, error))?;
        Ok(Self::of_content(&head))
    }

    /// The kind of a file that begins with these bytes, or is nothing but them.
    pub fn of_content(head: &[u8]) -> Self {
        binary::kind(head).unwrap_or_else(|| text::kind(&String::from_utf8_lossy(head)))
    }

    fn of_folder(folder: &Path) -> Result<Self> {
        if folder.join(DATASET_FILE).is_file() {
            return Ok(Self::Dataset);
        }
        Ok(if images_in(folder)?.is_empty() { Self::Folder } else { Self::ImageFolder })
    }

    /// Whether frames can be read from it.
    pub fn holds_frames(self) -> bool {
        matches!(
            self,
            Self::Dataset | Self::ImageFolder | Self::Image | Self::Video | Self::Recording | Self::Bag
        )
    }

    /// Refuses this file where another kind is `wanted`, such as "a camera"; `known` is what such files look like.
    pub fn refuse(self, path: &Path, wanted: &str, known: &str) -> Error {
        let refused = Error::format(path, format!("this is {self}, not {wanted}"));
        match self.remedy(path) {
            Some(remedy) => refused.advise(remedy),
            None => refused.advise(known),
        }
    }

    /// Refuses what is surely another kind than `wanted`; what is not recognised is left to the reader of `wanted`, who says what
    /// is missing in it.
    ///
    /// # Errors
    /// [`Error`] that names the kind.
    pub fn expect(self, wanted: Self, path: &Path, known: &str) -> Result<()> {
        let is_open = matches!(self, Self::Keys(_) | Self::Text | Self::Empty | Self::Table(Table::Unknown));
        if self == wanted || is_open { Ok(()) } else { Err(self.refuse(path, &wanted.to_string(), known)) }
    }

    /// What to do with a file that Photinus does not read itself.
    pub fn remedy(self, path: &Path) -> Option<String> {
        match self {
            Self::Foreign(Foreign::Mp4 | Foreign::Matroska | Foreign::Avi) => Some(decoding(path)),
            Self::Foreign(Foreign::Sqlite) => Some(
                "make it an MCAP recording with `rosbags-convert` of the Python package rosbags".to_owned(),
            ),
            Self::Foreign(Foreign::Gzip | Foreign::Zip) => Some("unpack it first".to_owned()),
            Self::Page | Self::Drawing => Some("open it in a browser".to_owned()),
            Self::Folder => {
                let page = path.join("index.html");
                page.is_file().then(|| format!("open {} in a browser", page.display()))
            }
            _ => None,
        }
    }
}

/// How a compressed video becomes frames that Photinus reads.
pub fn decoding(video: &Path) -> String {
    format!(
        "decode it into a pipe: `ffmpeg -i {} -pix_fmt gray -f yuv4mpegpipe -strict -1 - | photinus locate - ...`, or into \
         a file: end that line in video.y4m instead of `-`",
        video.display()
    )
}

/// The image files of a folder by the order of their names, told by their extension.
///
/// # Errors
/// [`Error`] when the folder cannot be listed.
pub fn images_in(folder: &Path) -> Result<Vec<PathBuf>> {
    let listed = std::fs::read_dir(folder).and_then(Iterator::collect::<std::io::Result<Vec<_>>>);
    let entries = listed.map_err(|error| Error::io(folder, error))?;
    let mut images: Vec<PathBuf> =
        entries.iter().map(std::fs::DirEntry::path).filter(|path| is_named_as_image(path)).collect();
    images.sort();
    Ok(images)
}

/// Whether a path is named as an image file is.
pub fn is_named_as_image(path: &Path) -> bool {
    const EXTENSIONS: [&str; 9] = ["png", "jpg", "jpeg", "bmp", "tif", "tiff", "pgm", "ppm", "pnm"];
    let is_hidden = path.file_name().is_some_and(|name| name.to_string_lossy().starts_with('.'));
    let extension = path.extension().map(|extension| extension.to_string_lossy().to_lowercase());
    !is_hidden && extension.is_some_and(|extension| EXTENSIONS.contains(&extension.as_str()))
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Dataset => "a dataset",
            Self::ImageFolder => "a folder of images",
            Self::Folder => "a folder without frames",
            Self::Image => "an image",
            Self::Recording => "an MCAP recording",
            Self::Bag => "a bag of ROS 1",
            Self::Video => "a Y4M video",
            Self::Foreign(foreign) => foreign.what(),
            Self::Camera(CameraFormat::OcamText) => "a camera in OCamCalib text",
            Self::Camera(CameraFormat::Toml) => "a camera in Photinus TOML",
            Self::Camera(CameraFormat::UvdarYaml) => "a camera in UVDAR YAML",
            Self::Camera(CameraFormat::Kalibr) => "a camera in Kalibr YAML",
            Self::Camera(CameraFormat::CameraInfo) => "a camera in ROS CameraInfo YAML",
            Self::Camera(CameraFormat::Pyocamcalib) => "a camera in pyocamcalib JSON",
            Self::Airframe => "an airframe",
            Self::Blink => "a list of blink sequences",
            Self::SpotCurve => "a curve of spot sizes",
            Self::Mounting => "the mounting of a camera",
            Self::Scene => "a scene for `photinus simulate`",
            Self::PointSpread => "the lens of a scene, or its point spread",
            Self::Sensor => "the sensor of a scene",
            Self::DatasetTable => "the dataset.toml of a dataset",
            Self::Vehicles => "the vehicles.toml of a dataset",
            Self::Truth => "ground truth",
            Self::Results => "results, or spots in place of frames",
            Self::Scores => "scores of `photinus evaluate`",
            Self::CalibrationReport => "the report of a camera calibration",
            Self::SpotSizeReport => "the report of a spot size calibration",
            Self::Page => "a page for a browser",
            Self::Drawing => "a drawing as SVG",
            Self::Table(table) => table.what(),
            Self::Keys(Syntax::Toml) => "TOML with keys that Photinus does not know",
            Self::Keys(Syntax::Yaml) => "YAML with keys that Photinus does not know",
            Self::Keys(Syntax::Json) => "JSON with keys that Photinus does not know",
            Self::Text => "text in no format that Photinus knows",
            Self::Binary => "binary data in no format that Photinus knows",
            Self::Empty => "a file that holds nothing, or nothing but comments",
        })
    }
}

impl Foreign {
    fn what(self) -> &'static str {
        match self {
            Self::Mp4 => "an MP4 video",
            Self::Matroska => "a Matroska video",
            Self::Avi => "an AVI video",
            Self::Sqlite => "an SQLite database, such as a bag of ROS 2",
            Self::Gzip => "a gzip archive",
            Self::Zip => "a ZIP archive",
            Self::Pdf => "a PDF document",
        }
    }
}

impl Table {
    fn what(self) -> &'static str {
        match self {
            Self::Frames => "the frames.csv of a dataset",
            Self::Gyro => "the imu.csv of a dataset",
            Self::Gravity => "a table of gravity over time",
            Self::Odometry => "the odometry.csv of a dataset",
            Self::Poses => "a table of poses",
            Self::Results => "results as a table",
            Self::Corners => "a table of grid points in photos",
            Self::SpotSizes => "a table of spot sizes",
            Self::LedSightings => "a table of LEDs in photos",
            Self::KnownSightings => "a table of known directions or positions in the image",
            Self::Figure => "the data of a figure of `photinus reproduce`",
            Self::Summary => "the summary of `photinus reproduce`",
            Self::Unknown => "a table whose columns Photinus does not know",
        }
    }
}
