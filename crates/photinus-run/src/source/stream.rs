//! Y4M or raw grey frames, or spots of another detector, out of a pipe: standard input, a socket, the output of a command such as `gst-launch-1.0`.

use std::io::Read;
use std::net::{Shutdown, TcpStream};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

use photinus_io::frames::FrameSource;
use photinus_io::results::ResultsReader;
use photinus_io::video::RawFormat;
use photinus_io::{Error, Result};

use super::{Next, Source};
use crate::{Entry, HostClock};

/// What carries the frames.
#[derive(Clone, Debug, PartialEq)]
pub enum Carrier {
    /// Standard input.
    Standard,
    /// Standard output of a command: the program and its arguments.
    Command(Vec<String>),
    /// A TCP server that frames are fetched from: host and port.
    Tcp(String),
    /// A unix socket that frames are fetched from.
    Unix(PathBuf),
}

/// How the frames are written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum StreamFormat {
    /// Says its size itself.
    Y4m,
    /// Nothing but pixels.
    Raw(RawFormat),
    /// No frames, but the spots of each: a line of JSON, as results are written.
    Spots,
}

/// Where the times of frames come from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Times {
    /// What the stream says: of frames their number over its rate, which is wrong where a pipeline drops frames; of spots their own time.
    Stream,
    /// When a frame was here as a whole, less its exposure, s: what is on the way as long as another is off by the same.
    Arrival(HostClock, f64),
}

/// What frames are read from.
type Pipe = Box<dyn Read + Send>;

/// Frames out of a pipe.
pub struct Stream {
    frames: Carried,
    times: Times,
    name: String,
    ending: Ending,
}

/// What comes out of it.
enum Carried {
    Frames(FrameSource),
    Spots(ResultsReader<Pipe>),
}

impl Carried {
    /// The next entry, and whether others may follow one that cannot be used.
    fn next(&mut self) -> (Option<Result<Entry>>, bool) {
        match self {
            // Of a stream of pixels there is nothing after an error.
            Self::Frames(frames) => (frames.next().map(|frame| frame.map(Entry::from_frame)), false),
            Self::Spots(records) => (records.next().map(|record| record.map(Entry::from_spots)), true),
        }
    }
}

/// What the end of the pipe means, and what ends it.
enum Ending {
    /// There are no more frames.
    Last,
    /// As the exit status of the command says.
    Status(Arc<Mutex<Child>>),
    /// Whoever sends went away.
    Gone(Box<dyn Fn() + Send + Sync>),
}

impl Stream {
    /// Opens it; waits until its first bytes say what it is.
    ///
    /// # Errors
    /// [`Error`] when there is nothing to read from, or what is read is no such stream.
    pub fn open(carrier: &Carrier, format: StreamFormat, times: Times) -> Result<Self> {
        let (pipe, name, ending): (Pipe, String, Ending) = match carrier {
            Carrier::Standard => (Box::new(std::io::stdin()), "-".to_owned(), Ending::Last),
            Carrier::Command(words) => {
                let (child, output) = spawn(words)?;
                (output, words.first().cloned().unwrap_or_default(), Ending::Status(child))
            }
            Carrier::Tcp(address) => {
                let stream =
                    TcpStream::connect(address).map_err(|error| refused(Path::new(address), error))?;
                let other = stream.try_clone().map_err(|error| Error::io(address, error))?;
                (
                    Box::new(stream),
                    address.clone(),
                    Ending::Gone(Box::new(move || drop(other.shutdown(Shutdown::Both)))),
                )
            }
            Carrier::Unix(path) => unix(path)?,
        };
        let frames = match format {
            StreamFormat::Y4m => FrameSource::y4m(pipe, &name).map(Carried::Frames),
            StreamFormat::Raw(format) => FrameSource::raw(pipe, &name, format).map(Carried::Frames),
            StreamFormat::Spots => Ok(Carried::Spots(ResultsReader::new(pipe, &name))),
        };
        let frames = frames.inspect_err(|_| drop(ending.exit(true)))?;
        Ok(Self { frames, times, name, ending })
    }
}

impl Source for Stream {
    fn next(&mut self) -> Next {
        let mut entry = match self.frames.next() {
            (Some(Ok(entry)), _) => entry,
            (Some(Err(error)), true) => return Next::Bad(error),
            (Some(Err(error)), false) => return Next::Lost(error),
            (None, _) => {
                return self
                    .ending
                    .exit(false)
                    .map_or(Next::End, |why| Next::Lost(Error::format(&self.name, why)));
            }
        };
        let now = Instant::now();
        entry.taken = Some(now);
        if let Times::Arrival(clock, exposure_s) = &self.times {
            entry.record.time_s = Some(clock.unix_s(now) - exposure_s);
            entry.exposure_s = Some(*exposure_s);
        }
        if entry.record.source.is_empty() {
            entry.record.source.clone_from(&self.name);
        }
        Next::Frame(entry)
    }

    fn interrupter(&self) -> Option<Box<dyn Fn() + Send>> {
        match &self.ending {
            Ending::Status(child) => {
                let child = child.clone();
                Some(Box::new(move || drop(locked(&child).kill())))
            }
            Ending::Last | Ending::Gone(_) => None,
        }
    }
}

impl Drop for Stream {
    fn drop(&mut self) {
        let _ = self.ending.exit(true);
        if let Ending::Gone(close) = &self.ending {
            close();
        }
    }
}

impl Ending {
    /// Why the end of the pipe is a loss, if it is one. A command that still runs is ended first where that is wanted.
    fn exit(&self, kill: bool) -> Option<String> {
        match self {
            Self::Last => None,
            Self::Gone(_) => Some("whoever sent the frames closed the connection".to_owned()),
            Self::Status(child) => {
                let mut child = locked(child);
                if kill {
                    let _ = child.kill();
                }
                match child.wait() {
                    Ok(status) if status.success() => None,
                    Ok(status) => Some(format!("the command ended with {status}")),
                    Err(error) => Some(error.to_string()),
                }
            }
        }
    }
}

fn locked(child: &Mutex<Child>) -> std::sync::MutexGuard<'_, Child> {
    child.lock().unwrap_or_else(PoisonError::into_inner)
}

fn spawn(words: &[String]) -> Result<(Arc<Mutex<Child>>, Pipe)> {
    let Some((program, arguments)) = words.split_first() else {
        return Err(Error::format("command", "it is empty").advise("give the program and its arguments"));
    };
    let spawned = Command::new(program).args(arguments).stdin(Stdio::null()).stdout(Stdio::piped()).spawn();
    let mut child = spawned.map_err(|error| {
        Error::new(program, error).advise("check that the program is installed, and its name")
    })?;
    let output = child.stdout.take().ok_or_else(|| Error::format(program, "it has no output"))?;
    Ok((Arc::new(Mutex::new(child)), Box::new(output)))
}

#[cfg(unix)]
fn unix(path: &Path) -> Result<(Pipe, String, Ending)> {
    let stream = std::os::unix::net::UnixStream::connect(path).map_err(|error| refused(path, error))?;
    let other = stream.try_clone().map_err(|error| Error::io(path, error))?;
    let close = Ending::Gone(Box::new(move || drop(other.shutdown(Shutdown::Both))));
    Ok((Box::new(stream), path.display().to_string(), close))
}

#[cfg(not(unix))]
fn unix(path: &Path) -> Result<(Pipe, String, Ending)> {
    Err(Error::format(path, "this system has no unix sockets").advise("use tcp"))
}

fn refused(place: &Path, error: std::io::Error) -> Error {
    Error::new(place, error).advise("start what sends the frames")
}
