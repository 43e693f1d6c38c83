//! A dataset folder: a recording or a simulation with all that is needed to run it.
//!
//! ```text
//! dataset.toml   what the cameras, the airframe and the exposure are     -> DatasetToml
//! frames.csv     which image was taken when, and where down was          -> FrameRow
//! images/        the frames
//! truth.jsonl    optional: where everything was, a line per frame        -> TruthFrame
//! vehicles.toml  optional: who there may be and what they blink          -> Vehicle
//! imu.csv        optional: how fast what carries the camera turns        -> ImuRow
//! odometry.csv   optional: where it believes to be                       -> OdometryRow
//! ```
//! Several cameras on one vehicle each have a frames.csv and a mounting of their own.

mod airframe_key;
mod camera_key;
mod cameras;
mod files;
mod frames_csv;
mod gravity;
mod imu;
mod info;
mod odometry;
mod timed;
mod truth;
mod vehicles;
mod writer;

use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use photinus::identity::CodeBook;

use crate::codes::read_codes;
use crate::sky::Sky;
use crate::{Error, Result, airframe, whole};
pub use airframe_key::AirframeFiles;
pub use cameras::DatasetCamera;
pub use frames_csv::{FrameRow, parse_frames_csv};
pub use gravity::GravityLog;
pub use imu::{ImuRow, parse_imu, read_imu};
pub use info::{DatasetInfo, DatasetToml, RigCamera, RigInfo};
pub use odometry::{
    OdometryRow, PoseError, TimedPose, parse_odometry, parse_poses, read_odometry, read_poses,
};
pub use truth::{TruthFrame, TruthLed, TruthNeighbour, parse_truth, read_truth};
pub use vehicles::{Vehicle, VehicleBlink, VehicleInfo, parse_vehicles, vehicles_text};
pub use writer::DatasetWriter;

/// The file that makes a folder a dataset.
pub const DATASET_FILE: &str = "dataset.toml";
/// The frames of a dataset with one camera.
pub const FRAMES_FILE: &str = "frames.csv";
/// Where everything was.
pub const TRUTH_FILE: &str = "truth.jsonl";
/// How fast what carries the camera turns.
pub const IMU_FILE: &str = "imu.csv";
/// Where what carries the camera believes to be.
pub const ODOMETRY_FILE: &str = "odometry.csv";

/// A dataset folder whose tables are in order. Images, truth and the tables over time are opened when their turn comes.
#[derive(Clone, Debug, PartialEq)]
pub struct Dataset {
    folder: PathBuf,
    info: DatasetInfo,
    cameras: Vec<DatasetCamera>,
    codes: Option<CodeBook>,
    vehicles: Vec<Vehicle>,
}

impl Dataset {
    /// Reads a dataset folder.
    ///
    /// # Errors
    /// [`Error`] when dataset.toml or a frames.csv is missing or not in order, or a mounting, the book of words, the list of
    /// vehicles or an airframe that it lists is named there and is missing or not in order.
    pub fn read(folder: impl AsRef<Path>) -> Result<Self> {
        let folder = folder.as_ref().to_owned();
        let (text, path) = in_folder(&folder, Path::new(DATASET_FILE))?;
        let (info, cameras) = match DatasetToml::parse(&text, path)? {
            DatasetToml::One(info) => (info.clone(), vec![DatasetCamera::only(&folder, info)?]),
            DatasetToml::Rig(rig) => {
                let camera = |camera: &RigCamera| DatasetCamera::of_rig(&folder, camera, rig.exposure_us);
                let cameras = rig.cameras.iter().map(camera).collect::<Result<Vec<_>>>()?;
                (rig.first(), cameras)
            }
        };
        let codes = info.codes.as_ref().map(|named| read_codes(folder.join(named))).transpose()?;
        let vehicles = match &info.vehicles {
            Some(named) => {
                let (text, path) = in_folder(&folder, named)?;
                vehicles_of(&text, (&path, &folder), codes.as_ref())?
            }
            None => Vec::new(),
        };
        Ok(Self { folder, info, cameras, codes, vehicles })
    }

    /// What dataset.toml says; of several cameras, what it says of the first one. See [`Dataset::cameras`] for all of them.
    pub fn info(&self) -> &DatasetInfo {
        &self.info
    }

    /// The cameras, at least one; a dataset with one camera file at its top has exactly one, without name and mounting.
    pub fn cameras(&self) -> &[DatasetCamera] {
        &self.cameras
    }

    /// What the frames.csv of the first camera lists, in its order.
    pub fn frames(&self) -> &[FrameRow] {
        &self.cameras[0].frames
    }

