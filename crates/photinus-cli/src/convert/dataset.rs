//! Frames to a dataset folder, with copies of the files that belong to it. A dataset keeps its own unless others are
//! named, its frame numbers, and its truth.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use photinus_io::airframe::read_airframe;
use photinus_io::dataset::{
    AirframeFiles, Dataset, DatasetCamera, DatasetInfo, DatasetWriter, GravityLog, IMU_FILE, ODOMETRY_FILE,
    TruthFrame, Vehicle, VehicleInfo, vehicles_text,
};
use photinus_io::mask::read_mask;
use photinus_io::spot_curve::read_spot_curve;
use photinus_io::whole::WholeFolder;
use photinus_io::{Error, Result, read_camera};

use super::frames::FrameArgs;
use crate::failure::Failure;
use crate::targets::FolderTarget;
use photinus_run::Entry;

/// A dataset folder that frames are written to.
pub(super) struct DatasetSink {
    making: WholeFolder,
    writer: DatasetWriter,
    rate_hz: f64,
    truth: HashMap<u64, TruthFrame>,
    gravity: Option<GravityLog>,
    /// Frames at whose times the log of gravity says nothing.
    pub(super) without_gravity: u64,
}

/// The files of a dataset, wherever they lie.
struct Parts {
    camera: PathBuf,
    airframe: AirframeFiles,
    spot_curve: Option<PathBuf>,
    mask: Option<PathBuf>,
}

impl DatasetSink {
    /// Starts a dataset in `out`; what the command line does not say is taken from the dataset that is converted.
    pub(super) fn create(
        out: &FolderTarget,
        args: &FrameArgs,
        rate_hz: Option<f64>,
        source: Option<(&Dataset, &DatasetCamera)>,
    ) -> std::result::Result<Self, Failure> {
        let needed =
            |what: &str| Failure::Input(format!("a dataset needs --{what}; see photinus convert --help"));
        let of_source = |named: fn(&DatasetCamera) -> Option<&PathBuf>| {
            source.and_then(|(dataset, camera)| Some(dataset.path(named(camera)?)))
        };
        let of_dataset =
            || source.map(|(dataset, _)| dataset.info().airframe.map(|named| dataset.path(named)));
        let camera = args.camera.clone().or_else(|| of_source(|camera| Some(&camera.camera)));
        let airframe = args.airframe.clone().map(AirframeFiles::from).or_else(of_dataset);
        let exposure_us = args.exposure_us.or(source.map(|(_, camera)| camera.exposure_us));
        let parts = Parts {
            camera: camera.ok_or_else(|| needed("camera"))?,
            airframe: airframe.ok_or_else(|| needed("airframe"))?,
            spot_curve: of_source(|camera| camera.spot_curve.as_ref()),
            mask: of_source(|camera| camera.mask.as_ref()),
        };
        let exposure_us = exposure_us.ok_or_else(|| needed("exposure-us"))?;
        let rate_hz = rate_hz.ok_or_else(|| needed("rate"))?;

        parts.check().map_err(Failure::input)?;
        let gravity = args.gravity.as_ref().map(GravityLog::read).transpose().map_err(Failure::input)?;
        let truth = source.map_or(Ok(None), |(dataset, _)| dataset.truth());
        let truth = truth.map_err(Failure::input)?.unwrap_or_default();
        let name = source.and_then(|(_, camera)| camera.name.clone());
        let truth = truth.into_iter().filter(|truth| truth.camera == name);
        let kept = Kept::of(source).map_err(Failure::input)?;
        let info = DatasetInfo {
            codes: kept.codes(),
            vehicles: kept.vehicles(),
            sky: source.and_then(|(dataset, _)| dataset.info().sky.clone()),
            ..parts.info(exposure_us, rate_hz)
        };
        let making = out.whole().map_err(Failure::input)?;
        let writer = DatasetWriter::create(making.path(), &info)
            .map_err(|error| Failure::input(making.tell(error)))?;
        parts
            .copy(&info, making.path())
            .and_then(|()| kept.write(making.path()))
            .map_err(|error| Failure::running(making.tell(error)))?;
        let truth = truth.map(|truth| (truth.frame, TruthFrame { camera: None, ..truth })).collect();
        Ok(Self { making, writer, rate_hz, truth, gravity, without_gravity: 0 })
    }

    /// Writes a frame, with its number, its time and its truth.
    pub(super) fn write(&mut self, entry: &Entry) -> Result<()> {
        let Some(image) = &entry.image else { return Ok(()) };
        let number = entry.record.frame.unwrap_or_default();
        let time_s = entry.record.time_s.unwrap_or(number as f64 / self.rate_hz);
        let gravity = match &self.gravity {
            Some(log) => log.at(time_s),
            None => entry.gravity,
        };
        self.without_gravity += u64::from(self.gravity.is_some() && gravity.is_none());
        let written = self.writer.numbered_frame(number, &image.view(), time_s, gravity);
        let truth = self.truth.get(&number);
        let written = written.and_then(|()| truth.map_or(Ok(()), |truth| self.writer.truth(truth)));
        written.map_err(|error| self.making.tell(error))
    }

