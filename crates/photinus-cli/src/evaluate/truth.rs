//! Ground truth: enters the folder of a dataset or a truth file alone, leaves what was where, of one camera.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use photinus_evaluate::alignment::Alignment;
use photinus_io::dataset::{Dataset, TRUTH_FILE, TruthFrame, read_truth};
use photinus_io::kind::{Kind, Table};
use photinus_io::{Error, Result};

use super::pose_log::PoseLog;
use crate::failure::Failure;
use crate::input::names;

/// Truth of one camera.
pub(super) struct GroundTruth {
    /// What was where, frame by frame.
    pub(super) frames: Vec<TruthFrame>,
    /// The camera, where there are several.
    pub(super) camera: Option<String>,
    /// Times of a result and of truth that differ by less are of one frame, s.
    pub(super) time_tolerance_s: f64,
    /// The files that it was read from, which no output may replace.
    pub(super) files: Vec<PathBuf>,
    /// The file of the truth itself, for messages.
    pub(super) path: PathBuf,
    /// The file that lists the frames, and their numbers: results of others belong to something else.
    pub(super) listed: (PathBuf, BTreeSet<u64>),
    /// What was estimated to have it, where it comes from logs.
    pub(super) alignment: Option<Alignment>,
}

impl GroundTruth {
    /// Reads the truth of a dataset folder, or of a file.
    ///
    /// # Errors
    /// [`Failure`] when it is neither, holds no truth, or has several cameras and none is named.
    pub(super) fn read(path: &Path, only: Option<&String>) -> std::result::Result<Self, Failure> {
        if path.is_dir() {
            return Self::of_dataset(path, only);
        }
        let log = PoseLog::named(path);
        match Kind::of(&log.file).map_err(Failure::input)? {
            Kind::Truth => Self::of_file(path, only),
            kind @ (Kind::Table(Table::Poses | Table::Odometry) | Kind::Recording | Kind::Bag) => {
                let advice = "to get truth from poses, give the log of the other vehicle, too: --target FILE, or FILE:TOPIC";
                Err(Failure::input(Error::format(log.file, format!("this is {kind}")).advise(advice)))
            }
            other => {
                let known = "name the folder of a dataset with truth.jsonl, or such a file";
                Err(Failure::input(other.refuse(path, "ground truth", known)))
            }
        }
    }

    fn of_dataset(folder: &Path, only: Option<&String>) -> std::result::Result<Self, Failure> {
        let dataset = Dataset::read(folder).map_err(Failure::input)?;
        let told = || format!("{}: it has {}", folder.display(), names(dataset.cameras()));
        let camera = match (dataset.cameras(), only) {
            ([camera], None) => camera,
            (_, None) => return Err(Failure::Input(format!("{}; choose one with --only NAME", told()))),
            (cameras, Some(only)) => cameras
                .iter()
                .find(|camera| camera.name.as_ref() == Some(only))
                .ok_or_else(|| Failure::Input(format!("{}; --only names another", told())))?,
        };
        let frames = dataset.truth().map_err(Failure::input)?.ok_or_else(|| {
            let advice = "only results of a dataset with truth can be evaluated, such as a simulated one";
            Failure::input(Error::format(folder, "the folder holds no truth.jsonl").advise(advice))
        })?;
        let listed = camera.frames.iter().map(|row| row.frame).collect();
        Ok(Self {
            frames: of_camera(frames, camera.name.as_ref()),
            camera: camera.name.clone(),
            time_tolerance_s: 0.5 / dataset.info().rate_hz,
            files: dataset.files(),
            path: dataset.path(TRUTH_FILE),
            listed: (dataset.path(&camera.frames_file), listed),
            alignment: None,
        })
    }

    fn of_file(path: &Path, only: Option<&String>) -> std::result::Result<Self, Failure> {
        let frames = read_truth(path).map_err(Failure::input)?;
        let cameras: BTreeSet<Option<&String>> = frames.iter().map(|frame| frame.camera.as_ref()).collect();
        let camera = match (cameras.len(), only) {
            (0 | 1, None) => cameras.first().copied().flatten().cloned(),
            (_, Some(only)) if cameras.contains(&Some(only)) => Some(only.clone()),
            _ => {
                let names: Vec<&str> = cameras.iter().flatten().map(|name| name.as_str()).collect();
                let reason = format!("it tells of the cameras {}", names.join(", "));
                return Err(Failure::input(
                    Error::format(path, reason).advise("choose one with --only NAME"),
                ));
            }
        };
        let frames = of_camera(frames, camera.as_ref());
        let listed = frames.iter().map(|frame| frame.frame).collect();
        Ok(Self {
            time_tolerance_s: tolerance(&frames, path).map_err(Failure::input)?,
            frames,
            camera,
            files: vec![path.to_owned()],
            path: path.to_owned(),
            listed: (path.to_owned(), listed),
            alignment: None,
        })
    }
}

fn of_camera(mut frames: Vec<TruthFrame>, camera: Option<&String>) -> Vec<TruthFrame> {
    frames.retain(|frame| frame.camera.as_ref() == camera);
    frames
}

/// Half the usual time between frames, s.
pub(super) fn tolerance(frames: &[TruthFrame], path: &Path) -> Result<f64> {
    let mut times_s: Vec<f64> = frames.iter().map(|frame| frame.time_s).collect();
    times_s.sort_by(f64::total_cmp);
    let mut steps_s: Vec<f64> =
        times_s.windows(2).map(|pair| pair[1] - pair[0]).filter(|&step_s| step_s > 0.0).collect();
    steps_s.sort_by(f64::total_cmp);
    match (steps_s.get(steps_s.len() / 2), frames) {
        (Some(step_s), _) => Ok(0.5 * step_s),
        // A single frame has nothing to be mistaken for.
        (None, [_, ..]) => Ok(0.5),
        (None, []) => {
            Err(Error::format(path, "it tells of no frame").advise("give the truth of a recording"))
        }
    }
}
