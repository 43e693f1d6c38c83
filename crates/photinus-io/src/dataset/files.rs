//! Which files a dataset is made of, and whether its images lie in its folder.

use std::path::{Component, Path, PathBuf};

use super::{DATASET_FILE, Dataset, FRAMES_FILE, TRUTH_FILE};
use crate::{Error, Place, Result};

impl Dataset {
    /// Every file that the dataset names or may hold, as it can be opened, whether it is there or not.
    pub fn files(&self) -> Vec<PathBuf> {
        let info = self.info();
        let named = [Some(&info.camera), Some(&info.airframe), info.spot_curve.as_ref(), info.mask.as_ref()];
        let own = [DATASET_FILE, FRAMES_FILE, TRUTH_FILE].map(|name| self.path(name));
        let images = self.frames().iter().map(|row| self.path(&row.image));
        own.into_iter().chain(named.into_iter().flatten().map(|path| self.path(path))).chain(images).collect()
    }

    /// Checks that every image lies in the dataset's folder: somebody else's dataset names no file of one's own. Links are not
    /// looked through.
    ///
    /// # Errors
    /// [`Error`] with the line of frames.csv that names another place.
    pub fn check_inside(&self) -> Result<()> {
        let is_outside = |path: &Path| {
            !path.components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir))
        };
        match self.frames().iter().find(|row| is_outside(&row.image)) {
            None => Ok(()),
            Some(row) => {
                let reason = format!("{} is outside of the dataset's folder", row.image.display());
                Err(Error::format(self.path(FRAMES_FILE), reason).at(Place::Line(row.line)))
            }
        }
    }
}