    /// The folder is whole.
    pub(super) fn keep(self) -> Result<()> {
        drop(self.writer);
        self.making.keep()
    }
}

/// What a dataset says beside its frames: who there may be, and what the vehicle that carries the camera measured.
struct Kept(Vec<(PathBuf, Vec<u8>)>);

const CODES_FILE: &str = "codes.txt";
const VEHICLES_FILE: &str = "vehicles.toml";

impl Kept {
    /// Of a dataset, under names of its own. What the gyro of a rig measured is in the body frame, where the one camera that
    /// is kept has no mounting: it is left out.
    fn of(source: Option<(&Dataset, &DatasetCamera)>) -> Result<Self> {
        let mut files = Vec::new();
        let Some((dataset, camera)) = source else { return Ok(Self(files)) };
        let read = |named: &Path| {
            let path = dataset.path(named);
            std::fs::read(&path).map_err(|error| Error::io(path, error))
        };
        if let Some(codes) = &dataset.info().codes {
            files.push((CODES_FILE.into(), read(codes)?));
        }
        if !dataset.vehicles().is_empty() {
            let vehicle = |vehicle: &Vehicle| {
                let end =
                    vehicle.airframe_file.extension().unwrap_or_default().to_string_lossy().into_owned();
                let airframe = PathBuf::from(format!("airframe-of-{}.{end}", vehicle.id));
                let blink = vehicle.blink.as_ref();
                let info = VehicleInfo {
                    id: vehicle.id,
                    airframe: airframe.clone(),
                    words: blink.map_or_else(Vec::new, |blink| blink.words.clone()),
                    bit_rate_hz: blink.map(|blink| blink.bit_rate_hz),
                };
                Ok((info, (airframe, read(&vehicle.airframe_file)?)))
            };
            let told: Vec<_> = dataset.vehicles().iter().map(vehicle).collect::<Result<_>>()?;
            let (vehicles, airframes): (Vec<_>, Vec<_>) = told.into_iter().unzip();
            files.push((VEHICLES_FILE.into(), vehicles_text(&vehicles).into_bytes()));
            files.extend(airframes);
        }
        let measured = [IMU_FILE, ODOMETRY_FILE].map(Path::new);
        for name in measured.into_iter().filter(|name| camera.name.is_none() && dataset.path(name).is_file())
        {
            files.push((name.to_owned(), read(name)?));
        }
        Ok(Self(files))
    }

    fn named(&self, name: &str) -> Option<PathBuf> {
        self.0.iter().map(|(file, _)| file).find(|file| *file == Path::new(name)).cloned()
    }

    fn codes(&self) -> Option<PathBuf> {
        self.named(CODES_FILE)
    }

    fn vehicles(&self) -> Option<PathBuf> {
        self.named(VEHICLES_FILE)
    }

    fn write(&self, out: &Path) -> Result<()> {
        self.0.iter().try_for_each(|(name, bytes)| {
            let path = out.join(name);
            std::fs::write(&path, bytes).map_err(|error| Error::io(path, error))
        })
    }
}

impl Parts {
    /// Only files that can be read make a dataset that can be.
    fn check(&self) -> Result<()> {
        let camera = read_camera(&self.camera)?.camera;
        self.airframe.iter().try_for_each(|file| read_airframe(file).map(drop))?;
        self.spot_curve.as_ref().map(read_spot_curve).transpose()?;
        let mask = self.mask.as_ref().map(read_mask).transpose()?;
        mask.map_or(Ok(()), |mask| mask.check_size(camera.width(), camera.height()))
    }

    fn info(&self, exposure_us: f64, rate_hz: f64) -> DatasetInfo {
        let inside = |path: &PathBuf, name: &str| {
            let extension = path.extension().map_or(String::new(), |e| format!(".{}", e.to_string_lossy()));
            PathBuf::from(format!("{name}{extension}"))
        };
        let mut kinds = 0;
        let airframe = |path: &PathBuf| {
            kinds += 1;
            inside(path, &if kinds == 1 { "airframe".to_owned() } else { format!("airframe-{kinds}") })
        };
        DatasetInfo {
            camera: inside(&self.camera, "camera"),
            airframe: self.airframe.map(airframe),
            exposure_us,
            rate_hz,
            spot_curve: self.spot_curve.as_ref().map(|path| inside(path, "spot_curve")),
            mask: self.mask.as_ref().map(|path| inside(path, "mask")),
            codes: None,
            vehicles: None,
            sky: None,
        }
    }

    fn copy(&self, info: &DatasetInfo, out: &Path) -> Result<()> {
        let files = [
            (Some(&self.camera), Some(&info.camera)),
            (self.spot_curve.as_ref(), info.spot_curve.as_ref()),
            (self.mask.as_ref(), info.mask.as_ref()),
        ];
        let files = files.into_iter().filter_map(|(from, to)| from.zip(to));
        for (from, to) in files.chain(self.airframe.iter().zip(info.airframe.iter())) {
            let to = out.join(to);
            std::fs::copy(from, &to).map_err(|error| Error::io(to, error))?;
        }
        Ok(())
    }
}
