//! A dataset folder, written frame by frame.

use std::fs::File;
use std::io::{LineWriter, Write};
use std::path::{Path, PathBuf};

use nalgebra::{Unit, Vector3};
use photinus::frame::FrameView;
use serde::Serialize;

use super::frames_csv::COLUMNS;
use super::{
    DATASET_FILE, DatasetInfo, FRAMES_FILE, IMU_FILE, ImuRow, ODOMETRY_FILE, OdometryRow, RigInfo,
    TRUTH_FILE, TruthFrame, imu, odometry,
};
use crate::{Error, Place, Result, image, lines, physics};

/// Writes a dataset folder. What was written before a crash is a dataset of its own.
#[derive(Debug)]
pub struct DatasetWriter {
    folder: PathBuf,
    cameras: Vec<CameraWriter>,
    truth: Option<LineWriter<File>>,
    imu: Option<Table>,
    odometry: Option<Table>,
}

/// The frames of one camera.
#[derive(Debug)]
struct CameraWriter {
    path: PathBuf,
    rows: LineWriter<File>,
    /// Folder of its images, as frames.csv names it.
    images: String,
    next: u64,
    last_time_s: f64,
}

/// Rows over time.
#[derive(Debug)]
struct Table {
    rows: LineWriter<File>,
    last_time_s: f64,
}

/// A row of frames.csv that is written for an image of its own or of another frame.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Row {
    number: u64,
    time_s: f64,
    gravity: Option<Unit<Vector3<f64>>>,
    /// Number of the frame whose image the row names.
    shown: u64,
}

impl DatasetWriter {
    /// Starts a dataset in `folder`, which is made; the files that `info` names are the caller's to put there.
    ///
    /// # Errors
    /// [`Error`] when the folder holds a dataset already, cannot be written, or `info` is not in order.
    pub fn create(folder: impl AsRef<Path>, info: &DatasetInfo) -> Result<Self> {
        info.check(&folder.as_ref().join(DATASET_FILE))?;
        Self::start(folder.as_ref(), info, &[FRAMES_FILE.into()])
    }

    /// Starts a dataset with several cameras, as [`DatasetWriter::create`]; the images of each lie beside its frames.csv.
    ///
    /// # Errors
    /// As [`DatasetWriter::create`].
    pub fn create_rig(folder: impl AsRef<Path>, info: &RigInfo) -> Result<Self> {
        info.check(&folder.as_ref().join(DATASET_FILE))?;
        let frames: Vec<PathBuf> = info.cameras.iter().map(|camera| camera.frames.clone()).collect();
        Self::start(folder.as_ref(), info, &frames)
    }

    fn start(folder: &Path, info: &impl Serialize, frames: &[PathBuf]) -> Result<Self> {
        let dataset_file = folder.join(DATASET_FILE);
        let text = toml::to_string(info).map_err(|error| Error::format(&dataset_file, error.to_string()))?;
        std::fs::create_dir_all(folder).map_err(|error| Error::io(folder, error))?;
        let mut file = File::create_new(&dataset_file).map_err(|error| Error::io(&dataset_file, error))?;
        file.write_all(text.as_bytes()).map_err(|error| Error::io(&dataset_file, error))?;
        let cameras =
            frames.iter().map(|frames| CameraWriter::create(folder, frames)).collect::<Result<_>>()?;
        Ok(Self { folder: folder.to_owned(), cameras, truth: None, imu: None, odometry: None })
    }

    /// Adds a frame of the first camera taken at `time_s`, with the direction of gravity in the camera frame where that is
    /// known, and gives its number, the next one.
    ///
    /// # Errors
    /// As [`DatasetWriter::numbered_frame`].
    pub fn frame(
        &mut self,
        frame: &FrameView<'_>,
        time_s: f64,
        gravity: Option<Unit<Vector3<f64>>>,
    ) -> Result<u64> {
        let number = self.cameras[0].next;
        self.numbered_frame(number, frame, time_s, gravity)?;
        Ok(number)
    }

    /// Adds a frame of the first camera that has a number already, of those of another recording.
    ///
    /// # Errors
    /// [`Error`] when a file cannot be written, or when the number or the time does not come after that of the frame
    /// before.
    pub fn numbered_frame(
        &mut self,
        number: u64,
        frame: &FrameView<'_>,
        time_s: f64,
        gravity: Option<Unit<Vector3<f64>>>,
    ) -> Result<()> {
        let row = Row { number, time_s, gravity, shown: number };
        let camera = &mut self.cameras[0];
        camera.check(&row)?;
        camera.image(&self.folder, number, frame)?;
        camera.row(&row)
    }

    /// Writes the image of frame `number` of a camera, for which a row may follow.
    ///
    /// # Errors
    /// [`Error`] when the file cannot be written, or there is no such camera.
    pub fn image(&mut self, camera: usize, number: u64, frame: &FrameView<'_>) -> Result<()> {
        let folder = self.folder.clone();
        self.camera(camera)?.image(&folder, number, frame)
    }

