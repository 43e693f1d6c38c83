//! Which files a dataset is made of, and whether its images lie in its folder.

use std::path::{Component, Path, PathBuf};

use super::{DATASET_FILE, Dataset, DatasetCamera, IMU_FILE, ODOMETRY_FILE, TRUTH_FILE};
use crate::{Error, Place, Result};

impl Dataset {
    /// Every file that the dataset names or may hold, as it can be opened, whether it is there or not.
    pub fn files(&self) -> Vec<PathBuf> {
        let info = self.info();
        let own = [DATASET_FILE, TRUTH_FILE, IMU_FILE, ODOMETRY_FILE].map(PathBuf::from);
        let named = info.airframe.iter().chain(&info.codes).chain(&info.vehicles);
        let flown = self.vehicles().iter().map(|vehicle| &vehicle.airframe_file);
        let of_camera = |camera: &DatasetCamera| {
            let tables = [
                Some(&camera.camera),
                Some(&camera.frames_file),
                camera.mask.as_ref(),
                camera.spot_curve.as_ref(),
            ];
            let images = camera.frames.iter().map(|row| &row.image);
            tables
                .into_iter()
                .flatten()
                .chain(images)
                .chain(&camera.mounting_file)
                .cloned()
                .collect::<Vec<_>>()
        };
        let cameras = self.cameras().iter().flat_map(of_camera);
        own.into_iter()
            .chain(named.chain(flown).cloned())
            .chain(cameras)
            .map(|path| self.path(path))
            .collect()
    }

    /// Checks that every image lies in the dataset's folder: somebody else's dataset names no file of one's own. Links are not
    /// looked through.
    ///
    /// # Errors
    /// [`Error`] with the line of the table that names another place.
    pub fn check_inside(&self) -> Result<()> {
        let is_outside = |path: &Path| {
            !path.components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir))
        };
        for camera in self.cameras() {
            if let Some(row) = camera.frames.iter().find(|row| is_outside(&row.image)) {
                let reason = format!("{} is outside of the dataset's folder", row.image.display());
                return Err(Error::format(self.path(&camera.frames_file), reason).at(Place::Line(row.line)));
            }
        }
        Ok(())
    }
}
