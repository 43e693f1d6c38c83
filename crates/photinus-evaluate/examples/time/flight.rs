//! A seed and a fault -> the scene's frames, located and looked at with default settings -> what became of its vehicles.

use photinus::airframe::Airframe;
use photinus::camera::Camera;
use photinus::locator::{self, Input, Locator};
use photinus::lookout::{Fleet, Glance, Lookout, Vehicle};
use photinus::tracking::{self, Placed};
use photinus_io::codes::parse_codes;
use photinus_io::dataset::TruthFrame;
use photinus_sim::scene::Target;
use photinus_sim::{Scene, Simulator};
use rand_distr::{Bernoulli, Distribution};
use rand_pcg::Pcg64;

use crate::fault::{Fault, Told};
use crate::scene::{self, RATE_HZ, four, word};
use crate::score::Score;

/// Scores count from here on: three code lengths, s.
const FROM_S: f64 = 0.9;

/// Flies the scene of a seed.
pub(crate) fn fly(seed: u64, airframe: scene::Airframe, fault: &Fault) -> Score {
    let scene = four(seed, airframe, fault);
    let (camera, airframe) = (scene.cameras[0].camera.clone(), scene.targets[0].airframe.clone());
    let fleet = fleet(&scene, fault.told);
    let (mut locator, mut lookout) = observer(&camera, &airframe, Some(&fleet));
    let mut score = Score::default();
    let mut random = Pcg64::new(u128::from(seed), 0xd209);
    let is_dropped = Bernoulli::new(fault.dropped).expect("a share");
    let mut simulator = Simulator::new(&scene, 0).expect("a camera");
    for rendered in simulator.frames() {
        let (true_s, gravity) = (rendered.truth.time_s, Some(rendered.gravity));
        if is_dropped.sample(&mut random) {
            continue;
        }
        let view = rendered.image.view();
        let located =
            locator.locate(Input::frame(&view).gravity(gravity.as_ref())).expect("the camera's size");
        let back_s = fault.back.filter(|back| true_s >= back.at_s).map_or(0.0, |back| back.by_s);
        let time_s = true_s * (1.0 + fault.stamps_faster) - back_s;
        let glance = Glance { exposure_s: scene.exposure_us * 1e-6, gravity, ..Glance::new(time_s, located) };
        let looked = lookout.look(&glance).map(|tracked| tracked.placed);
        if true_s < FROM_S {
            continue;
        }
        match looked {
            Ok(placed) => {
                score.resets += usize::from(placed == Placed::Reset);
                score.late += usize::from(placed == Placed::Late);
                score.see(&lookout, &rendered.truth.neighbours);
            }
            Err(_) => score.refuse(rendered.truth.neighbours.len()),
        }
        score.end_frame();
    }
    score
}

/// What looks, with default settings.
pub(crate) fn observer(camera: &Camera, airframe: &Airframe, fleet: Option<&Fleet>) -> (Locator, Lookout) {
    let (settings, tracking) = (locator::Settings::default(), tracking::Settings::default());
    let locator = Locator::new(camera.clone(), airframe, None, settings).expect("default settings");
    let lookout = Lookout::new(camera.clone(), airframe, &settings, tracking, fleet);
    (locator, lookout.expect("default settings"))
}

/// Flies a scene in which nothing is wrong; `see` is told of each frame.
pub(crate) fn fly_well(scene: &Scene, mut see: impl FnMut(&Lookout, &TruthFrame)) {
    let (camera, airframe) = (&scene.cameras[0].camera, &scene.targets[0].airframe);
    let whose = |target: &Target| {
        Some((Vehicle { id: target.id, words: target.blink.as_ref()?.words.clone() }, RATE_HZ))
    };
    let vehicles: Vec<_> = scene.targets.iter().filter_map(whose).collect();
    let book = scene.targets[0].blink.as_ref().map(|plan| plan.codes.clone());
    let fleet = book.map(|book| Fleet::new(book, vehicles).expect("words of the book"));
    let (mut locator, mut lookout) = observer(camera, airframe, fleet.as_ref());
    let mut simulator = Simulator::new(scene, 0).expect("a camera");
    for rendered in simulator.frames() {
        let (view, gravity) = (rendered.image.view(), Some(rendered.gravity));
        let input = Input::frame(&view).gravity(gravity.as_ref());
        let located = locator.locate(input).expect("the camera's size");
        let exposure_s = scene.exposure_us * 1e-6;
        let glance = Glance { exposure_s, gravity, ..Glance::new(rendered.truth.time_s, located) };
        lookout.look(&glance).expect("times that ascend");
        see(&lookout, &rendered.truth);
    }
}

/// What the program is told of who blinks what.
fn fleet(scene: &Scene, told: Told) -> Fleet {
    let own = &scene.targets[0].blink.as_ref().expect("all blink").codes;
    let book = match told {
        Told::Right => own.clone(),
        Told::OtherLength => {
            parse_codes(include_str!("../../../../scenes/codes/l14-d3-r3.txt"), "l14").expect("a book")
        }
        Told::OtherWords => {
            parse_codes(include_str!("../../../../scenes/codes/l18-d5-r4.txt"), "l18").expect("a book")
        }
    };
    let words = book.words().len();
    let vehicles = scene.targets.iter().enumerate().map(|(number, target)| {
        let word = if told == Told::Right { word(number) } else { number % words };
        (Vehicle { id: target.id, words: vec![word] }, RATE_HZ)
    });
    Fleet::new(book, vehicles).expect("words of the book")
}
