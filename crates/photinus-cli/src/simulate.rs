//! `photinus simulate`: scene -> frames with truth, as a dataset, a video, or truth alone.

use std::io::{BufWriter, Write};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};

use photinus_io::Error;
use photinus_io::dataset::TruthFrame;
use photinus_io::video::Y4mWriter;
use photinus_io::whole::{WholeFile, WholeFolder};
use photinus_sim::dataset::SceneDataset;
use photinus_sim::scene::files_of;
use photinus_sim::{Rendered, Scene, Simulator};

use crate::ending::Content;
use crate::failure::Failure;
use crate::interrupt;
use crate::number;
use crate::targets::{Targets, WriteArgs};
use crate::terminal::Terminal;
use photinus_run::fault;

const EXAMPLES: &str = "\
Examples:
  # a dataset folder with truth
  photinus simulate scenes/outdoor-flight.toml --out flight
  # a video
  photinus simulate scenes/swarm-12.toml --out swarm.y4m --frames 300
  # where everything was, no frames
  photinus simulate scenes/crossing.toml --out truth.jsonl
  photinus locate flight --out results.jsonl

A scene with several cameras gives one dataset with all of them; its frames lie
in a folder per camera.";

/// Render a scene: frames with truth
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Args {
    /// The scene, a TOML file
    #[arg(value_name = "SCENE")]
    scene: PathBuf,
    /// Where to write: a new folder, a .y4m video, or .jsonl for the truth alone
    #[arg(long, value_name = "OUT")]
    out: PathBuf,
    /// Frames to render, in place of the scene's duration
    #[arg(long, value_name = "N", value_parser = number::count)]
    frames: Option<u64>,
    /// Seed of noise, wind and LED units, in place of the scene's
    #[arg(long, value_name = "SEED")]
    seed: Option<u64>,
    /// Camera to render, where a video or truth can hold one only
    #[arg(long, value_name = "NAME")]
    camera: Option<String>,
    /// Threads; frames do not depend on their number
    #[arg(long, value_name = "N", default_value_t = processors(), value_parser = threads)]
    threads: usize,
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
}

/// More threads than this help nobody.
const MOST_THREADS: usize = 256;

pub(crate) fn processors() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from).min(MOST_THREADS)
}

pub(crate) fn threads(text: &str) -> Result<usize, String> {
    let number: Option<usize> = text.parse().ok().filter(|threads| (1..=MOST_THREADS).contains(threads));
    number.ok_or_else(|| {
        format!("give a number of threads, 1 to {MOST_THREADS}; this machine runs {} at once", processors())
    })
}

/// Where rendered frames go.
enum Sink<'a> {
    Dataset { making: WholeFolder, writer: Box<SceneDataset<'a>> },
    Video(Y4mWriter<BufWriter<WholeFile>>),
    Truth(BufWriter<WholeFile>),
}

/// Runs the command.
pub(crate) fn run(args: &Args, terminal: &mut Terminal) -> Result<(), Failure> {
    let mut scene = Scene::read(&args.scene).map_err(Failure::input)?;
    if let Some(seed) = args.seed {
        scene.set_seed(seed);
    }
    let frames = args.frames.unwrap_or(scene.frames);
    let cameras = cameras(args, &scene)?;
    let mut sink = Sink::create(args, &scene, &cameras, frames)?;
    if scene.targets.iter().any(|target| target.airframe != scene.targets[0].airframe) {
        terminal.note("the targets' airframes differ: dataset.toml names that of the first one, vehicles.toml all of them");
    }
    let started = std::time::Instant::now();
    terminal.start(Some(frames * cameras.len() as u64));
    let (mut written, mut stopped) = (0_u64, None);
    for &camera in &cameras {
        let simulator = Simulator::new(&scene, camera)
            .ok_or_else(|| Failure::Input(format!("the scene has no camera number {camera}")))?;
        let render = || {
            simulator.render(0..frames, args.threads, |rendered| {
                if interrupt::is_asked() {
                    return Err(Stopped::Asked);
                }
                sink.take(camera, &rendered, &args.out).map_err(Stopped::Failed)?;
                written += 1;
                terminal.frame_done();
                Ok(())
            })
        };
        // A thread that panics costs the frames after it, not those before.
        stopped = catch_unwind(AssertUnwindSafe(render))
            .unwrap_or_else(|payload| {
                let refused = Error::format(&args.scene, fault::told(payload.as_ref()));
                Err(Stopped::Failed(refused.advise(fault::ADVICE)))
            })
            .err();
        if stopped.is_some() {
            break;
        }
    }
    interrupt::look_away();
    terminal.finish();
    let held = format!("{}: {written} frames are in it", args.out.display());
    match stopped {
        None => sink.keep(&args.out).map_err(Failure::running)?,
        Some(Stopped::Asked) => {
            sink.keep(&args.out).map_err(Failure::running)?;
            return Err(Failure::Interrupted(format!("interrupted; {held}")));
        }
        Some(Stopped::Failed(error)) => {
            // The frames before it are a dataset of their own; half a video is not a video.
            if let (Sink::Dataset { .. }, 1..) = (&sink, written) {
                sink.keep(&args.out).map_err(Failure::running)?;
                terminal.note(held);
            }
            return Err(Failure::running(error));
        }
    }
    terminal.summary(format_args!(
        "{}: {written} frames of {} in {:.1} s, written to {}",
        args.scene.display(),
        scene.name,
        started.elapsed().as_secs_f64(),
        args.out.display()
    ));
    Ok(())
}

