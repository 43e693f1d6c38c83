//! A scene -> frames, located and looked at with default settings -> what became of each vehicle.

use std::time::Instant;

use nalgebra::Vector3;
use photinus::locator::{self, Input, Locator};
use photinus::lookout::{Fleet, Glance, Lookout, Vehicle};
use photinus::tracking;
use photinus_io::dataset::TruthNeighbour;
use photinus_sim::{Scene, Simulator};

use crate::scene::{Built, MOTIONS, scene};
use crate::score::Score;

/// Scores count from here on: three code lengths, s.
const FROM_S: f64 = 0.9;
/// An id is told from this probability on.
const SURE: f64 = 0.9;

/// What became of one vehicle.
pub(crate) struct Flight {
    /// Place in [`MOTIONS`].
    pub(crate) motion: usize,
    pub(crate) score: Score,
}

/// Flies the scene of a seed.
pub(crate) fn fly(seed: u64, built: Built) -> Vec<Flight> {
    let scene = scene(seed, built);
    let (camera, airframe) = (scene.cameras[0].camera.clone(), scene.targets[0].airframe.clone());
    let settings = locator::Settings::default();
    let mut locator = Locator::new(camera.clone(), &airframe, None, settings).expect("default settings");
    let fleet = fleet(&scene);
    let mut lookout = Lookout::new(camera, &airframe, &settings, tracking::Settings::default(), Some(&fleet))
        .expect("default settings");
    let mut scores = vec![Score::default(); scene.targets.len()];
    let mut simulator = Simulator::new(&scene, 0).expect("a camera");
    for rendered in simulator.frames() {
        let (time_s, gravity) = (rendered.truth.time_s, Some(rendered.gravity));
        let view = rendered.image.view();
        let located =
            locator.locate(Input::frame(&view).gravity(gravity.as_ref())).expect("the camera's size");
        let glance = Glance {
            camera: 0,
            turned_since_any: None,
            time_s,
            exposure_s: scene.exposure_us * 1e-6,
            turned: None,
            moving: None,
            gravity,
            located,
        };
        let began = Instant::now();
        lookout.look(&glance).expect("times that ascend");
        let took_s = began.elapsed().as_secs_f64();
        if time_s < FROM_S {
            continue;
        }
        for (score, target) in scores.iter_mut().zip(&scene.targets) {
            let there = rendered.truth.neighbours.iter().find(|there| there.id == target.id);
            look_at(score, &lookout, there, (seed, target.id));
            score.took_s += took_s / scene.targets.len() as f64;
        }
    }
    let motion = |number: usize| number % MOTIONS.len();
    scores.into_iter().enumerate().map(|(number, score)| Flight { motion: motion(number), score }).collect()
}

fn fleet(scene: &Scene) -> Fleet {
    let plan = |target: &photinus_sim::scene::Target| target.blink.clone().expect("all blink");
    let vehicles = scene
        .targets
        .iter()
        .map(|target| (Vehicle { id: target.id, words: plan(target).words }, plan(target).rate_hz));
    Fleet::new(plan(&scene.targets[0]).codes, vehicles).expect("words of the book")
}

/// Scores the tracks that have the id of a vehicle.
fn look_at(score: &mut Score, lookout: &Lookout, there: Option<&TruthNeighbour>, (seed, id): (u64, u32)) {
    let Some(there) = there else { return };
    let truth_m = Vector3::from(there.position_m);
    score.there += 1;
    let is_named = |track: &&tracking::Track| {
        lookout.name(track.id).is_some_and(|name| name.id == id && name.probability >= SURE)
    };
    for track in lookout.tracked().tracks.iter().filter(is_named) {
        score.tracks.insert((seed, id, track.id));
        score.see(track, &truth_m, there.velocity_m_s.map(Vector3::from).as_ref());
    }
}
