//! A log of poses as the command line names it: `FILE`, or `FILE:TOPIC` of a recording.

use std::fmt;
use std::path::{Path, PathBuf};

use photinus_io::dataset::{self, TimedPose};
use photinus_io::kind::Kind;
use photinus_io::{Error, Result};
use photinus_link::poses;

/// Where poses over time are.
#[derive(Clone, Debug)]
pub(super) struct PoseLog {
    /// A CSV of poses, an MCAP recording, or a bag of ROS 1.
    pub(super) file: PathBuf,
    /// Which topic of a recording; `None` for the only one that carries poses.
    topic: Option<String>,
}

impl PoseLog {
    /// The log of this name. What is a file by its whole name has no topic.
    pub(super) fn named(name: &Path) -> Self {
        let split = name.to_str().filter(|_| !name.exists()).and_then(|name| name.rsplit_once(':'));
        match split.filter(|(file, _)| Path::new(file).is_file()) {
            Some((file, topic)) => Self { file: file.into(), topic: Some(topic.to_owned()) },
            None => Self { file: name.to_owned(), topic: None },
        }
    }

    /// The poses, in the order of their times.
    ///
    /// # Errors
    /// [`Error`] when the file is no log of poses, is not in order, or has no such topic.
    pub(super) fn read(&self) -> Result<Vec<TimedPose>> {
        let is_stream = self.file.as_os_str() == "-";
        match (is_stream, &self.topic) {
            (true, _) => dataset::read_poses(&self.file),
            (false, topic) => match (Kind::of(&self.file)?, topic) {
                (Kind::Recording | Kind::Bag, topic) => poses::read_poses(&self.file, topic.as_deref()),
                (kind, Some(topic)) => {
                    let reason = format!("this is {kind}, which has no topic {topic}");
                    Err(Error::format(&self.file, reason).advise("name the file alone"))
                }
                (_, None) => dataset::read_poses(&self.file),
            },
        }
    }
}

impl fmt::Display for PoseLog {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.file.display())?;
        self.topic.as_ref().map_or(Ok(()), |topic| write!(f, ":{topic}"))
    }
}
