//! Whatever the bytes, a scene or a recorded motion is a value or an error, never a panic.
//!
//! The targets in `fuzz/` check the same without an end; these are the part that fits a test run.

use std::path::{Path, PathBuf};

use photinus_sim::motion::Recorded;
use photinus_sim::scene::Scene;
use photinus_testing::damage;
use proptest::prelude::*;

const POSES: &str = "time_s,x_m,y_m,z_m,qx,qy,qz,qw\n0.0,1.0,2.0,3.0,0,0,0,1\n0.5,1.5,2.0,3.0,0,0,0.6,0.8\n";

/// Where the files are that the scenes name.
fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes")
}

fn parse_all(bytes: &[u8]) {
    let text = String::from_utf8_lossy(bytes);
    let _ = Scene::parse(&text, folder().join("t.toml")).map_err(|error| error.to_string());
    if let Ok(recorded) = Recorded::parse(&text, Path::new("t")) {
        let _ = [-1.0, 0.25, 1e9].map(|time_s| recorded.pose(time_s));
    }
}

/// The scenes of the project, and a recorded motion.
fn valid_files() -> Vec<Vec<u8>> {
    let files = std::fs::read_dir(folder()).expect("the project's scenes");
    let mut paths: Vec<PathBuf> = files.flatten().map(|file| file.path()).collect();
    paths.retain(|path| path.extension().is_some_and(|extension| extension == "toml"));
    paths.sort();
    assert!(paths.len() > 5, "{paths:?}");
    let scenes = paths.iter().map(|path| std::fs::read(path).expect("a scene"));
    scenes.chain([POSES.as_bytes().to_vec()]).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(128))]

    #[test]
    fn no_bytes_panic(bytes in proptest::collection::vec(any::<u8>(), 0..400)) {
        parse_all(&bytes);
    }

    #[test]
    fn no_damaged_file_panics(
        file in proptest::sample::select(valid_files()),
        damages in proptest::collection::vec((0..4_u8, any::<usize>(), any::<u8>()), 1..4),
    ) {
        parse_all(&damages.into_iter().fold(file, |bytes, (kind, at, value)| damage(bytes, kind, at, value)));
    }
}

#[test]
fn the_files_to_damage_are_valid() {
    let read = |bytes: &Vec<u8>| {
        let text = String::from_utf8_lossy(bytes);
        Scene::parse(&text, folder().join("t.toml")).is_ok() != Recorded::parse(&text, Path::new("t")).is_ok()
    };
    assert!(valid_files().iter().all(read));
}
