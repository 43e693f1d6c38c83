//! Figure 17: frames of the flight with what was found in them, and the same from above, with truth as a square.

use nalgebra::Vector3;
use photinus::locator::{Locator, Settings};
use photinus_io::Error;
use photinus_io::whole::WholeFolder;
use photinus_reproduce::Effort;
use photinus_sim::{Scene, Simulator};

use crate::demo::apart;
use crate::demo::pace::Pace;
use crate::failure::Failure;
use crate::overlay::{self, Overlay, Place};
use crate::page::{Player, Shot};
use crate::terminal::Terminal;
use photinus_run::Clock;

const PICTURES: &str = "figure-17";
/// Between pictures, s.
const STEP_S: f64 = 1.0;
/// Pictures of a quick run.
const QUICK: usize = 4;

/// Numbers of the frames that are drawn.
pub(super) fn numbers(scene: &Scene, effort: Effort) -> Vec<u64> {
    let mut pace = Pace::every(STEP_S);
    let due = (0..scene.frames).filter(|&number| pace.is_due(number as f64 / scene.rate_hz));
    match effort {
        Effort::Full => due.collect(),
        Effort::Quick => due.take(QUICK).collect(),
    }
}

/// Draws the frames, and gives what plays them.
pub(super) fn save(
    making: &WholeFolder,
    scene: &Scene,
    numbers: &[u64],
    terminal: &Terminal,
) -> Result<Player, Failure> {
    let (folder, broken) = (making.path(), |error| Failure::running(making.tell(error)));
    let lacks = || Failure::Running("the scene has no camera or no target".to_owned());
    let mut simulator = Simulator::new(scene, 0).ok_or_else(lacks)?;
    let airframe = &scene.targets.first().ok_or_else(lacks)?.airframe;
    let camera = scene.cameras[0].camera.clone();
    let pictures = folder.join(PICTURES);
    std::fs::create_dir_all(&pictures).map_err(|error| broken(Error::io(&pictures, error)))?;
    let mut overlay = Overlay::new(Place::folder(pictures), vec![camera.clone()]).map_err(broken)?;
    let mut locator = Locator::new(camera, airframe, None, Settings::default())
        .map_err(|error| Failure::Running(error.to_string()))?;
    let mut clock = Clock::new();
    let mut player = Player {
        caption: "Left: the frame, brightened. Right: the same from above: the strict bounds as a bar, the estimate as a disc, truth \
                  as a square. Each frame by itself, no radio, no track; one picture a second."
            .to_owned(),
        shots: Vec::new(),
        timelines: Vec::new(),
    };
    for &number in numbers {
        let (truth, mut entry) = apart(simulator.frame(number));
        photinus_run::locate(&mut entry, &mut locator, &[airframe.name()], &mut clock).map_err(broken)?;
        let places_m: Vec<Vector3<f64>> =
            truth.neighbours.iter().map(|neighbour| Vector3::from(neighbour.position_m)).collect();
        let image = entry.image.as_ref().map(|image| image.view());
        overlay.draw(0, &entry.record, image, entry.gravity.as_ref(), &places_m).map_err(broken)?;
        player
            .shots
            .push(Shot { file: format!("{PICTURES}/{}", overlay::numbered(number)), time_s: truth.time_s });
        terminal.frame_done();
    }
    Ok(player)
}