/// Why rendering stops before its end.
enum Stopped {
    Asked,
    Failed(Error),
}

/// Which cameras are rendered.
fn cameras(args: &Args, scene: &Scene) -> Result<Vec<usize>, Failure> {
    let names = || scene.cameras.iter().map(|camera| camera.name.as_str()).collect::<Vec<_>>().join(", ");
    if let Some(name) = &args.camera {
        let found = scene.cameras.iter().position(|camera| camera.name == *name);
        return found.map(|index| vec![index]).ok_or_else(|| {
            Failure::Input(format!(
                "{}: there is no camera `{name}`; it has {}",
                args.scene.display(),
                names()
            ))
        });
    }
    let all: Vec<usize> = (0..scene.cameras.len()).collect();
    if all.len() > 1 && extension(&args.out).is_some() {
        return Err(Failure::Input(format!(
            "{}: it can hold one camera; choose with --camera among {}",
            args.out.display(),
            names()
        )));
    }
    Ok(all)
}

fn extension(path: &Path) -> Option<&str> {
    path.extension().and_then(|end| end.to_str()).filter(|end| ["y4m", "jsonl"].contains(end))
}

impl<'a> Sink<'a> {
    /// Opens what is named, for one camera, or a dataset for all of them.
    fn create(args: &Args, scene: &'a Scene, cameras: &[usize], frames: u64) -> Result<Self, Failure> {
        let read = files_of(&args.scene).map_err(Failure::input)?;
        let mut targets = Targets::new(args.write, read);
        let mut file = |content| {
            let whole = targets.file(&args.out, content)?.whole().map_err(Failure::input)?;
            Ok(BufWriter::new(whole))
        };
        match extension(&args.out) {
            Some("y4m") => {
                let view = &scene.cameras[cameras[0]].camera;
                // a rate in thousandths: what Y4M can say of 59.9 Hz
                let rate = ((scene.rate_hz * 1000.0).round() as u32, 1000);
                let size = (view.width(), view.height());
                Y4mWriter::new(file(Content::Y4m)?, &args.out, size, rate)
                    .map(Self::Video)
                    .map_err(Failure::running)
            }
            Some(_) => Ok(Self::Truth(file(Content::JsonLines)?)),
            None => {
                let making = targets.folder(&args.out)?.whole().map_err(Failure::input)?;
                let writer = SceneDataset::create(making.path(), scene, cameras, frames);
                let writer = Box::new(writer.map_err(|error| Failure::running(making.tell(error)))?);
                Ok(Self::Dataset { making, writer })
            }
        }
    }

    fn take(&mut self, camera: usize, rendered: &Rendered, path: &Path) -> photinus_io::Result<()> {
        match self {
            Self::Dataset { making, writer } => {
                writer.add(camera, rendered).map_err(|error| making.tell(error))
            }
            Self::Video(writer) => writer.write(&rendered.image.view()),
            Self::Truth(file) => write_truth(file, &rendered.truth, path),
        }
    }

    /// What is in it is whole.
    fn keep(self, path: &Path) -> photinus_io::Result<()> {
        let file = match self {
            Self::Dataset { making, writer } => {
                drop(writer);
                return making.keep();
            }
            Self::Video(writer) => writer.finish()?,
            Self::Truth(file) => file,
        };
        file.into_inner().map_err(|error| Error::io(path, error.into_error()))?.keep()
    }
}

/// Writes a line of truth; `path` is for the messages.
///
/// # Errors
/// [`Error`] when the file cannot be written.
pub(crate) fn write_truth(file: &mut impl Write, truth: &TruthFrame, path: &Path) -> photinus_io::Result<()> {
    let line = serde_json::to_string(truth).map_err(|error| Error::format(path, error.to_string()))?;
    writeln!(file, "{line}").map_err(|error| Error::io(path, error))
}
