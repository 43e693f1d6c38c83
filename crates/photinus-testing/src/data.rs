//! Real photos, calibrations and layouts, which cannot be part of the repository.

use std::path::{Path, PathBuf};

use crate::Skipped;

/// `place` in the folder of real data that `PHOTINUS_DATA` names; where there is none, the calling test is listed as
/// skipped.
///
/// # Panics
/// When the folder is there and lacks `place`: a test that then skipped would hide a wrong name.
#[must_use]
pub fn real_data(place: &str) -> Option<PathBuf> {
    let (data, is_named) = match std::env::var_os("PHOTINUS_DATA") {
        Some(named) => (PathBuf::from(named), true),
        None => (Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data"), false),
    };
    if data.is_dir() {
        let path = data.join(place);
        assert!(path.exists(), "the real data in {} lack {place}", data.display());
        return Some(path);
    }
    assert!(!is_named, "PHOTINUS_DATA names {}, which is no folder", data.display());
    Skipped::current_test("there are no real data (PHOTINUS_DATA names their folder)");
    None
}
