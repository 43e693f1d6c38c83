//! Frames to a Y4M video, to an MCAP recording or to a dataset folder.

use std::io::BufWriter;
use std::path::{Path, PathBuf};

use photinus_io::video::Y4mWriter;
use photinus_io::whole::WholeFile;
use photinus_io::{Cause, Error};
use photinus_link::messages::Viewpoint;
use photinus_link::recording::{Located, Recorder, Settings};

use super::Format;
use super::dataset::DatasetSink;
use crate::ending::Content;
use crate::failure::Failure;
use crate::input::{DatasetArgs, Input};
use crate::interrupt;
use crate::number;
use crate::targets::{FileTarget, Targets};
use crate::terminal::Terminal;
use photinus_run::Entry;
use photinus_run::in_frame;

/// What frames do not say themselves.
#[derive(Debug, clap::Args)]
pub(super) struct FrameArgs {
    /// Frames per second, where the input does not tell
    #[arg(long, value_name = "HZ", value_parser = number::positive)]
    rate: Option<f64>,
    /// The camera of a new dataset; the file is copied into it [default: that of the input, if a dataset]
    #[arg(long, value_name = "FILE")]
    pub(super) camera: Option<PathBuf>,
    /// The airframe of a new dataset; the file is copied into it [default: that of the input, if a dataset]
    #[arg(long, value_name = "FILE")]
    pub(super) airframe: Option<PathBuf>,
    #[command(flatten)]
    pub(super) dataset: DatasetArgs,
    /// Gravity over time for the frames of a new dataset: a table time_s,gx,gy,gz, down in the camera frame
    #[arg(long, value_name = "FILE.csv")]
    pub(super) gravity: Option<PathBuf>,
    /// The exposure of a new dataset, microseconds [default: that of the input, if a dataset]
    #[arg(long, value_name = "US", value_parser = number::positive)]
    pub(super) exposure_us: Option<f64>,
}

impl FrameArgs {
    /// The files that are read beside the frames.
    pub(super) fn files(&self) -> impl Iterator<Item = PathBuf> {
        [&self.camera, &self.airframe, &self.gravity].into_iter().flatten().cloned()
    }
}

/// Where frames go.
enum Sink {
    Video { target: FileTarget, writer: Option<Y4mWriter<BufWriter<WholeFile>>>, rate: (u32, u32) },
    Recording { target: FileTarget, recorder: Box<Recorder>, view: Viewpoint },
    Dataset(DatasetSink),
}

/// Writes every frame of `input` to `out`.
pub(super) fn convert(
    input: Input,
    out: &Path,
    format: Format,
    args: &FrameArgs,
    mut targets: Targets,
    terminal: &mut Terminal,
) -> Result<(), Failure> {
    let dataset = input.dataset.as_ref();
    let of_dataset = dataset.map(|dataset| dataset.info().rate_hz);
    input.one_camera()?;
    let mut entries = input.entries;
    let head: Vec<_> = entries.by_ref().take(2).collect();
    let rate_hz = args.rate.or(of_dataset).or_else(|| rate_of(&head));
    let mut sink = match format {
        Format::Dataset => Sink::Dataset(DatasetSink::create(
            &targets.folder(out)?,
            args,
            rate_hz,
            dataset.zip(input.cameras.first()),
        )?),
        Format::Mcap => {
            let target = targets.file(out, Content::Recording)?;
            let camera = input.cameras.first();
            let exposure_us = args.exposure_us.or(camera.map(|camera| camera.exposure_us));
            let exposure_s = exposure_us.map(|us| us * 1e-6);
            let view = Viewpoint::new(camera.and_then(|camera| camera.name.as_deref()), exposure_s);
            let recorder = Recorder::create(target.part(), Settings::default(), None);
            Sink::Recording { target, recorder: Box::new(recorder.map_err(Failure::running)?), view }
        }
        _ => Sink::Video {
            target: targets.file(out, Content::Y4m)?,
            writer: None,
            rate: rate_hz.map_or((0, 0), fraction),
        },
    };
    if format == Format::Y4m && rate_hz.is_none() {
        terminal.note(format_args!(
            "{}: the rate is not known, so the video has none; give --rate",
            out.display()
        ));
    }
    let (mut good, mut failed, mut with_gravity) = (0_u64, 0_u64, 0_u64);
    terminal.start(input.count);
    for entry in head.into_iter().chain(entries) {
        match entry {
            Ok(entry) => {
                with_gravity += u64::from(entry.gravity.is_some());
                match sink.write(&entry) {
                    Ok(()) => good += 1,
                    // A full disk stays full; a frame that does not fit is the frame's own fault.
                    Err(error) if matches!(error.cause, Cause::Io(_)) => {
                        return Err(Failure::running(error));
                    }
                    Err(error) => {
                        failed += 1;
                        terminal.error(error);
                    }
                }
            }
            Err(error) => {
                failed += 1;
                terminal.error(error);
            }
        }
        terminal.frame_done();
        if interrupt::is_asked() {
            break;
        }
    }
    interrupt::look_away();
    terminal.finish();
    if good == 0 {
        let none = || Failure::Input(format!("{}: it holds no frame", input.name));
        return Err(if failed > 0 { Failure::Frames { all: true } } else { none() });
    }
    if let Sink::Dataset(DatasetSink { without_gravity: without @ 1.., .. }) = &sink {
        terminal.warning(format_args!("{without} of {good} frames lie outside the times of the gravity"));
    }
    sink.keep().map_err(Failure::running)?;
    if with_gravity > 0 && format == Format::Y4m {
        let reason = "a video holds no gravity and no times of single frames: they are not kept";
        terminal.note(format_args!("{}: {reason}", out.display()));
    }
    if interrupt::is_asked() {
        let told = format!("interrupted after {good} frames; {} holds them", out.display());
        return Err(Failure::Interrupted(told));
    }
    if failed > 0 { Err(Failure::Frames { all: false }) } else { Ok(()) }
}

