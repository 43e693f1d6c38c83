//! A dataset folder of a simulation: what a recording holds, with truth.
//!
//! A scene with one camera gives a dataset with one `camera`, one with several a dataset with `[[camera]]`. What goes wrong with a
//! recording ([`crate::recording`]) and what the observer measures ([`crate::instruments`]) is written here.

use std::path::{Path, PathBuf};

use nalgebra::{Isometry3, Matrix3};
use photinus_io::airframe::{Tolerances, toml_text};
use photinus_io::calibration::{MountingFile, mounting_text};
use photinus_io::camera::write_camera_toml;
use photinus_io::codes::codes_text;
use photinus_io::dataset::{
    DatasetInfo, DatasetWriter, ImuRow, RigCamera, RigInfo, VehicleInfo, vehicles_text,
};
use photinus_io::{Error, Result};

use crate::recording::Taken;
use crate::render::Rendered;
use crate::scene::{MountedCamera, Scene, Target};

const CAMERA_FILE: &str = "camera.toml";
const MOUNTING_FILE: &str = "mounting.toml";
const AIRFRAME_FILE: &str = "airframe.toml";
const CODES_FILE: &str = "codes.txt";
const VEHICLES_FILE: &str = "vehicles.toml";

/// A dataset that frames of a scene are written to.
#[derive(Debug)]
pub struct SceneDataset<'a> {
    scene: &'a Scene,
    /// The cameras that are recorded, as the scene counts them.
    cameras: Vec<usize>,
    frames: u64,
    writer: DatasetWriter,
}

impl<'a> SceneDataset<'a> {
    /// Starts a dataset in `folder` for `frames` frames of each of these cameras of a scene: their files, the airframes and code
    /// words of the targets, and what the observer's instruments measure until the last frame.
    ///
    /// # Errors
    /// [`Error`] when the folder holds a dataset already or cannot be written, the scene has no such camera or no target, or its
    /// targets blink words of different books.
    pub fn create(
        folder: impl AsRef<Path>,
        scene: &'a Scene,
        cameras: &[usize],
        frames: u64,
    ) -> Result<Self> {
        let folder = folder.as_ref();
        let mounted: Option<Vec<&MountedCamera>> =
            cameras.iter().map(|camera| scene.cameras.get(*camera)).collect();
        let mounted = mounted.filter(|mounted| !mounted.is_empty() && !scene.targets.is_empty());
        let mounted =
            mounted.ok_or_else(|| Error::format(folder, "a dataset needs a camera and a target"))?;
        let named = NamedTargets::new(folder, &scene.targets)?;
        let mut writer = match mounted.as_slice() {
            [only] => one_camera(folder, scene, only, &named)?,
            several => rig(folder, scene, several, &named)?,
        };
        named.write(folder)?;
        // one camera has no mounting beside it: its gyro speaks of the camera itself
        let body_from_part = match mounted.as_slice() {
            [only] => only.body_from_camera,
            _ => Isometry3::identity(),
        };
        measure(&mut writer, scene, &body_from_part, frames)?;
        Ok(Self { scene, cameras: cameras.to_vec(), frames, writer })
    }

    /// Adds a frame with its truth; `camera` is its number in the scene. A frame that the recording loses is not written.
    ///
    /// # Errors
    /// As [`DatasetWriter::row`] and [`DatasetWriter::truth`].
    pub fn add(&mut self, camera: usize, rendered: &Rendered) -> Result<()> {
        let Some(place) = self.cameras.iter().position(|recorded| *recorded == camera) else { return Ok(()) };
        let Some(Taken { mut truth, gravity, shown }) = self.scene.take(camera, self.frames, rendered) else {
            return Ok(());
        };
        let number = truth.frame;
        self.writer.image(place, number, &rendered.image.view())?;
        self.writer.row(place, number, truth.time_s, Some(gravity), shown)?;
        truth.camera = (self.cameras.len() > 1).then(|| self.scene.cameras[camera].name.clone());
        self.writer.truth(&truth)
    }
}

/// The targets with the names of their files.
struct NamedTargets<'a> {
    targets: &'a [Target],
    /// Of every target, the file of its airframe: equal ones share a file.
    airframes: Vec<PathBuf>,
    /// The target whose book of words is written.
    book: Option<&'a Target>,
}

impl<'a> NamedTargets<'a> {
    fn new(folder: &Path, targets: &'a [Target]) -> Result<Self> {
        let mut airframes: Vec<PathBuf> = Vec::new();
        let mut files = 0;
        for (index, target) in targets.iter().enumerate() {
            let same = targets[..index].iter().position(|other| other.airframe == target.airframe);
            let file = same.map(|same| airframes[same].clone()).unwrap_or_else(|| {
                files += 1;
                if files == 1 { AIRFRAME_FILE.into() } else { format!("airframe-{files}.toml").into() }
            });
            airframes.push(file);
        }
        let mut books = targets.iter().filter_map(|target| Some((target, &target.blink.as_ref()?.codes)));
        let first = books.next();
        if books.any(|(_, codes)| first.is_some_and(|(_, book)| book != codes)) {
            return Err(Error::format(folder, "the targets blink words of different books")
                .advise("a dataset holds one: name the same codes for every target of the scene"));
        }
        Ok(Self { targets, airframes, book: first.map(|(target, _)| target) })
    }

