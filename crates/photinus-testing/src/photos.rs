//! Natural photos: those that the Python package scikit-image ships, which cannot be part of the repository.

use std::path::PathBuf;

use crate::{Skipped, python_with};

/// Prints the folder of the photos.
const FOLDER: &str = "import importlib.util as u, os; print(os.path.join(u.find_spec('skimage').submodule_search_locations[0], 'data'))";

/// The PNG and JPEG files in the folder that `PHOTINUS_PHOTOS` names, or in that of an installed scikit-image, by
/// name; where there is neither, the calling test is listed as skipped.
///
/// # Panics
/// When the folder holds none: a test that then passed would have looked at nothing.
#[must_use]
pub fn natural_photos() -> Option<Vec<PathBuf>> {
    let folder = match std::env::var_os("PHOTINUS_PHOTOS") {
        Some(named) => PathBuf::from(named),
        None => installed()?,
    };
    let is_photo = |path: &PathBuf| {
        path.extension().is_some_and(|kind| ["png", "jpg"].iter().any(|known| kind == *known))
    };
    let entries = std::fs::read_dir(&folder).into_iter().flatten().flatten();
    let mut photos: Vec<PathBuf> = entries.map(|entry| entry.path()).filter(is_photo).collect();
    assert!(!photos.is_empty(), "there is no photo in {}", folder.display());
    photos.sort();
    Some(photos)
}

fn installed() -> Option<PathBuf> {
    let told = python_with(&["skimage"]).and_then(|mut python| python.args(["-c", FOLDER]).output().ok());
    let told = told.filter(|output| output.status.success());
    if told.is_none() {
        Skipped::current_test(
            "there are no natural photos (PHOTINUS_PHOTOS names a folder of them, such as skimage/data)",
        );
    }
    told.map(|output| PathBuf::from(String::from_utf8_lossy(&output.stdout).trim()))
}
