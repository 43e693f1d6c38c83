//! Frames to a Y4M video or to a dataset folder.

use std::fs::File;
use std::io::BufWriter;
use std::path::{Path, PathBuf};

use photinus_io::video::Y4mWriter;

use super::Format;
use super::dataset::DatasetSink;
use crate::detect::in_frame;
use crate::failure::Failure;
use crate::input::{Entry, Input};
use crate::number;
use crate::output::create;
use crate::terminal::Terminal;

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
    /// The exposure of a new dataset, microseconds [default: that of the input, if a dataset]
    #[arg(long, value_name = "US", value_parser = number::positive)]
    pub(super) exposure_us: Option<f64>,
}

/// Where frames go.
enum Sink {
    Video { writer: Option<Y4mWriter<BufWriter<File>>>, file: Option<File>, rate: (u32, u32) },
    Dataset(DatasetSink),
}

/// Writes every frame of `input` to `out`.
pub(super) fn convert(
    input: Input,
    out: &Path,
    format: Format,
    args: &FrameArgs,
    terminal: &mut Terminal,
) -> Result<(), Failure> {
    let dataset = input.dataset.as_ref();
    let of_dataset = dataset.map(|dataset| dataset.info().rate_hz);
    let mut entries = input.entries;
    let head: Vec<_> = entries.by_ref().take(2).collect();
    let rate_hz = args.rate.or(of_dataset).or_else(|| rate_of(&head));
    let mut sink = match format {
        Format::Dataset => Sink::Dataset(DatasetSink::create(out, args, rate_hz, dataset)?),
        _ => Sink::Video { writer: None, file: Some(create(out)?), rate: rate_hz.map_or((0, 0), fraction) },
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
        let written = entry.and_then(|entry| {
            with_gravity += u64::from(entry.gravity.is_some());
            sink.write(&entry, out)
        });
        match written {
            Ok(()) => good += 1,
            Err(error) => {
                failed += 1;
                terminal.error(error);
            }
        }
        terminal.frame_done();
    }
    terminal.finish();
    sink.finish().map_err(Failure::running)?;
    if with_gravity > 0 && format == Format::Y4m {
        let reason = "a video holds no gravity and no times of single frames: they are not kept";
        terminal.note(format_args!("{}: {reason}", out.display()));
    }
    if failed > 0 { Err(Failure::Frames { all: good == 0 }) } else { Ok(()) }
}

impl Sink {
    fn write(&mut self, entry: &Entry, out: &Path) -> photinus_io::Result<()> {
        match self {
            Self::Dataset(dataset) => dataset.write(entry),
            Self::Video { writer, file, rate } => {
                let Some(image) = &entry.image else { return Ok(()) };
                let frame = image.view();
                if let (None, Some(file)) = (&writer, file.take()) {
                    let size = (frame.width(), frame.height());
                    *writer = Some(Y4mWriter::new(BufWriter::new(file), out, size, *rate)?);
                }
                match writer {
                    Some(writer) => writer.write(&frame).map_err(|error| in_frame(error, entry)),
                    None => Ok(()),
                }
            }
        }
    }

    fn finish(self) -> photinus_io::Result<()> {
        match self {
            Self::Video { writer: Some(writer), .. } => writer.finish().map(drop),
            Self::Video { .. } | Self::Dataset(_) => Ok(()),
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