    /// Adds the row of frame `number` of a camera, which names the image of frame `shown`: its own, or, in a recording that went
    /// wrong, another one.
    ///
    /// # Errors
    /// [`Error`] when the file cannot be written, there is no such camera, or when the number or the time does not come after
    /// that of the row before.
    pub fn row(
        &mut self,
        camera: usize,
        number: u64,
        time_s: f64,
        gravity: Option<Unit<Vector3<f64>>>,
        shown: u64,
    ) -> Result<()> {
        let row = Row { number, time_s, gravity, shown };
        let camera = self.camera(camera)?;
        camera.check(&row)?;
        camera.row(&row)
    }

    /// Adds the truth of a frame.
    ///
    /// # Errors
    /// [`Error`] when the file cannot be written or a number is not finite.
    pub fn truth(&mut self, truth: &TruthFrame) -> Result<()> {
        let path = self.folder.join(TRUTH_FILE);
        if !truth.is_finite() {
            return Err(Error::format(path, "a number of the truth is not finite")
                .at(Place::Frame(truth.frame))
                .advise("leave out what is not known"));
        }
        let file = match &mut self.truth {
            Some(file) => file,
            none => none.insert(create(&path, "")?),
        };
        lines::write_json(file, truth, &path)
    }

    /// Adds a measurement of how fast the camera (of several: the vehicle's body) turns.
    ///
    /// # Errors
    /// [`Error`] when the file cannot be written, or the measurement does not come after the one before.
    pub fn imu(&mut self, row: &ImuRow) -> Result<()> {
        let path = self.folder.join(IMU_FILE);
        Table::add(&mut self.imu, &path, &imu::header(), row.time_s, &row.line())
    }

    /// Adds a measurement of where the vehicle with the cameras is.
    ///
    /// # Errors
    /// As [`DatasetWriter::imu`]. All rows tell what their velocities are off by, or none does.
    pub fn odometry(&mut self, row: &OdometryRow) -> Result<()> {
        let path = self.folder.join(ODOMETRY_FILE);
        Table::add(
            &mut self.odometry,
            &path,
            &odometry::header(row.velocity_sigma_m_s.is_some()),
            row.time_s,
            &row.line(),
        )
    }

    fn camera(&mut self, index: usize) -> Result<&mut CameraWriter> {
        let refuse = || Error::format(&self.folder, format!("the dataset has no camera number {index}"));
        self.cameras.get_mut(index).ok_or_else(refuse)
    }
}

impl CameraWriter {
    fn create(folder: &Path, frames: &Path) -> Result<Self> {
        let beside = frames.parent().filter(|parent| !parent.as_os_str().is_empty());
        let images = beside.map_or("images".to_owned(), |beside| format!("{}/images", beside.display()));
        let images_folder = folder.join(&images);
        std::fs::create_dir_all(&images_folder).map_err(|error| Error::io(&images_folder, error))?;
        let path = folder.join(frames);
        let rows = create(&path, &format!("{}\n", COLUMNS.join(",")))?;
        Ok(Self { path, rows, images, next: 0, last_time_s: f64::NEG_INFINITY })
    }

    fn check(&self, row: &Row) -> Result<()> {
        let reason = if row.number < self.next {
            format!("number {} does not come after the frame before", row.number)
        } else if !(physics::TIME_S.contains(&row.time_s) && row.time_s > self.last_time_s) {
            format!("{} s is no time after the frame before", row.time_s)
        } else {
            return Ok(());
        };
        Err(Error::format(&self.path, reason)
            .at(Place::Frame(row.number))
            .advise("write frames in the order in which they were taken"))
    }

    fn image(&self, folder: &Path, number: u64, frame: &FrameView<'_>) -> Result<()> {
        image::write_png(folder.join(self.image_name(number)), frame)
    }

    fn image_name(&self, number: u64) -> String {
        format!("{}/{number:06}.png", self.images)
    }

    fn row(&mut self, row: &Row) -> Result<()> {
        let down = row.gravity.map_or(",,".to_owned(), |g| format!("{},{},{}", g.x, g.y, g.z));
        let name = self.image_name(row.shown);
        writeln!(self.rows, "{},{},{name},{down}", row.number, row.time_s)
            .map_err(|error| Error::io(&self.path, error))?;
        (self.next, self.last_time_s) = (row.number.saturating_add(1), row.time_s);
        Ok(())
    }
}

impl Table {
    /// Adds a line to a table, which is begun with `header` when it was not.
    fn add(table: &mut Option<Self>, path: &Path, header: &str, time_s: f64, line: &str) -> Result<()> {
        let table = match table {
            Some(table) => table,
            none => {
                let rows = create(path, &format!("{header}\n"))?;
                none.insert(Self { rows, last_time_s: f64::NEG_INFINITY })
            }
        };
        if !(physics::TIME_S.contains(&time_s) && time_s > table.last_time_s) {
            return Err(Error::format(path, format!("{time_s} s is no time after the line before"))
                .advise("write measurements in the order in which they were taken"));
        }
        writeln!(table.rows, "{line}").map_err(|error| Error::io(path, error))?;
        table.last_time_s = time_s;
        Ok(())
    }
}

fn create(path: &Path, first: &str) -> Result<LineWriter<File>> {
    let mut file = LineWriter::new(File::create(path).map_err(|error| Error::io(path, error))?);
    file.write_all(first.as_bytes()).map_err(|error| Error::io(path, error))?;
    Ok(file)
}
