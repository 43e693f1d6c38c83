//! Frames from files: datasets, images, video.

use std::fs::File;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

use numpy::{PyArray1, PyArray2, PyArrayMethods};
use photinus_io::dataset::{self, DatasetCamera};
use photinus_io::frames::{self as sources, FrameSource};
use photinus_io::image::GreyImage;
use photinus_io::kind::{Kind, images_in};
use photinus_io::{Error, image};
use photinus_run::watch;
use pyo3::prelude::*;

use crate::airframe::Airframe;
use crate::camera::Camera;
use crate::error::{self, SettingError, detached};
use crate::record::Truth;

/// A frame with what is known of it.
#[pyclass(frozen, module = "photinus")]
pub(crate) struct Frame {
    image: Py<PyArray2<u8>>,
    frame: u64,
    time_s: Option<f64>,
    gravity: Option<[f64; 3]>,
    source: String,
    truth: Option<Truth>,
}

impl Frame {
    pub(crate) fn simulated(
        py: Python<'_>,
        image: GreyImage,
        gravity: [f64; 3],
        truth: photinus_io::dataset::TruthFrame,
    ) -> PyResult<Self> {
        Ok(Self {
            image: array(py, image)?,
            frame: truth.frame,
            time_s: Some(truth.time_s),
            gravity: Some(gravity),
            source: String::new(),
            truth: Some(Truth(Arc::new(truth))),
        })
    }

    fn read(py: Python<'_>, frame: sources::Frame) -> PyResult<Self> {
        let sources::Frame { image, index, time_s, source, gravity, .. } = frame;
        let gravity = gravity.map(|down| down.into_inner().into());
        Ok(Self { image: array(py, image)?, frame: index, time_s, gravity, source, truth: None })
    }
}

#[pymethods]
impl Frame {
    /// The pixels: uint8, (rows, columns).
    #[getter]
    fn image(&self, py: Python<'_>) -> Py<PyArray2<u8>> {
        self.image.clone_ref(py)
    }

    /// Its number.
    #[getter]
    fn frame(&self) -> u64 {
        self.frame
    }

    /// When it was taken, s, where that is known.
    #[getter]
    fn time_s(&self) -> Option<f64> {
        self.time_s
    }

    /// Direction of gravity (down) in the camera frame, where that is known: a unit vector x, y, z.
    #[getter]
    fn gravity(&self) -> Option<(f64, f64, f64)> {
        self.gravity.map(Into::into)
    }

    /// The image file or stream; empty for a simulated one.
    #[getter]
    fn source(&self) -> &str {
        &self.source
    }

    /// Where everything was, of a simulated frame.
    #[getter]
    fn truth(&self) -> Option<Truth> {
        self.truth.as_ref().map(|truth| Truth(truth.0.clone()))
    }

    fn __repr__(&self) -> String {
        let time = self.time_s.map_or(String::new(), |time_s| format!(" at {time_s:.6} s"));
        format!("Frame({}{time})", self.frame)
    }
}

/// Frames of a source, one after the other. One that cannot be read raises FileError; the next one follows.
#[pyclass(frozen, module = "photinus")]
pub(crate) struct Frames(Mutex<FrameSource>);

#[pymethods]
impl Frames {
    fn __iter__(this: PyRef<'_, Self>) -> PyRef<'_, Self> {
        this
    }

    fn __next__(&self, py: Python<'_>) -> PyResult<Option<Frame>> {
        let next = detached(py, || {
            self.0.lock().unwrap_or_else(PoisonError::into_inner).next().transpose().map_err(error::file)
        })?;
        next.map(|frame| Frame::read(py, frame)).transpose()
    }
}

/// A dataset folder: frames with times and gravity, the camera and airframe that belong to them, truth where it has one.
#[pyclass(frozen, module = "photinus")]
pub(crate) struct Dataset {
    pub(crate) dataset: dataset::Dataset,
    camera: usize,
}

impl Dataset {
    pub(crate) fn of_camera(&self) -> &DatasetCamera {
        &self.dataset.cameras()[self.camera]
    }
}

#[pymethods]
impl Dataset {
    /// Reads a dataset folder; `camera` names one of several. Raises FileError when a table of it is missing or not in order, or
    /// it names images outside of itself, SettingError when several cameras leave a choice.
    #[staticmethod]
    #[pyo3(signature = (folder, *, camera = None))]
    fn read(py: Python<'_>, folder: PathBuf, camera: Option<&str>) -> PyResult<Self> {
        let dataset = detached(py, || {
            let dataset = dataset::Dataset::read(&folder).map_err(error::file)?;
            dataset.check_inside().map_err(error::file)?;
            Ok(dataset)
        })?;
        let names: Vec<&str> = dataset.cameras().iter().filter_map(|camera| camera.name.as_deref()).collect();
        let found = match camera {
            Some(name) => names.iter().position(|other| *other == name),
            None => (dataset.cameras().len() == 1).then_some(0),
        };
        let refuse = || format!("{}: choose one of its cameras: {}", folder.display(), names.join(", "));
        let camera = found.ok_or_else(|| SettingError::new_err(refuse()))?;
        Ok(Self { dataset, camera })
    }