impl Sink {
    fn write(&mut self, entry: &Entry) -> photinus_io::Result<()> {
        match self {
            Self::Dataset(dataset) => dataset.write(entry),
            Self::Recording { recorder, view, .. } => {
                let image = entry.image.as_ref().map(|image| image.view());
                let frame =
                    Located { record: &entry.record, image, gravity: entry.gravity, moved: entry.moved };
                recorder.frame(&frame, view, view.header(entry.record.time_s).stamp.nanoseconds())
            }
            Self::Video { target, writer, rate } => {
                let Some(image) = &entry.image else { return Ok(()) };
                let frame = image.view();
                let writer = match writer {
                    Some(writer) => writer,
                    none => {
                        let size = (frame.width(), frame.height());
                        let file = BufWriter::new(target.whole()?);
                        none.insert(Y4mWriter::new(file, target.path(), size, *rate)?)
                    }
                };
                writer.write(&frame).map_err(|error| in_frame(error, entry))
            }
        }
    }

    /// What was written is whole.
    fn keep(self) -> photinus_io::Result<()> {
        match self {
            Self::Video { target, writer, .. } => {
                let Some(writer) = writer else { return Ok(()) };
                let buffered = writer.finish()?;
                let refuse = |error| Error::io(target.path(), error);
                buffered.into_inner().map_err(|error| refuse(error.into_error()))?.keep()
            }
            Self::Recording { target, recorder, .. } => {
                recorder.finish()?;
                target.take()
            }
            Self::Dataset(dataset) => dataset.keep(),
        }
    }
}

/// Frames per second, from the times of the first two frames.
fn rate_of(head: &[photinus_io::Result<Entry>]) -> Option<f64> {
    let [Ok(first), Ok(second)] = head else { return None };
    let step_s = second.record.time_s? - first.record.time_s?;
    (step_s > 0.0).then(|| 1.0 / step_s)
}

/// A rate as a fraction: exact for whole numbers, to a thousandth for others.
fn fraction(rate_hz: f64) -> (u32, u32) {
    let thousandths = (1e3 * rate_hz).round() as u32;
    if thousandths.is_multiple_of(1000) { (thousandths / 1000, 1) } else { (thousandths, 1000) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rates_become_fractions() {
        assert_eq!(fraction(60.0), (60, 1));
        assert_eq!(fraction(29.97), (29970, 1000));
        assert_eq!(fraction(1.0 / (1.0 / 60.0)), (60, 1), "as it comes back from times");
    }
}
