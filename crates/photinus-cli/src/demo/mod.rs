//! `photinus demo`: what a newcomer runs first. Nothing enters but a flight that the program carries along; it is
//! simulated, located, followed and evaluated as recordings are, and a folder to look at leaves.
//!
//! ```text
//! carried  the scenes and the files they name
//! looking  what looks at the scene
//! pace     which frames are drawn
//! told     what came out, in lines to read
//! ```

pub(crate) mod carried;
mod looking;
pub(crate) mod pace;
mod told;

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use std::time::Instant;

use nalgebra::Vector3;
use photinus_evaluate::evaluate;
use photinus_io::dataset::TruthFrame;
use photinus_io::frames::{Frame, Moved};
use photinus_io::results::{FrameRecord, ResultsWriter};
use photinus_io::whole::WholeFolder;
use photinus_io::{Error, Result};
use photinus_sim::{Rendered, Scene, Simulator};

use crate::evaluate::plots::page::with_figures;
use crate::evaluate::plots::{Drawn, plot};
use crate::failure::Failure;
use crate::overlay::{self, Overlay, Place};
use crate::page::{Moment, Page, Player, Shot, Timeline};
use crate::simulate::write_truth;
use crate::targets::{Targets, WriteArgs};
use crate::terminal::Terminal;
use carried::FOUR_OUTDOORS;
use pace::Pace;
use photinus_run::{Clock, Entry, Work};

/// Between pictures, s.
const STEP_S: f64 = 0.5;
const PICTURES: &str = "pictures";
const FIGURES: &str = "figures";

/// See it work: simulate a flight of robots that blink, locate and follow them, evaluate, and leave a page to look at
#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// Where to write: a new folder
    #[arg(long, value_name = "DIR", default_value = "photinus-demo")]
    out: PathBuf,
    /// Seconds of the flight, from its start
    #[arg(long, value_name = "S", hide = true)]
    seconds: Option<u32>,
    #[command(flatten)]
    write: WriteArgs,
}

/// What was there and what was found, frame by frame.
#[derive(Default)]
struct Flown {
    truth: Vec<TruthFrame>,
    records: Vec<FrameRecord>,
    /// Numbers and times of the frames that were drawn.
    drawn: Vec<(u64, f64)>,
}

/// Runs the command.
pub(crate) fn run(args: &Args, terminal: &mut Terminal) -> std::result::Result<(), Failure> {
    let started = Instant::now();
    let target = Targets::new(args.write, []).folder(&args.out)?;
    let making = target.whole().map_err(Failure::input)?;
    let folder = making.path();
    let mut scene =
        FOUR_OUTDOORS.unpack(&folder.join("scene")).map_err(|error| Failure::input(making.tell(error)))?;
    if let Some(seconds) = args.seconds {
        scene.frames = scene.frames.min((f64::from(seconds) * scene.rate_hz) as u64);
    }
    let broken = |error| Failure::running(making.tell(error));
    let flown = fly(&scene, &making, terminal)?;
    let mut settings = photinus_evaluate::Settings::default();
    settings.time_tolerance_s = 0.5 / scene.rate_hz;
    let evaluation = evaluate(&flown.truth, &flown.records, &settings)
        .map_err(|error| Failure::Running(error.to_string()))?;
    let figures = made(folder.join(FIGURES)).map_err(broken)?;
    let drawn = plot(&figures, &evaluation, &flown.truth).map_err(broken)?;
    let told = told::lines(&scene, &evaluation.scores);
    page(&scene, &flown, &told, &drawn).write(folder).map_err(broken)?;
    making.keep().map_err(Failure::running)?;
    let out = args.out.display();
    terminal.result(told)?;
    terminal.result(format_args!(
        "Done in {:.0} s. Open {out}/index.html in a browser: the flight as it was seen, distances over time, and how good they are.\n\
         {out}/{FIGURES} holds the figures, PNG and SVG; results.jsonl and truth.jsonl every number.",
        started.elapsed().as_secs_f64()
    ))
}

