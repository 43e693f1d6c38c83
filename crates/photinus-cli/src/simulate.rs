//! `photinus simulate`: scene -> frames with truth, as a dataset, a video, or truth alone.

use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

use photinus_io::Error;
use photinus_io::dataset::TruthFrame;
use photinus_io::video::Y4mWriter;
use photinus_io::whole::{WholeFile, WholeFolder};
use photinus_sim::{Rendered, Scene, Simulator, dataset};

use crate::failure::Failure;
use crate::interrupt;
use crate::targets::{FileTarget, Targets, WriteArgs};
use crate::terminal::Terminal;

const EXAMPLES: &str = "\
Examples:
  photinus simulate scenes/outdoor-flight.toml --out flight            a dataset folder with truth
  photinus simulate scenes/swarm-12.toml --out swarm.y4m --frames 300  a video
  photinus simulate scenes/crossing.toml --out truth.jsonl             where everything was, no frames
  photinus locate flight --out results.jsonl

A scene with several cameras gives a folder per camera inside the one that is named.";

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
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
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

fn processors() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from).min(MOST_THREADS)
}

fn threads(text: &str) -> Result<usize, String> {
    let number: Option<usize> = text.parse().ok().filter(|threads| (1..=MOST_THREADS).contains(threads));
    number.ok_or_else(|| {
        format!("give a number of threads, 1 to {MOST_THREADS}; this machine runs {} at once", processors())
    })
}

/// Where rendered frames go.
enum Sink {
    Dataset(photinus_io::dataset::DatasetWriter),
    Video(Y4mWriter<BufWriter<WholeFile>>),
    Truth(BufWriter<WholeFile>),
}

/// What is made: a folder of datasets, or one file.
enum Making {
    Folder(WholeFolder),
    File(FileTarget),
}

/// Runs the command.
pub(crate) fn run(args: &Args, terminal: &mut Terminal) -> Result<(), Failure> {
    let mut scene = Scene::read(&args.scene).map_err(Failure::input)?;
    if let Some(seed) = args.seed {
        scene.set_seed(seed);
    }
    let frames = args.frames.unwrap_or(scene.frames);
    let cameras = cameras(args, &scene)?;
    let making = Making::new(args)?;
    let mut sinks = Vec::new();
    for &camera in &cameras {
        sinks.push((camera, making.sink(&scene, camera, cameras.len() > 1)?));
    }
    if scene.targets.iter().any(|target| target.airframe != scene.targets[0].airframe) {
        terminal.note("the targets' airframes differ; the dataset names that of the first one");
    }
    let started = std::time::Instant::now();
    terminal.start(Some(frames * cameras.len() as u64));
    let mut written = 0;
    for (camera, mut sink) in sinks {
        let simulator = Simulator::new(&scene, camera)
            .ok_or_else(|| Failure::Input(format!("the scene has no camera number {camera}")))?;
        let rendered = simulator.render(0..frames, args.threads, |rendered| {
            if interrupt::is_asked() {
                return Err(Stopped::Asked);
            }
            sink.take(&rendered, &args.out).map_err(|error| Stopped::Failed(making.tell(error)))?;
            written += 1;
            terminal.frame_done();
            Ok(())
        });
        match rendered {
            Ok(()) | Err(Stopped::Asked) => sink.finish(&args.out),
            // The frames before it are a dataset of their own; half a video is none.
            Err(Stopped::Failed(error)) => {
                drop(sink);
                if let (Making::Folder(folder), 1..) = (making, written) {
                    folder.keep().map_err(Failure::running)?;
                    terminal.note(format_args!("{}: {written} frames are in it", args.out.display()));
                }
                return Err(Failure::running(error));
            }
        }
        .map_err(Failure::running)?;
    }
    interrupt::look_away();
    terminal.finish();
    making.keep().map_err(Failure::running)?;
    if interrupt::is_asked() {
        let told = format!("interrupted after {written} frames; {} holds them", args.out.display());
        return Err(Failure::Interrupted(told));
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

impl Making {
    fn new(args: &Args) -> Result<Self, Failure> {
        let mut targets = Targets::new(args.write, [args.scene.clone()]);
        Ok(match extension(&args.out) {
            Some(_) => Self::File(targets.file(&args.out)?),
            None => Self::Folder(targets.folder(&args.out)?.whole().map_err(Failure::input)?),
        })
    }

    fn sink(&self, scene: &Scene, camera: usize, several: bool) -> Result<Sink, Failure> {
        match self {
            Self::Folder(folder) => {
                let path = match several {
                    true => folder.path().join(&scene.cameras[camera].name),
                    false => folder.path().to_owned(),
                };
                let created = dataset::create(path, scene, camera);
                created.map(Sink::Dataset).map_err(|error| Failure::input(folder.tell(error)))
            }
            Self::File(target) => {
                let file = BufWriter::new(target.whole().map_err(Failure::input)?);
                if extension(target.path()) != Some("y4m") {
                    return Ok(Sink::Truth(file));
                }
                let view = &scene.cameras[camera].camera;
                // a rate in thousandths: what Y4M can say of 59.9 Hz
                let rate = ((scene.rate_hz * 1000.0).round() as u32, 1000);
                let size = (view.width(), view.height());
                Y4mWriter::new(file, target.path(), size, rate).map(Sink::Video).map_err(Failure::running)
            }
        }
    }

    fn tell(&self, error: Error) -> Error {
        match self {
            Self::Folder(folder) => folder.tell(error),
            Self::File(_) => error,
        }
    }

    /// What was made is whole.
    fn keep(self) -> photinus_io::Result<()> {
        match self {
            Self::Folder(folder) => folder.keep(),
            Self::File(_) => Ok(()),
        }
    }
}

impl Sink {
    fn take(&mut self, rendered: &Rendered, path: &Path) -> photinus_io::Result<()> {
        match self {
            Self::Dataset(writer) => dataset::add(writer, rendered),
            Self::Video(writer) => writer.write(&rendered.image.view()),
            Self::Truth(file) => write_truth(file, &rendered.truth, path),
        }
    }

    /// All frames are in it.
    fn finish(self, path: &Path) -> photinus_io::Result<()> {
        let file = match self {
            Self::Dataset(_) => return Ok(()),
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
