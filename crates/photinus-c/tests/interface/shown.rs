//! A simulated frame of a quadrotor, as files that a program in C can read.

use std::path::{Path, PathBuf};

use photinus_sim::{Scene, Simulator};
use tempfile::TempDir;

/// The files, and the frame's size.
pub(crate) struct Shown {
    folder: TempDir,
    pub(crate) pixels: Vec<u8>,
    pub(crate) width: usize,
    pub(crate) height: usize,
}

pub(crate) fn scenes() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes")
}

pub(crate) fn camera() -> String {
    scenes().join("cameras/bluefox-dsl215.toml").to_str().unwrap().to_owned()
}

pub(crate) fn airframe() -> String {
    scenes().join("airframes/quadrotor-0.245.toml").to_str().unwrap().to_owned()
}

impl Shown {
    pub(crate) fn new() -> Self {
        let scene = Scene::read(scenes().join("near-pass.toml")).unwrap_or_else(|error| panic!("{error}"));
        let frame = Simulator::new(&scene, 0).unwrap().frame(100).image;
        let (width, height) = (frame.width(), frame.height());
        let pixels: Vec<u8> = (0..height).flat_map(|row| frame.view().row(row).to_vec()).collect();
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("frame.grey"), &pixels).unwrap();
        Self { folder, pixels, width, height }
    }

    pub(crate) fn path(&self) -> String {
        self.folder.path().join("frame.grey").to_str().unwrap().to_owned()
    }
}
