//! A dataset folder of a simulation: what a recording holds, with truth.

use std::path::Path;

use photinus_io::airframe::toml_text;
use photinus_io::camera::write_camera_toml;
use photinus_io::dataset::{DatasetInfo, DatasetWriter};
use photinus_io::{Error, Result};

use crate::render::Rendered;
use crate::scene::Scene;

const CAMERA_FILE: &str = "camera.toml";
const AIRFRAME_FILE: &str = "airframe.toml";

/// Starts the dataset of one camera of a scene in `folder`: its camera, and the airframe of the first target.
///
/// # Errors
/// [`Error`] when the folder holds a dataset already or cannot be written, or the scene has no such camera or no target.
pub fn create(folder: impl AsRef<Path>, scene: &Scene, camera: usize) -> Result<DatasetWriter> {
    let folder = folder.as_ref();
    let (Some(mounted), Some(target)) = (scene.cameras.get(camera), scene.targets.first()) else {
        return Err(Error::format(folder, "a dataset needs a camera and a target"));
    };
    let info = DatasetInfo {
        camera: CAMERA_FILE.into(),
        airframe: AIRFRAME_FILE.into(),
        exposure_us: scene.exposure_us,
        rate_hz: scene.rate_hz,
        spot_curve: None,
        mask: None,
        codes: None,
        vehicles: None,
    };
    let writer = DatasetWriter::create(folder, &info)?;
    let mut text = Vec::new();
    write_camera_toml(&mounted.camera, &mut text, &folder.join(CAMERA_FILE))?;
    let write = |name: &str, text: &[u8]| {
        let path = folder.join(name);
        std::fs::write(&path, text).map_err(|error| Error::io(&path, error))
    };
    write(CAMERA_FILE, &text)?;
    write(AIRFRAME_FILE, toml_text(&target.airframe).as_bytes())?;
    Ok(writer)
}

/// Adds a frame with its truth.
///
/// # Errors
/// As [`DatasetWriter::frame`] and [`DatasetWriter::truth`].
pub fn add(writer: &mut DatasetWriter, rendered: &Rendered) -> Result<()> {
    writer.frame(&rendered.image.view(), rendered.truth.time_s, Some(rendered.gravity))?;
    writer.truth(&rendered.truth)
}

#[cfg(test)]
mod tests {
    use photinus_io::dataset::Dataset;
    use photinus_io::image::read_image;
    use photinus_io::{airframe::read_airframe, read_camera};

    use super::*;
    use crate::Simulator;

    #[test]
    fn what_is_written_is_read_back() {
        let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/crossing.toml"));
        let scene = Scene::read(path).unwrap();
        let folder = std::env::temp_dir().join(format!("photinus-sim-{}-dataset", std::process::id()));
        let mut writer = create(&folder, &scene, 0).unwrap();
        let mut simulator = Simulator::new(&scene, 0).unwrap();
        let rendered = [simulator.frame(0), simulator.frame(1)];
        rendered.iter().for_each(|rendered| add(&mut writer, rendered).unwrap());
        let dataset = Dataset::read(&folder).unwrap();
        assert_eq!(
            dataset.truth().unwrap().unwrap(),
            rendered.each_ref().map(|rendered| rendered.truth.clone())
        );
        let row = &dataset.frames()[1];
        assert_eq!(read_image(dataset.path(&row.image)).unwrap().image, rendered[1].image);
        assert!((row.gravity.unwrap().into_inner() - rendered[1].gravity.into_inner()).norm() < 1e-12);
        assert_eq!(
            read_camera(&dataset.path(&dataset.info().camera)).unwrap().camera,
            scene.cameras[0].camera
        );
        let airframe = read_airframe(dataset.path(&dataset.info().airframe)).unwrap().airframe;
        assert_eq!(airframe, scene.targets[0].airframe);
        assert!(create(&folder, &scene, 0).is_err(), "a dataset is not written over");
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
