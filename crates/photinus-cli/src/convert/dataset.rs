//! Frames to a dataset folder, with copies of the files that belong to it. A dataset keeps its own unless others are
//! named, its frame numbers, and its truth.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use photinus_io::airframe::read_airframe;
use photinus_io::dataset::{Dataset, DatasetInfo, DatasetWriter, TruthFrame};
use photinus_io::mask::read_mask;
use photinus_io::spot_curve::read_spot_curve;
use photinus_io::{Error, Result, read_camera};

use super::frames::FrameArgs;
use crate::failure::Failure;
use crate::input::Entry;

/// A dataset folder that frames are written to.
pub(super) struct DatasetSink {
    writer: DatasetWriter,
    rate_hz: f64,
    truth: HashMap<u64, TruthFrame>,
}

/// The files of a dataset, wherever they lie.
struct Parts {
    camera: PathBuf,
    airframe: PathBuf,
    spot_curve: Option<PathBuf>,
    mask: Option<PathBuf>,
}

impl DatasetSink {
    /// Starts a dataset in `out`; what the command line does not say is taken from the dataset that is converted.
    pub(super) fn create(
        out: &Path,
        args: &FrameArgs,
        rate_hz: Option<f64>,
        source: Option<&Dataset>,
    ) -> std::result::Result<Self, Failure> {
        let needed =
            |what: &str| Failure::Input(format!("a dataset needs --{what}; see photinus convert --help"));
        let of_source = |named: fn(&DatasetInfo) -> Option<&PathBuf>| {
            source.and_then(|dataset| Some(dataset.path(named(dataset.info())?)))
        };
        let camera = args.camera.clone().or_else(|| of_source(|info| Some(&info.camera)));
        let airframe = args.airframe.clone().or_else(|| of_source(|info| Some(&info.airframe)));
        let exposure_us = args.exposure_us.or(source.map(|dataset| dataset.info().exposure_us));
        let parts = Parts {
            camera: camera.ok_or_else(|| needed("camera"))?,
            airframe: airframe.ok_or_else(|| needed("airframe"))?,
            spot_curve: of_source(|info| info.spot_curve.as_ref()),
            mask: of_source(|info| info.mask.as_ref()),
        };
        let exposure_us = exposure_us.ok_or_else(|| needed("exposure-us"))?;
        let rate_hz = rate_hz.ok_or_else(|| needed("rate"))?;

        parts.check().map_err(Failure::input)?;
        let truth = source.map_or(Ok(None), Dataset::truth).map_err(Failure::input)?.unwrap_or_default();
        let info = parts.info(exposure_us, rate_hz);
        let writer = DatasetWriter::create(out, &info).map_err(Failure::input)?;
        parts.copy(&info, out).map_err(Failure::running)?;
        let truth = truth.into_iter().map(|truth| (truth.frame, truth)).collect();
        Ok(Self { writer, rate_hz, truth })
    }

    /// Writes a frame, with its number, its time and its truth.
    pub(super) fn write(&mut self, entry: &Entry) -> Result<()> {
        let Some(image) = &entry.image else { return Ok(()) };
        let number = entry.record.frame.unwrap_or_default();
        let time_s = entry.record.time_s.unwrap_or(number as f64 / self.rate_hz);
        self.writer.numbered_frame(number, &image.view(), time_s, entry.gravity)?;
        self.truth.get(&number).map_or(Ok(()), |truth| self.writer.truth(truth))
    }
}

impl Parts {
    /// Only files that can be read make a dataset that can be.
    fn check(&self) -> Result<()> {
        let camera = read_camera(&self.camera)?.camera;
        read_airframe(&self.airframe)?;
        self.spot_curve.as_ref().map(read_spot_curve).transpose()?;
        let mask = self.mask.as_ref().map(read_mask).transpose()?;
        mask.map_or(Ok(()), |mask| mask.check_size(camera.width(), camera.height()))
    }

    fn info(&self, exposure_us: f64, rate_hz: f64) -> DatasetInfo {
        let inside = |path: &PathBuf, name: &str| {
            let extension = path.extension().map_or(String::new(), |e| format!(".{}", e.to_string_lossy()));
            PathBuf::from(format!("{name}{extension}"))
        };
        DatasetInfo {
            camera: inside(&self.camera, "camera"),
            airframe: inside(&self.airframe, "airframe"),
            exposure_us,
            rate_hz,
            spot_curve: self.spot_curve.as_ref().map(|path| inside(path, "spot_curve")),
            mask: self.mask.as_ref().map(|path| inside(path, "mask")),
            codes: None,
            vehicles: None,
        }
    }

    fn copy(&self, info: &DatasetInfo, out: &Path) -> Result<()> {
        let files = [
            (Some(&self.camera), Some(&info.camera)),
            (Some(&self.airframe), Some(&info.airframe)),
            (self.spot_curve.as_ref(), info.spot_curve.as_ref()),
            (self.mask.as_ref(), info.mask.as_ref()),
        ];
        for (from, to) in files.into_iter().filter_map(|(from, to)| from.zip(to)) {
            let to = out.join(to);
            std::fs::copy(from, &to).map_err(|error| Error::io(to, error))?;
        }
        Ok(())
    }
}