    /// A path that a file of the dataset names, as it can be opened.
    pub fn path(&self, named: impl AsRef<Path>) -> PathBuf {
        self.folder.join(named)
    }

    /// The book of code words, where one is named.
    pub fn codes(&self) -> Option<&CodeBook> {
        self.codes.as_ref()
    }

    /// The vehicles that there may be; empty when the dataset does not list them.
    pub fn vehicles(&self) -> &[Vehicle] {
        &self.vehicles
    }

    /// The airframes of the vehicles that there may be, a file each, as they can be opened: those that dataset.toml names, and further ones of its vehicles.
    pub fn airframes(&self) -> Vec<PathBuf> {
        let mut files: Vec<&PathBuf> = Vec::new();
        for file in
            self.info.airframe.iter().chain(self.vehicles.iter().map(|vehicle| &vehicle.airframe_file))
        {
            if !files.contains(&file) {
                files.push(file);
            }
        }
        files.into_iter().map(|file| self.path(file)).collect()
    }

    /// The sky over the recording, where dataset.toml tells place and time.
    pub fn sky(&self) -> Option<Sky> {
        // It was read when dataset.toml was.
        self.info.sky.as_ref().and_then(|sky| Sky::new(sky, DATASET_FILE).ok())
    }

    /// The truth of every frame that has one; `None` when the folder holds none.
    ///
    /// # Errors
    /// As [`read_truth`].
    pub fn truth(&self) -> Result<Option<Vec<TruthFrame>>> {
        self.optional(TRUTH_FILE, read_truth)
    }

    /// How fast the camera (of several: the vehicle's body) turned; `None` when the folder does not say.
    ///
    /// # Errors
    /// As [`read_imu`].
    pub fn imu(&self) -> Result<Option<Vec<ImuRow>>> {
        self.optional(IMU_FILE, read_imu)
    }

    /// Where the vehicle with the cameras believed to be; `None` when the folder does not say.
    ///
    /// # Errors
    /// As [`read_odometry`].
    pub fn odometry(&self) -> Result<Option<Vec<OdometryRow>>> {
        self.optional(ODOMETRY_FILE, read_odometry)
    }

    fn optional<T>(&self, name: &str, read: impl FnOnce(PathBuf) -> Result<T>) -> Result<Option<T>> {
        let path = self.path(name);
        path.is_file().then(|| read(path)).transpose()
    }
}

impl RigInfo {
    /// What it says of the first camera.
    fn first(&self) -> DatasetInfo {
        let first = &self.cameras[0];
        DatasetInfo {
            camera: first.camera.clone(),
            airframe: self.airframe.clone(),
            exposure_us: first.exposure_us.unwrap_or(self.exposure_us),
            rate_hz: self.rate_hz,
            spot_curve: first.spot_curve.clone(),
            mask: first.mask.clone(),
            codes: self.codes.clone(),
            vehicles: self.vehicles.clone(),
            sky: self.sky.clone(),
        }
    }
}

/// The text and the path of a file that the folder must hold.
fn in_folder(folder: &Path, name: &Path) -> Result<(String, PathBuf)> {
    let path = folder.join(name);
    match path.metadata() {
        Ok(found) if found.is_file() => whole::read_text(&path).map(|text| (text, path)),
        Err(error) if error.kind() == ErrorKind::PermissionDenied => Err(Error::io(&path, error)),
        Err(error) if !folder.exists() => Err(Error::io(folder, error)),
        _ => Err(Error::format(folder, format!("the folder holds no {}", name.display()))
            .advise("name the folder of a dataset, or list the image files themselves")),
    }
}

/// Reads a list of vehicles; the airframes that it names are relative to its folder.
///
/// # Errors
/// As [`parse_vehicles`], and for words that the book does not hold, and files that cannot be read.
pub fn read_vehicles(path: impl AsRef<Path>, codes: Option<&CodeBook>) -> Result<Vec<Vehicle>> {
    let path = path.as_ref();
    let folder = path.parent().unwrap_or(Path::new(""));
    vehicles_of(&whole::read_text(path)?, (path, folder), codes)
}

/// The vehicles of a list, whose airframes are relative to `folder`.
fn vehicles_of(text: &str, (path, folder): (&Path, &Path), codes: Option<&CodeBook>) -> Result<Vec<Vehicle>> {
    let vehicles = parse_vehicles(text, path)?.into_iter().enumerate();
    vehicles
        .map(|(index, vehicle)| {
            let airframe = airframe::read_airframe(folder.join(&vehicle.airframe))?.airframe;
            vehicle.with(airframe, codes, (index, path))
        })
        .collect()
}

#[cfg(test)]
mod rig_tests;
#[cfg(test)]
mod tests;
