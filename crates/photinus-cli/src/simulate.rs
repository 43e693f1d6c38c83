//! `photinus simulate`: scene -> frames with truth, as a dataset, a video, or truth alone.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

use photinus_io::Error;
use photinus_io::dataset::TruthFrame;
use photinus_io::video::Y4mWriter;
use photinus_sim::dataset::SceneDataset;
use photinus_sim::{Rendered, Scene, Simulator};

use crate::failure::Failure;
use crate::terminal::Terminal;

const EXAMPLES: &str = "\
Examples:
  photinus simulate scenes/outdoor-flight.toml --out flight            a dataset folder with truth
  photinus simulate scenes/swarm-12.toml --out swarm.y4m --frames 300  a video
  photinus simulate scenes/crossing.toml --out truth.jsonl             where everything was, no frames
  photinus locate flight --out results.jsonl

A scene with several cameras gives one dataset with all of them; its frames lie in a folder per camera.";

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
    #[arg(long, value_name = "N")]
    frames: Option<u64>,
    /// Seed of noise, wind and LED units, in place of the scene's
    #[arg(long, value_name = "SEED")]
    seed: Option<u64>,
    /// Camera to render, where a video or truth can hold one only
    #[arg(long, value_name = "NAME")]
    camera: Option<String>,
    /// Threads; frames do not depend on their number
    #[arg(long, value_name = "N", default_value_t = std::thread::available_parallelism().map_or(1, usize::from))]
    threads: usize,
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

/// Where rendered frames go.
enum Sink<'a> {
    Dataset(Box<SceneDataset<'a>>),
    Video(Y4mWriter<BufWriter<File>>),
    Truth(BufWriter<File>),
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
    for &camera in &cameras {
        let simulator = Simulator::new(&scene, camera)
            .ok_or_else(|| Failure::Input(format!("the scene has no camera number {camera}")))?;
        simulator
            .render(0..frames, args.threads, |rendered| {
                sink.take(camera, &rendered, &args.out)?;
                terminal.frame_done();
                Ok(())
            })
            .map_err(Failure::running)?;
    }
    sink.finish(&args.out).map_err(Failure::running)?;
    terminal.finish();
    let (count, seconds) = (frames * cameras.len() as u64, started.elapsed().as_secs_f64());
    terminal.summary(format_args!(
        "{}: {count} frames of {} in {seconds:.1} s, written to {}",
        args.scene.display(),
        scene.name,
        args.out.display()
    ));
    Ok(())
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
        let file = || {
            let created = File::create_new(&args.out).map_err(|error| Error::io(&args.out, error));
            created.map(BufWriter::new).map_err(Failure::input)
        };
        match extension(&args.out) {
            Some("y4m") => {
                let view = &scene.cameras[cameras[0]].camera;
                // a rate in thousandths: what Y4M can say of 59.9 Hz
                let rate = ((scene.rate_hz * 1000.0).round() as u32, 1000);
                let size = (view.width(), view.height());
                Y4mWriter::new(file()?, &args.out, size, rate).map(Self::Video).map_err(Failure::running)
            }
            Some(_) => Ok(Self::Truth(file()?)),
            None => SceneDataset::create(&args.out, scene, cameras, frames)
                .map(|dataset| Self::Dataset(Box::new(dataset)))
                .map_err(Failure::input),
        }
    }

    fn take(&mut self, camera: usize, rendered: &Rendered, path: &Path) -> photinus_io::Result<()> {
        match self {
            Self::Dataset(dataset) => dataset.add(camera, rendered),
            Self::Video(writer) => writer.write(&rendered.image.view()),
            Self::Truth(file) => write_truth(file, &rendered.truth, path),
        }
    }

    fn finish(self, path: &Path) -> photinus_io::Result<()> {
        match self {
            Self::Dataset(_) => Ok(()),
            Self::Video(writer) => writer.finish().map(|_| ()),
            Self::Truth(mut file) => file.flush().map_err(|error| Error::io(path, error)),
        }
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
