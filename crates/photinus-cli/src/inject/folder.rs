//! The folder of the new dataset: which files the old one names, as they are or as they are told; all are read before any is
//! written.

use std::path::{Component, Path, PathBuf};

use photinus_io::airframe::{AirframeFile, read_airframe, toml_text};
use photinus_io::camera::write_camera_toml;
use photinus_io::dataset::{
    DATASET_FILE, Dataset, DatasetInfo, DatasetToml, DatasetWriter, IMU_FILE, ODOMETRY_FILE, RigCamera,
    RigInfo, parse_vehicles, vehicles_text,
};
use photinus_io::{Error, Result, read_camera};
use photinus_sim::faults::{Fault, Faults};

/// Starts the new dataset in `out` with all but its frames.
pub(super) fn start(dataset: &Dataset, faults: &Faults, out: &Path) -> Result<DatasetWriter> {
    let mut files = Files { dataset, faults, contents: Vec::new() };
    let path = dataset.path(DATASET_FILE);
    let told = DatasetToml::parse(&files.text(Path::new(DATASET_FILE))?, &path)?;
    for name in [IMU_FILE, ODOMETRY_FILE] {
        if dataset.path(name).is_file() {
            files.copy(Path::new(name))?;
        }
    }
    let writer = match told {
        DatasetToml::One(info) => DatasetWriter::create(out, &files.one(info)?)?,
        DatasetToml::Rig(info) => DatasetWriter::create_rig(out, &files.rig(info)?)?,
    };
    for (name, content) in files.contents {
        let path = out.join(name);
        let folder = path.parent().unwrap_or(out);
        let written = std::fs::create_dir_all(folder).and_then(|()| std::fs::write(&path, content));
        written.map_err(|error| Error::io(path, error))?;
    }
    Ok(writer)
}

/// Files of the new dataset, by the names that they have in it.
struct Files<'a> {
    dataset: &'a Dataset,
    faults: &'a Faults,
    contents: Vec<(PathBuf, Vec<u8>)>,
}

impl Files<'_> {
    fn one(&mut self, info: DatasetInfo) -> Result<DatasetInfo> {
        Ok(DatasetInfo {
            camera: self.camera(&info.camera)?,
            airframe: info.airframe.try_map(|named| self.airframe(named))?,
            spot_curve: self.copied(info.spot_curve)?,
            mask: self.copied(info.mask)?,
            codes: self.copied(info.codes)?,
            vehicles: info.vehicles.map(|named| self.vehicles(&named)).transpose()?,
            ..info
        })
    }

    fn rig(&mut self, info: RigInfo) -> Result<RigInfo> {
        let camera = |camera: RigCamera| {
            self.copy(&camera.mounting)?;
            self.is_inside(&camera.frames)?;
            Ok(RigCamera {
                camera: self.camera(&camera.camera)?,
                mask: self.copied(camera.mask)?,
                spot_curve: self.copied(camera.spot_curve)?,
                ..camera
            })
        };
        let cameras = info.cameras.into_iter().map(camera).collect::<Result<_>>()?;
        Ok(RigInfo {
            airframe: info.airframe.try_map(|named| self.airframe(named))?,
            codes: self.copied(info.codes)?,
            vehicles: info.vehicles.map(|named| self.vehicles(&named)).transpose()?,
            cameras,
            ..info
        })
    }

    /// The name of a camera's file as it is told.
    fn camera(&mut self, named: &Path) -> Result<PathBuf> {
        if !self.faults.list.iter().any(|fault| matches!(fault, Fault::Focal(_))) {
            return self.copy(named);
        }
        let path = self.dataset.path(named);
        let camera = read_camera(&path)?.camera;
        let camera = self.faults.camera(&camera).map_err(|error| Error::format(&path, error.to_string()))?;
        let mut text = Vec::new();
        write_camera_toml(&camera, &mut text, &path)?;
        self.tell(named, text)
    }

    /// The name of an airframe's file as it is told.
    fn airframe(&mut self, named: &Path) -> Result<PathBuf> {
        if !self.faults.list.iter().any(|fault| matches!(fault, Fault::Airframe(_))) {
            return self.copy(named);
        }
        let path = self.dataset.path(named);
        let AirframeFile { airframe, tolerances, .. } = read_airframe(&path)?;
        let airframe =
            self.faults.airframe(&airframe).map_err(|error| Error::format(&path, error.to_string()))?;
        self.tell(named, toml_text(&airframe, &tolerances).into_bytes())
    }

    /// The list of vehicles, each with its airframe as it is told.
    fn vehicles(&mut self, named: &Path) -> Result<PathBuf> {
        let mut vehicles = parse_vehicles(&self.text(named)?, self.dataset.path(named))?;
        for vehicle in &mut vehicles {
            vehicle.airframe = self.airframe(&vehicle.airframe)?;
        }
        self.is_inside(named)?;
        self.contents.push((named.to_owned(), vehicles_text(&vehicles).into_bytes()));
        Ok(named.to_owned())
    }

    fn copied(&mut self, named: Option<PathBuf>) -> Result<Option<PathBuf>> {
        named.map(|named| self.copy(&named)).transpose()
    }

    /// A file as it is, under its own name.
    fn copy(&mut self, named: &Path) -> Result<PathBuf> {
        self.is_inside(named)?;
        let path = self.dataset.path(named);
        let content = std::fs::read(&path).map_err(|error| Error::io(&path, error))?;
        self.contents.push((named.to_owned(), content));
        Ok(named.to_owned())
    }

    /// A file that says something else than the one of that name did.
    fn tell(&mut self, named: &Path, content: Vec<u8>) -> Result<PathBuf> {
        self.is_inside(named)?;
        let stem = named.file_stem().unwrap_or_default().to_string_lossy();
        let name = named.with_file_name(format!("told-{stem}.toml"));
        self.contents.push((name.clone(), content));
        Ok(name)
    }

    fn text(&self, named: &Path) -> Result<String> {
        let path = self.dataset.path(named);
        std::fs::read_to_string(&path).map_err(|error| Error::io(&path, error))
    }

    /// A file of another folder has no place in the new one.
    fn is_inside(&self, named: &Path) -> Result<()> {
        match named.components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir)) {
            true => Ok(()),
            false => {
                Err(Error::format(self.dataset.path(named), "this file lies outside of the dataset's folder")
                    .advise("put all in one folder: photinus convert DATASET FOLDER"))
            }
        }
    }
}
