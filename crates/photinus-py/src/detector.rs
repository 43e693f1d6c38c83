//! Frames -> spots. No camera is needed.

use std::sync::{Arc, Mutex, PoisonError};

use photinus::frame::Mask;
use photinus::spots;
use photinus_io::results::{FrameRecord, RejectedRecord, SpotRecord};
use pyo3::prelude::*;

use crate::error::{self, ImageError, detached};
use crate::image::Image;
use crate::options::{MaskOption, spot_settings};
use crate::record::{Record, empty};

/// Finds spots in frame after frame of one camera, as `photinus detect` does: noise, full level and point spread are learnt from the
/// frames that came before. May be shared by threads, which then wait for each other.
///
/// Options: `contrast`, a pixel is bright that many grey levels above the background around it (20 where `threshold` is not given);
/// `threshold`, bright from this grey level on; `reflection_ratio`, a spot with less than this share of the brightest one's light
/// is more likely its reflection; `mask`, an image file or uint8 array of the frames' size, 0 where not to look.
/// Raises SettingError, FileError, ImageError.
#[pyclass(frozen, module = "photinus")]
pub(crate) struct Detector {
    detector: Mutex<spots::Detector>,
    mask: Option<Mask>,
}

#[pymethods]
impl Detector {
    #[new]
    #[pyo3(signature = (*, contrast = None, threshold = None, reflection_ratio = 0.22, mask = None))]
    fn new(
        py: Python<'_>,
        contrast: Option<u8>,
        threshold: Option<u8>,
        reflection_ratio: f64,
        mask: Option<MaskOption<'_>>,
    ) -> PyResult<Self> {
        let settings = spot_settings(contrast, threshold, reflection_ratio)?;
        let detector = Mutex::new(spots::Detector::new(settings).map_err(error::setting)?);
        let mask = mask.map(|mask| mask.read(py)).transpose()?;
        Ok(Self { detector, mask })
    }

    /// The spots of an image: uint8, (rows, columns), rows may be padded; it is borrowed, not copied, and must not be written to
    /// meanwhile. `time`, s, and `frame`, its number, stand in the record as given.
    ///
    /// Raises ImageError when the array is no frame, or of another size than the mask.
    #[pyo3(signature = (image, *, time = None, frame = None))]
    fn detect(
        &self,
        py: Python<'_>,
        image: &Bound<'_, PyAny>,
        time: Option<f64>,
        frame: Option<u64>,
    ) -> PyResult<Record> {
        let image = Image::borrow(image)?;
        let (view, mut record) = (image.view()?, empty(frame, time)?);
        detached(py, || {
            // A detector that a fault left is made anew by the frame.
            let mut detector = self.detector.lock().unwrap_or_else(PoisonError::into_inner);
            let found = detector
                .detect(&view, self.mask.as_ref())
                .map_err(|error| ImageError::new_err(error.to_string()))?;
            put(&mut record, found);
            Ok(Record(Arc::new(record)))
        })
    }
}

/// The spots of one image that nothing came before; the options are those of Detector, the errors, too.
#[pyfunction]
#[pyo3(signature = (image, *, contrast = None, threshold = None, reflection_ratio = 0.22, mask = None, time = None, frame = None))]
#[allow(clippy::too_many_arguments)] // the options of the program, by name
pub(crate) fn detect(
    py: Python<'_>,
    image: &Bound<'_, PyAny>,
    contrast: Option<u8>,
    threshold: Option<u8>,
    reflection_ratio: f64,
    mask: Option<MaskOption<'_>>,
    time: Option<f64>,
    frame: Option<u64>,
) -> PyResult<Record> {
    Detector::new(py, contrast, threshold, reflection_ratio, mask)?.detect(py, image, time, frame)
}

fn put(record: &mut FrameRecord, found: &spots::Detections) {
    record.spots = found.spots.iter().map(SpotRecord::from).collect();
    record.rejected = found.rejected.iter().map(RejectedRecord::from).collect();
}