/// Pictures with a timeline, what came out, and every figure, on a page.
fn page(scene: &Scene, flown: &Flown, told: &str, figures: &[Drawn]) -> Page {
    let shots = flown
        .drawn
        .iter()
        .map(|&(frame, time_s)| Shot { file: format!("{PICTURES}/{}", overlay::numbered(frame)), time_s });
    let timelines = scene.targets.iter().map(|target| Timeline {
        title: format!("Distance of vehicle {}", target.id),
        moments: moments(flown, target.id),
    });
    let player = Player {
        caption: "Left: the frame, brightened, with what was found in it. Right: the same from above: where each vehicle is by its track, with its tail and \
                  where it goes, also while its LEDs are dark or hidden; of a single frame the strict bounds as a bar, the estimate as a disc. Two pictures \
                  a second."
            .to_owned(),
        shots: shots.collect(),
        timelines: timelines.collect(),
    };
    let page = Page::new("A flight among robots that blink").lines(told).player(&player);
    let page = with_figures(page.heading("Every frame beside ground truth"), &format!("{FIGURES}/"), figures);
    let scene = format!("scene/{}", FOUR_OUTDOORS.scene);
    page.heading("Files").links(&[
        ("results.jsonl", "what was found, a line per frame"),
        ("truth.jsonl", "where everything was, a line per frame"),
        (scene.as_str(), "the flight: change it, and run `photinus simulate` with it"),
        (FIGURES, "the figures, PNG and SVG"),
    ])
}

/// Truth, estimate and bounds of a vehicle, frame by frame, as it is called: a wrong name shows.
fn moments(flown: &Flown, id: u32) -> Vec<Moment> {
    let frames = flown.truth.iter().zip(&flown.records);
    let moment = |(truth, record): (&TruthFrame, &FrameRecord)| {
        let there = truth.neighbours.iter().find(|neighbour| neighbour.id == id)?;
        let followed = record.tracks.iter().find(|track| track.id == Some(id));
        let found = record.neighbours.iter().find(|neighbour| neighbour.id == Some(id));
        Some(Moment {
            time_s: truth.time_s,
            truth_m: there.distance_m,
            estimate_m: followed.map(|track| Vector3::from(track.position_m).norm()),
            bounds_m: found.map(|found| (found.distance_m.min, found.distance_m.max)),
        })
    };
    frames.filter_map(moment).collect()
}

/// A folder, made.
fn made(folder: PathBuf) -> Result<PathBuf> {
    std::fs::create_dir_all(&folder).map_err(|error| Error::io(&folder, error))?;
    Ok(folder)
}

/// Renders, locates and follows, writes truth and results, and draws a choice of frames.
fn fly(scene: &Scene, making: &WholeFolder, terminal: &mut Terminal) -> std::result::Result<Flown, Failure> {
    let (out, broken) = (making.path(), |error| Failure::running(making.tell(error)));
    let mut view = looking::of(scene)?;
    let simulator =
        Simulator::new(scene, 0).ok_or_else(|| Failure::Running("the scene has no camera".to_owned()))?;
    let pictures = made(out.join(PICTURES)).map_err(broken)?;
    let mut overlay = Overlay::new(Place::folder(pictures), vec![view.camera.clone()]).map_err(broken)?;
    let (truth_path, results_path) = (out.join("truth.jsonl"), out.join("results.jsonl"));
    let create = |path: &Path| File::create_new(path).map_err(|error| broken(Error::io(path, error)));
    let mut truth_file = BufWriter::new(create(&truth_path)?);
    let mut results = ResultsWriter::new(create(&results_path)?, &results_path);

    let (mut flown, mut pace, mut clock) = (Flown::default(), Pace::every(STEP_S), Clock::new());
    terminal.start(Some(scene.frames));
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let take = |rendered: Rendered| -> Result<()> {
        let (truth, mut entry) = apart(rendered);
        view.fill(&mut entry, &mut clock)?;
        write_truth(&mut truth_file, &truth, &truth_path)?;
        results.write(&entry.record)?;
        if pace.is_due(truth.time_s) {
            let image = entry.image.as_ref().map(|image| image.view());
            overlay.draw(0, &entry.record, image, entry.gravity.as_ref(), &[])?;
            flown.drawn.push((truth.frame, truth.time_s));
        } else {
            overlay.pass(0, &entry.record);
        }
        flown.truth.push(truth);
        flown.records.push(entry.record);
        terminal.frame_done();
        Ok(())
    };
    simulator.render(0..scene.frames, threads, take).map_err(broken)?;
    truth_file.flush().map_err(|error| broken(Error::io(&truth_path, error)))?;
    terminal.finish();
    Ok(flown)
}

/// What was there, and what a locator is given.
pub(crate) fn apart(rendered: Rendered) -> (TruthFrame, Entry) {
    let Rendered { image, truth, gravity } = rendered;
    let frame = Frame {
        index: truth.frame,
        time_s: Some(truth.time_s),
        source: "simulated".to_owned(),
        image,
        gravity: Some(gravity),
        exposure_s: None,
        moved: Moved::default(),
        conversions: Vec::new(),
    };
    (truth, Entry::from_frame(frame))
}
