//! The flights that the program carries along, with the files they name: links to those in `scenes/`, so that they are packed with the crate.

use std::path::Path;

use photinus_io::{Error, Result};
use photinus_sim::Scene;

/// A scene, and what it names.
pub(crate) struct Carried {
    /// The scene's own file.
    pub(crate) scene: &'static str,
    /// The name and text of each, the scene's among them.
    files: &'static [(&'static str, &'static str)],
}

const CAMERA: (&str, &str) =
    ("cameras/bluefox-dsl215.toml", include_str!("scene/cameras/bluefox-dsl215.toml"));
const AIRFRAME: (&str, &str) =
    ("airframes/hexarotor-0.4.toml", include_str!("scene/airframes/hexarotor-0.4.toml"));

/// Four that blink and fly across each other's way: what a newcomer sees first.
pub(super) const FOUR_OUTDOORS: Carried = Carried {
    scene: "four-outdoors.toml",
    files: &[
        ("four-outdoors.toml", include_str!("scene/four-outdoors.toml")),
        CAMERA,
        AIRFRAME,
        ("codes/l14-d3-r3.txt", include_str!("scene/codes/l14-d3-r3.txt")),
    ],
};

/// The paper's outdoor flight (V. Walter, M. Saska, A. Franchi, ICUAS 2018, figures 15 and 16).
pub(crate) const OUTDOOR_FLIGHT: Carried = Carried {
    scene: "outdoor-flight.toml",
    files: &[("outdoor-flight.toml", include_str!("scene/outdoor-flight.toml")), CAMERA, AIRFRAME],
};

impl Carried {
    /// Writes the scene and its files into `folder`, where a newcomer can look at them and change them, and reads them.
    ///
    /// # Errors
    /// [`Error`] when the folder cannot be made or written to.
    pub(crate) fn unpack(&self, folder: &Path) -> Result<Scene> {
        for (name, text) in self.files {
            let path = folder.join(name);
            let written = path.parent().map_or(Ok(()), std::fs::create_dir_all);
            written.and_then(|()| std::fs::write(&path, text)).map_err(|error| {
                Error::io(&path, error).advise("name a folder that can be made and written to")
            })?;
        }
        Scene::read(folder.join(self.scene))
    }
}
