//! Photos of a flat grid of LEDs -> a camera, as `photinus calibrate camera` makes it.

use std::collections::BTreeMap;
use std::path::PathBuf;

use photinus::frame::FrameView;
use photinus::spots::Detector;
use photinus_calibrate::camera::{BoardChoice, Calibration, Choices, Summary, calibrate};
use photinus_calibrate::grid::Grid;
use photinus_calibrate::lens::LensModel;
use photinus_calibrate::photo::{Photo, board_settings};
use photinus_io::camera::CalibrationSummary;
use photinus_io::image::read_image;
use pyo3::prelude::*;

use crate::camera::{Camera, write_camera};
use crate::error::{self, CalibrationError, SettingError, detached};
use crate::image::Image;

/// A camera that photos told, and how well.
#[pyclass(frozen, module = "photinus")]
pub(crate) struct CalibratedCamera {
    calibration: Calibration,
    summary: CalibrationSummary,
    refused: BTreeMap<String, String>,
    warnings: Vec<String>,
}

#[pymethods]
impl CalibratedCamera {
    /// The camera, with its covariance.
    #[getter]
    fn camera(&self) -> Camera {
        Camera::new(self.calibration.camera().clone())
    }

    /// The lens model, such as "kannala-brandt:2".
    #[getter]
    fn model(&self) -> String {
        self.calibration.lens().model().to_string()
    }

    /// Photos that it rests on.
    #[getter]
    fn photos_used(&self) -> u32 {
        self.summary.photos_used
    }

    /// Mean distance between where the photos show LEDs and where the camera expects them, px.
    #[getter]
    fn mean_px(&self) -> f64 {
        self.summary.mean_px
    }

    /// Root mean square of these distances, px.
    #[getter]
    fn rms_px(&self) -> f64 {
        self.summary.rms_px
    }

    /// The largest of these distances, px.
    #[getter]
    fn max_px(&self) -> f64 {
        self.summary.max_px
    }

    /// The photos in which the grid was not found, by name, and why.
    #[getter]
    fn refused(&self) -> BTreeMap<String, String> {
        self.refused.clone()
    }

    /// What is doubtful, a sentence each.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.warnings.clone()
    }

    /// Writes the camera as Photinus TOML; a file that is there already stays unless `force`. Raises FileError.
    #[pyo3(signature = (path, *, force = false))]
    fn write(&self, py: Python<'_>, path: PathBuf, force: bool) -> PyResult<()> {
        write_camera(py, self.calibration.camera(), Some(&self.summary), &path, force)
    }

    fn __repr__(&self) -> String {
        format!(
            "CalibratedCamera({}, {} photos, mean {:.4} px)",
            self.model(),
            self.photos_used(),
            self.mean_px()
        )
    }
}

/// A photo: a file, or an array.
#[derive(FromPyObject)]
pub(crate) enum PhotoOption<'py> {
    File(PathBuf),
    Array(Bound<'py, PyAny>),
}

/// Calibrates a camera from photos of a flat grid of LEDs: files, or uint8 arrays of (rows, columns). `grid` is how many LEDs stand along
/// its two sides, `pitch_m` how far apart, m. `model` is "auto", "equidistant", "kannala-brandt" (1 to 4 terms), "kannala-brandt:N", "ocam"
/// (degree 4 to 10) or "ocam:N"; `board` is "flat" where LEDs are exactly on the grid, "solve" where not, or "auto".
///
/// 15 to 30 photos with the grid near, far, tilted and at every edge make a good calibration. Raises FileError for a photo that cannot
/// be read, ImageError, SettingError, and CalibrationError when too few photos show the grid or nothing fits them.
#[pyfunction]
#[pyo3(signature = (photos, grid, pitch_m = 0.05, *, model = "auto", board = "auto"))]
pub(crate) fn calibrate_camera(
    py: Python<'_>,
    photos: Vec<PhotoOption<'_>>,
    grid: (usize, usize),
    pitch_m: f64,
    model: &str,
    board: &str,
) -> PyResult<CalibratedCamera> {
    let grid = Grid::new(grid.0, grid.1, pitch_m).map_err(error::setting)?;
    let choices = Choices {
        models: LensModel::candidates(model).map_err(error::setting)?,
        board: board_choice(board)?,
    };
    let mut searched = Vec::new();
    for (number, photo) in photos.iter().enumerate() {
        searched.push(match photo {
            PhotoOption::File(path) => detached(py, || {
                let image = read_image(path).map_err(error::file)?.image;
                search(path.display().to_string(), &image.view())
            })?,
            PhotoOption::Array(array) => {
                let image = Image::borrow(array)?;
                let view = image.view()?;
                detached(py, || search(number.to_string(), &view))?
            }
        });
    }
    detached(py, || solve(&searched, &grid, &choices))
}

fn board_choice(name: &str) -> PyResult<BoardChoice> {
    match name {
        "flat" => Ok(BoardChoice::Flat),
        "solve" => Ok(BoardChoice::Solve),
        "auto" => Ok(BoardChoice::Auto),
        _ => Err(SettingError::new_err(format!("`{name}` is no board: give flat, solve or auto"))),
    }
}

fn search(name: String, view: &FrameView<'_>) -> PyResult<Photo> {
    let mut detector = Detector::new(board_settings()).map_err(error::setting)?;
    Photo::of_frame(name, view, &mut detector).map_err(error::setting)
}

fn solve(photos: &[Photo], grid: &Grid, choices: &Choices) -> PyResult<CalibratedCamera> {
    let size_px = photos.first().map_or([0; 2], |photo| photo.size_px);
    if let Some(other) = photos.iter().find(|photo| photo.size_px != size_px) {
        return Err(CalibrationError::new_err(format!(
            "photo {} has {:?} pixels, photo {} {:?}: a calibration is of one camera at one size",
            other.name, other.size_px, photos[0].name, size_px
        )));
    }
    let (mut views, mut refused) = (Vec::new(), BTreeMap::new());
    for (index, photo) in photos.iter().enumerate() {
        match photo.view(index, grid) {
            Ok(view) => views.push(view),
            Err(error) => drop(refused.insert(photo.name.clone(), error.to_string())),
        }
    }
    let calibration = calibrate(&views, grid, size_px, choices, |_stage| ()).map_err(|error| {
        let photos: String = refused.iter().map(|(name, reason)| format!("\n  {name}: {reason}")).collect();
        CalibrationError::new_err(format!("{error}{photos}"))
    })?;
    let distances = Summary::of(calibration.residuals().iter().map(|residual| residual.off_px.norm()));
    let summary = CalibrationSummary {
        photos_used: u32::try_from(calibration.views().len()).unwrap_or(u32::MAX),
        mean_px: distances.mean_px,
        rms_px: distances.rms_px,
        max_px: distances.max_px,
    };
    let warnings = calibration.warnings(photos).iter().map(ToString::to_string).collect();
    Ok(CalibratedCamera { calibration, summary, refused, warnings })
}
