//! The cameras of a dataset, each with its frames.

use std::path::{Path, PathBuf};

use super::info::{DatasetInfo, RigCamera};
use super::{FRAMES_FILE, FrameRow, in_folder, parse_frames_csv};
use crate::Result;
use crate::calibration::{MountingFile, read_mounting};

/// A camera of a dataset and its frames. Paths are relative to the dataset's folder: see [`super::Dataset::path`].
#[derive(Clone, Debug, PartialEq)]
pub struct DatasetCamera {
    /// What it is called; the one camera of a dataset without `[[camera]]` has no name.
    pub name: Option<String>,
    /// Any camera file that Photinus reads.
    pub camera: PathBuf,
    /// How it sits on the vehicle, where the dataset says so.
    pub mounting: Option<MountingFile>,
    /// Exposure of a frame, us.
    pub exposure_us: f64,
    /// Where not to look, if something is in the way.
    pub mask: Option<PathBuf>,
    /// Its spot-size curve, if it was measured.
    pub spot_curve: Option<PathBuf>,
    /// The table of its frames.
    pub frames_file: PathBuf,
    /// What that table lists, in its order.
    pub frames: Vec<FrameRow>,
}

impl DatasetCamera {
    pub(super) fn only(folder: &Path, info: DatasetInfo) -> Result<Self> {
        Ok(Self {
            name: None,
            camera: info.camera,
            mounting: None,
            exposure_us: info.exposure_us,
            mask: info.mask,
            spot_curve: info.spot_curve,
            frames: frames(folder, Path::new(FRAMES_FILE))?,
            frames_file: FRAMES_FILE.into(),
        })
    }

    pub(super) fn of_rig(folder: &Path, camera: &RigCamera, exposure_us: f64) -> Result<Self> {
        Ok(Self {
            name: Some(camera.name.clone()),
            camera: camera.camera.clone(),
            mounting: Some(read_mounting(folder.join(&camera.mounting))?),
            exposure_us: camera.exposure_us.unwrap_or(exposure_us),
            mask: camera.mask.clone(),
            spot_curve: camera.spot_curve.clone(),
            frames: frames(folder, &camera.frames)?,
            frames_file: camera.frames.clone(),
        })
    }
}

fn frames(folder: &Path, name: &Path) -> Result<Vec<FrameRow>> {
    let (text, path) = in_folder(folder, name)?;
    parse_frames_csv(&text, path)
}
