//! `photinus detect`: frames -> spots. No camera is needed.

use std::path::PathBuf;

use photinus::spots::Detector;
use photinus_io::Error;
use photinus_io::mask::MaskFile;
use photinus_io::results::{RejectedRecord, SpotRecord};
use photinus_run::{Clock, Entry, Work, in_frame};

use crate::failure::Failure;
use crate::input::InputArgs;
use crate::output::OutputArgs;
use crate::run;
use crate::spot_options::{SpotArgs, mask_of};
use crate::terminal::Terminal;

const EXAMPLES: &str = "\
Examples:
  # print the spots of a photo
  photinus detect photo.png
  # draw them into seen/
  photinus detect *.png --overlay seen
  # write them, a line per frame
  photinus detect video.y4m --out spots.jsonl
  photinus detect recording --threshold 200 -q --out - | head -1
  ffmpeg -i video.mp4 -pix_fmt gray -f yuv4mpegpipe -strict -1 - \\
      | photinus detect -
  photinus detect frames.raw --raw 752x480@60";

/// Find the spots of frames; no camera is needed
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Args {
    #[command(flatten)]
    input: InputArgs,
    #[command(flatten)]
    spots: SpotArgs,
    #[command(flatten)]
    output: OutputArgs,
}

impl Args {
    /// Whether only errors and results are to be printed.
    pub(crate) fn quiet(&self) -> bool {
        self.output.quiet
    }
}

/// Runs the command.
pub(crate) fn run(args: &Args, terminal: &mut Terminal) -> Result<(), Failure> {
    let done = args.output.done()?;
    let input = args.input.open()?;
    let masks = args.spots.masks(&input, terminal)?;
    let detector = || Detector::new(args.spots.settings()).map_err(|error| Failure::Input(error.to_string()));
    let detectors = masks.iter().map(|_| detector()).collect::<Result<_, _>>()?;
    let read: Vec<PathBuf> = input.files.iter().cloned().chain(args.spots.file()).collect();
    let outputs = args.output.claim(None, &read, Vec::new(), lines)?;
    run::run(input, outputs, done.as_ref(), terminal, &mut Detecting { detectors, masks })
}

/// Detecting in the frames of each camera.
struct Detecting {
    detectors: Vec<Detector>,
    masks: Vec<Option<MaskFile>>,
}

impl Work for Detecting {
    fn fill(&mut self, entry: &mut Entry, clock: &mut Clock) -> photinus_io::Result<()> {
        let Some(image) = &entry.image else { return Ok(()) };
        let frame = image.view();
        let mask = self.masks[entry.camera].as_ref();
        if let Some(mask) = mask {
            mask.check_size(frame.width(), frame.height())?;
        }
        let found = self.detectors[entry.camera]
            .detect(&frame, mask_of(mask))
            .map_err(|error| in_frame(Error::new(&entry.record.source, error), entry))?;
        clock.lap("spots");
        entry.record.spots = found.spots.iter().map(SpotRecord::from).collect();
        entry.record.rejected = found.rejected.iter().map(RejectedRecord::from).collect();
        Ok(())
    }

    fn learns(&self) -> bool {
        self.detectors.iter().any(Detector::learns)
    }

    fn learn(&mut self, entry: &mut Entry) {
        if let Some(image) = &entry.image {
            // A mask of another size is refused, and then the frame teaches nothing.
            let mask = mask_of(self.masks[entry.camera].as_ref());
            let _ = self.detectors[entry.camera].detect(&image.view(), mask);
        }
    }
}

fn lines(entry: &Entry) -> Vec<String> {
    let frame = entry.record.frame.unwrap_or_default();
    let line = |(number, spot): (usize, &SpotRecord)| {
        format!(
            "frame {frame:>5}  spot {number:>2}  at {:8.2} {:8.2} px  sigma {:.2} px  {:>4} px bright, peak {:>3}  a marker {:>3.0} %",
            spot.u_px,
            spot.v_px,
            spot.sigma_px,
            spot.area_px,
            spot.peak,
            100.0 * spot.probability
        )
    };
    entry.record.spots.iter().enumerate().map(line).collect()
}
