//! `photinus calibrate mask`: a recording of a camera that moves -> the mask of what stays with the camera.

use std::path::PathBuf;

use photinus::frame::FrameView;
use photinus::spots::{Brightness, Detector, Settings, SettingsError};
use photinus_calibrate::standing::{Standing, StandingMask};
use photinus_io::Error;
use photinus_io::image::png_bytes;
use photinus_run::Entry;

use crate::ending::Content;
use crate::failure::Failure;
use crate::input::{Input, InputArgs};
use crate::interrupt;
use crate::number;
use crate::targets::{Targets, WriteArgs};
use crate::terminal::Terminal;

const EXAMPLES: &str = "\
Examples:
  photinus calibrate mask recording --out mask.png
  photinus locate recording --mask mask.png --out results.jsonl
  # also what is bright in every fifth frame only: LEDs of the own airframe
  # that blink
  photinus calibrate mask recording --share 0.2 --out mask.png

What is bright in most frames at the same place of the image belongs to the
camera: the own airframe and its LEDs, hot pixels, dirt that shines. Let the
camera turn while it records: a lamp, the sun, or a neighbour that hovers before
a camera that does not move stays in its place, too, and would be masked.";

/// Frames that say what stays.
const FEWEST_FRAMES: u32 = 20;
/// A mask of more than this share of the image says that something is wrong.
const MOST_IGNORED: f64 = 0.5;

/// Calibrate the mask: where the camera sees itself, hot pixels and dirt in every frame
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Args {
    #[command(flatten)]
    input: InputArgs,
    /// A pixel is bright if it is N grey levels above the background around it [default: 20]
    #[arg(long, value_name = "N", value_parser = number::level)]
    contrast: Option<u8>,
    /// Write the mask: an image of the frames' size, 0 where nothing is to be looked for, 255 elsewhere
    #[arg(long, value_name = "FILE.png", required = true)]
    out: PathBuf,
    /// What is bright in this share of the frames stays
    #[arg(long, value_name = "SHARE", default_value_t = 0.5, value_parser = share)]
    share: f64,
    /// The mask reaches so many pixels past what stays
    #[arg(long, value_name = "PX", default_value_t = 2, value_parser = margin)]
    margin: u8,
    #[command(flatten)]
    write: WriteArgs,
    /// Print errors only
    #[arg(short, long)]
    quiet: bool,
}

impl Args {
    /// Whether only errors are to be printed.
    pub(crate) fn quiet(&self) -> bool {
        self.quiet
    }

    fn settings(&self) -> Settings {
        let mut settings = Settings::default();
        settings.brightness = self.contrast.map_or_else(Brightness::default, Brightness::Contrast);
        settings
    }
}

/// Runs the command.
pub(crate) fn run(args: &Args, terminal: &mut Terminal) -> Result<(), Failure> {
    let input = args.input.open()?;
    input.one_camera()?;
    let mut targets = Targets::new(args.write, input.files.iter().cloned());
    let out = targets.file(&args.out, Content::Png)?;
    let name = input.name.clone();
    let standing = collect(input, args, terminal)?;
    let mask = standing.mask(args.share, usize::from(args.margin));
    let ignored = mask.ignored();
    if ignored > MOST_IGNORED {
        let reason = format!("{:.0} % of the image is bright in most frames", 100.0 * ignored);
        let advice = "check exposure and --contrast: a camera with a UV filter sees hardly anything but LEDs";
        return Err(Failure::input(Error::format(&name, reason).advise(advice)));
    }
    let StandingMask { pixels, width, height, places } = &mask;
    let view =
        FrameView::packed(pixels, *width, *height).map_err(|error| Failure::Running(error.to_string()))?;
    png_bytes(out.path(), &view).and_then(|png| out.write(&png)).map_err(Failure::running)?;
    terminal.summary(format_args!("{}: written", out.path().display()));
    match (args.quiet, *places) {
        (true, _) => Ok(()),
        (_, 0) => terminal
            .result(format_args!("nothing stays in {} frames: the mask ignores nothing", standing.frames())),
        (_, places) => terminal.result(format_args!(
            "{places} {} in {} frames; the mask ignores {:.2} % of the image",
            if places == 1 { "place stays" } else { "places stay" },
            standing.frames(),
            100.0 * ignored
        )),
    }
}

/// Takes every frame in.
fn collect(input: Input, args: &Args, terminal: &mut Terminal) -> Result<Standing, Failure> {
    let wrong = |error: SettingsError| Failure::Input(error.to_string());
    let mut detector = Detector::new(args.settings()).map_err(wrong)?;
    let mut standing: Option<Standing> = None;
    let name = input.name;
    terminal.start(input.count);
    for entry in input.entries {
        if interrupt::is_asked() {
            break;
        }
        if let Err(error) = entry.and_then(|entry| add(&entry, &mut detector, &mut standing)) {
            terminal.error(error);
        }
        terminal.frame_done();
    }
    terminal.finish();
    let frames = standing.as_ref().map_or(0, Standing::frames);
    standing.filter(|_| frames >= FEWEST_FRAMES).ok_or_else(|| {
        let reason = format!("{frames} frames can be used, {FEWEST_FRAMES} are needed to see what stays");
        Failure::input(
            Error::format(&name, reason).advise("record for a few seconds while the vehicle moves"),
        )
    })
}

fn add(entry: &Entry, detector: &mut Detector, standing: &mut Option<Standing>) -> photinus_io::Result<()> {
    let Some(image) = &entry.image else { return Ok(()) };
    let frame = image.view();
    let standing = standing.get_or_insert_with(|| Standing::new(frame.width(), frame.height()));
    if standing.size() != [frame.width(), frame.height()] {
        let [width, height] = standing.size();
        let reason =
            format!("it has {} x {} px, those before {width} x {height}", frame.width(), frame.height());
        return Err(Error::format(&entry.record.source, reason).advise("give the frames of one camera"));
    }
    let found = detector.detect(&frame, None).map_err(|error| Error::new(&entry.record.source, error))?;
    standing.add(&frame, found);
    Ok(())
}

fn share(text: &str) -> Result<f64, String> {
    number::within(text, 0.05..=1.0, "a share")
}

fn margin(text: &str) -> Result<u8, String> {
    text.parse().ok().filter(|px| *px <= 50).ok_or_else(|| "give pixels, 0 to 50".to_owned())
}