    /// The camera. Raises FileError.
    #[getter]
    fn camera(&self, py: Python<'_>) -> PyResult<Camera> {
        Camera::open(py, &self.dataset.path(&self.of_camera().camera))
    }

    /// The neighbours' airframe; of several kinds, the first. Raises FileError.
    #[getter]
    fn airframe(&self, py: Python<'_>) -> PyResult<Airframe> {
        Airframe::open(py, &self.dataset.path(&self.dataset.info().airframe.first))
    }

    /// The neighbours' airframes, one for each kind: those built alike are one. Raises FileError.
    #[getter]
    fn airframes(&self, py: Python<'_>) -> PyResult<Vec<Airframe>> {
        let read = |path: PathBuf| {
            let file = detached(py, || photinus_io::airframe::read_airframe(&path).map_err(error::file))?;
            error::warn(py, &path, &file.notes)?;
            Ok((path, file))
        };
        let files = self.dataset.airframes().into_iter().map(read).collect::<PyResult<_>>()?;
        Ok(watch::told_apart(files).map_err(error::file)?.into_iter().map(Airframe).collect())
    }

    /// The image that says where not to look, if there is one.
    #[getter]
    pub(crate) fn mask(&self) -> Option<PathBuf> {
        self.of_camera().mask.as_ref().map(|named| self.dataset.path(named))
    }

    /// The file that says how the camera sits on its vehicle, if there is one.
    #[getter]
    fn mounting(&self) -> Option<PathBuf> {
        self.of_camera().mounting_file.as_ref().map(|named| self.dataset.path(named))
    }

    /// The file of the spot curve, if there is one.
    #[getter]
    pub(crate) fn spot_curve(&self) -> Option<PathBuf> {
        self.of_camera().spot_curve.as_ref().map(|named| self.dataset.path(named))
    }

    /// Where everything was, frame by frame; None where the folder holds no truth.jsonl. Raises FileError.
    #[getter]
    fn truth(&self, py: Python<'_>) -> PyResult<Option<Vec<Truth>>> {
        let name = &self.of_camera().name;
        let truth = detached(py, || self.dataset.truth().map_err(error::file))?;
        let own = |truth: Vec<dataset::TruthFrame>| truth.into_iter().filter(|frame| frame.camera == *name);
        Ok(truth.map(|truth| own(truth).map(|frame| Truth(Arc::new(frame))).collect()))
    }

    fn __iter__(&self) -> Frames {
        Frames(Mutex::new(FrameSource::dataset_camera(self.dataset.clone(), self.camera)))
    }

    fn __len__(&self) -> usize {
        self.of_camera().frames.len()
    }
}

/// Frames of a Y4M video, a folder of images, or a list of image files. Raises FileError; for a dataset folder see Dataset.
#[pyfunction]
pub(crate) fn frames(py: Python<'_>, source: Source) -> PyResult<Frames> {
    let opened = detached(py, || source.open().map_err(error::file))?;
    Ok(Frames(Mutex::new(opened)))
}

/// What frames are read from.
#[derive(FromPyObject)]
pub(crate) enum Source {
    One(PathBuf),
    Images(Vec<PathBuf>),
}

impl Source {
    fn open(self) -> photinus_io::Result<FrameSource> {
        let path = match self {
            Self::Images(paths) => return Ok(FrameSource::images(paths)),
            Self::One(path) => path,
        };
        match Kind::of(&path)? {
            Kind::Video => {
                let file = File::open(&path).map_err(|error| Error::io(&path, error))?;
                FrameSource::y4m(file, &path)
            }
            Kind::ImageFolder => images_in(&path).map(FrameSource::images),
            Kind::Dataset | Kind::Folder => Err(Error::format(&path, "it is a folder, but none of images")
                .advise("read a dataset by Dataset.read")),
            _ => Ok(FrameSource::images(vec![path])),
        }
    }
}

/// Reads an image as uint8, (rows, columns): PNG, JPEG, BMP, TIFF or PNM. Raises FileError; warns with PhotinusWarning of what was
/// done to samples that are no 8-bit grey.
#[pyfunction]
pub(crate) fn read_image(py: Python<'_>, path: PathBuf) -> PyResult<Py<PyArray2<u8>>> {
    let file = detached(py, || image::read_image(&path).map_err(error::file))?;
    let notes: Vec<String> = file.conversions.iter().map(ToString::to_string).collect();
    error::warn(py, &path, &notes)?;
    array(py, file.image)
}

/// The pixels as an array, which keeps them: no copy.
fn array(py: Python<'_>, image: GreyImage) -> PyResult<Py<PyArray2<u8>>> {
    let shape = [image.height(), image.width()];
    Ok(PyArray1::from_vec(py, image.into_pixels()).reshape(shape)?.unbind())
}