    /// Who there is needs saying where targets differ in what can be seen of them.
    fn vehicles_file(&self) -> Option<PathBuf> {
        let differ = self.airframes.iter().any(|file| *file != self.airframes[0]);
        (differ || self.book.is_some()).then(|| VEHICLES_FILE.into())
    }

    fn codes_file(&self) -> Option<PathBuf> {
        self.book.is_some().then(|| CODES_FILE.into())
    }

    fn write(&self, folder: &Path) -> Result<()> {
        for (target, file) in self.targets.iter().zip(&self.airframes) {
            write(folder, file, toml_text(&target.airframe, &Tolerances::default()).as_bytes())?;
        }
        if let Some(blink) = self.book.and_then(|target| target.blink.as_ref()) {
            write(folder, CODES_FILE, codes_text(&blink.codes).as_bytes())?;
        }
        if self.vehicles_file().is_none() {
            return Ok(());
        }
        let vehicle = |(target, airframe): (&Target, &PathBuf)| VehicleInfo {
            id: target.id,
            airframe: airframe.clone(),
            words: target.blink.as_ref().map_or_else(Vec::new, |blink| blink.words.clone()),
            bit_rate_hz: target.blink.as_ref().map(|blink| blink.rate_hz),
        };
        let vehicles: Vec<VehicleInfo> = self.targets.iter().zip(&self.airframes).map(vehicle).collect();
        write(folder, VEHICLES_FILE, vehicles_text(&vehicles).as_bytes())
    }
}

fn one_camera(
    folder: &Path,
    scene: &Scene,
    mounted: &MountedCamera,
    named: &NamedTargets<'_>,
) -> Result<DatasetWriter> {
    let info = DatasetInfo {
        camera: CAMERA_FILE.into(),
        airframe: AIRFRAME_FILE.into(),
        exposure_us: mounted.exposure_us.unwrap_or(scene.exposure_us),
        rate_hz: scene.rate_hz,
        spot_curve: None,
        mask: None,
        codes: named.codes_file(),
        vehicles: named.vehicles_file(),
        sky: scene.sky.clone(),
    };
    let writer = DatasetWriter::create(folder, &info)?;
    write_camera(folder, Path::new(CAMERA_FILE), mounted)?;
    Ok(writer)
}

fn rig(
    folder: &Path,
    scene: &Scene,
    mounted: &[&MountedCamera],
    named: &NamedTargets<'_>,
) -> Result<DatasetWriter> {
    let camera = |mounted: &&MountedCamera| RigCamera {
        name: mounted.name.clone(),
        camera: Path::new(&mounted.name).join(CAMERA_FILE),
        mounting: Path::new(&mounted.name).join(MOUNTING_FILE),
        frames: Path::new(&mounted.name).join("frames.csv"),
        mask: None,
        spot_curve: None,
        exposure_us: mounted.exposure_us,
    };
    let info = RigInfo {
        airframe: AIRFRAME_FILE.into(),
        exposure_us: scene.exposure_us,
        rate_hz: scene.rate_hz,
        codes: named.codes_file(),
        vehicles: named.vehicles_file(),
        sky: scene.sky.clone(),
        cameras: mounted.iter().map(camera).collect(),
    };
    let writer = DatasetWriter::create_rig(folder, &info)?;
    for (camera, mounted) in info.cameras.iter().zip(mounted) {
        write_camera(folder, &camera.camera, mounted)?;
        // a simulated mounting is known exactly
        let mounting = MountingFile {
            body_from_camera: mounted.body_from_camera.rotation,
            rotation_covariance_rad2: Matrix3::zeros(),
            position_m: Some(mounted.body_from_camera.translation.vector),
            position_covariance_m2: Some(Matrix3::zeros()),
        };
        write(folder, &camera.mounting, mounting_text(&mounting).as_bytes())?;
    }
    Ok(writer)
}

/// Writes what the instruments measure until the last frame, the gyro about the axes of a part of the body.
fn measure(
    writer: &mut DatasetWriter,
    scene: &Scene,
    body_from_part: &Isometry3<f64>,
    frames: u64,
) -> Result<()> {
    let end_s =
        |mounted: &MountedCamera| mounted.clock.time_s(mounted.phase_s + frames as f64 / scene.rate_hz);
    let until_s = scene.cameras.iter().map(end_s).fold(0.0, f64::max);
    if let Some(gyro) = &scene.instruments.gyro {
        for row in gyro.measure(&scene.observer, until_s, scene.seed) {
            let turn_rad_s = body_from_part.rotation.inverse() * row.turn_rad_s;
            writer.imu(&ImuRow { turn_rad_s, ..row })?;
        }
    }
    if let Some(odometry) = &scene.instruments.odometry {
        for row in odometry.measure(&scene.observer, until_s, scene.seed) {
            writer.odometry(&row)?;
        }
    }
    Ok(())
}

fn write_camera(folder: &Path, file: &Path, mounted: &MountedCamera) -> Result<()> {
    let mut text = Vec::new();
    write_camera_toml(&mounted.camera, &mut text, &folder.join(file))?;
    write(folder, file, &text)
}

fn write(folder: &Path, file: impl AsRef<Path>, text: &[u8]) -> Result<()> {
    let path = folder.join(file);
    std::fs::write(&path, text).map_err(|error| Error::io(&path, error))
}
