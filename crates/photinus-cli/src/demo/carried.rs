//! The flight that the program carries along: the paper's outdoor flight (V. Walter, M. Saska, A. Franchi, ICUAS 2018,
//! figures 15 and 16).

use std::path::Path;

use photinus_io::{Error, Result};
use photinus_sim::Scene;

const SCENE: &str = "outdoor-flight.toml";

/// The scene and the files it names: links to those in `scenes/`, so that they are packed with the crate.
const FILES: [(&str, &str); 3] = [
    (SCENE, include_str!("scene/outdoor-flight.toml")),
    ("cameras/bluefox-dsl215.toml", include_str!("scene/cameras/bluefox-dsl215.toml")),
    ("airframes/hexarotor-0.4.toml", include_str!("scene/airframes/hexarotor-0.4.toml")),
];

/// Writes the scene and its files into `folder`, where a newcomer can look at them and change them, and reads them.
///
/// # Errors
/// [`Error`] when the folder cannot be made or written to.
pub(crate) fn unpack(folder: &Path) -> Result<Scene> {
    for (name, text) in FILES {
        let path = folder.join(name);
        let written = path.parent().map_or(Ok(()), std::fs::create_dir_all);
        written.and_then(|()| std::fs::write(&path, text)).map_err(|error| {
            Error::io(&path, error).advise("name a folder that can be made and written to")
        })?;
    }
    Scene::read(folder.join(SCENE))
}
