//! `photinus calibrate spot-size`: a recording of one LED at known distances -> the curve that bounds ranges.
//!
//! ```text
//! recordings   a dataset through the detector, or a table -> areas over distance, per exposure
//! report       what was found, to read and as JSON; the file of the curve
//! plot         the same as a figure
//! ```

mod plot;
mod recordings;
mod report;

use std::path::{Path, PathBuf};

use photinus_calibrate::spot_size::{SpotSizeError, calibrate};
use photinus_io::Error;

use crate::ending::Content;
use crate::failure::Failure;
use crate::input::DatasetArgs;
use crate::number;
use crate::plots::FigureFolder;
use crate::spot_options::SpotArgs;
use crate::targets::{FileTarget, Targets, WriteArgs};
use crate::terminal::Terminal;
use recordings::Recording;

const EXAMPLES: &str = "\
Examples:
  photinus calibrate spot-size recording --threshold 200 --out spots.toml
  photinus calibrate spot-size areas.csv --out spots.toml --plots figures
  # where there is no recording
  photinus simulate scenes/receding-led.toml --out recording
  photinus locate flight --threshold 200 --spot-curve spots.toml

A recording is a dataset folder with truth.jsonl and one LED in sight; a table
has the columns distance_m,area_px and, for several exposures, exposure_us
(docs/file-formats.md). Let the LED face the camera, move it through all
distances that matter, and let it sway, so that it is seen at every place within
a pixel.";

/// Calibrate how large the spot of an LED can be at a distance
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Args {
    /// The folder of a dataset with truth, or a table (CSV) of distances and areas
    #[arg(value_name = "INPUT")]
    input: PathBuf,
    /// Write the curve, for `photinus locate --spot-curve`; of several exposures each goes to its own file
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Write every number as JSON, described in docs/file-formats.md
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Draw the areas and the curves, PNG and SVG, into this folder, which is made
    #[arg(long, value_name = "DIR")]
    plots: Option<PathBuf>,
    /// How much brighter than this one other LEDs of the fleet may be, in percent
    #[arg(long, value_name = "PERCENT", default_value_t = 20.0, value_parser = percent)]
    brighter: f64,
    #[command(flatten)]
    spots: SpotArgs,
    #[command(flatten)]
    dataset: DatasetArgs,
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

    fn out(&self, recording: &Recording, several: bool) -> Option<PathBuf> {
        let out = self.out.as_ref()?;
        match (several, recording.exposure_us) {
            (true, Some(exposure_us)) => {
                let (stem, end) = (out.file_stem()?.to_string_lossy(), out.extension().unwrap_or_default());
                let name = format!("{stem}-{exposure_us}us.{}", end.to_string_lossy());
                Some(out.with_file_name(name.trim_end_matches('.')))
            }
            _ => Some(out.clone()),
        }
    }
}

/// Runs the command.
pub(crate) fn run(args: &Args, terminal: &mut Terminal) -> Result<(), Failure> {
    let mut targets = Targets::new(args.write, [args.input.clone()].into_iter().chain(args.spots.file()));
    let json = args.json.as_deref().map(|path| targets.file(path, Content::Json)).transpose()?;
    let plots = args.plots.as_deref().map(|path| targets.folder(path)).transpose()?;
    let recordings = recordings::read(&args.input, &args.dataset, &args.spots, terminal)?;
    let out = |recording| args.out(recording, recordings.len() > 1);
    let curves = recordings
        .iter()
        .map(|recording| out(recording).map(|path| targets.file(&path, Content::Toml)).transpose());
    let curves: Vec<Option<FileTarget>> = curves.collect::<Result<_, _>>()?;
    let figures = plots.map(|plots| plots.whole()).transpose().map_err(Failure::input)?;
    let mut reports = Vec::new();
    for (recording, curve) in recordings.iter().zip(curves) {
        let found = calibrate(&recording.samples, args.brighter / 100.0)
            .map_err(|error| refuse(&args.input, recording, error))?;
        recording.warn(&args.input, terminal);
        if let Some(curve) = curve {
            let text = report::curve_file(recording, &found, args.brighter);
            curve.write(text.as_bytes()).map_err(Failure::running)?;
        }
        if let Some(figures) = &figures {
            let drawn = FigureFolder::new(figures.path()).write(plot::figure(recording, &found));
            drawn.map_err(|error| Failure::running(figures.tell(error)))?;
        }
        if !args.quiet {
            terminal.result(report::Told { recording, found: &found, brighter_percent: args.brighter })?;
        }
        reports.push(report::json(recording, &found));
    }
    if let Some(figures) = figures {
        figures.keep().map_err(Failure::running)?;
    }
    if let Some(json) = json {
        let text = format!("{:#}\n", serde_json::Value::from(reports));
        json.write(text.as_bytes()).map_err(Failure::running)?;
    }
    Ok(())
}

fn refuse(input: &Path, recording: &Recording, error: SpotSizeError) -> Failure {
    let advice = match error {
        SpotSizeError::TooFew { .. } => {
            "record more frames; what is taken for a spot depends on --threshold or --contrast"
        }
        SpotSizeError::Span { .. } => "move the LED farther away while recording",
        SpotSizeError::NotFalling => "check that the distances and the areas belong together",
        _ => "correct it there",
    };
    let reason = match recording.exposure_us {
        Some(exposure_us) => format!("at an exposure of {exposure_us} us: {error}"),
        None => error.to_string(),
    };
    Failure::input(Error::format(input, reason).advise(advice))
}

fn percent(text: &str) -> Result<f64, String> {
    number::within(text, 0.0..=1000.0, "percent")
}
