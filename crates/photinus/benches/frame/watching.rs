//! Locating with time: vehicles that hover and blink, each frame located, its markers followed and decoded, its vehicles tracked and named.

use std::hint::black_box;

use nalgebra::{Rotation3, Vector3};
use photinus::airframe::{Airframe, Led, Ring};
use photinus::camera::Camera;
use photinus::frame::FrameView;
use photinus::identity::{CodeBook, Word};
use photinus::locator::{self, Input, Locator};
use photinus::lookout::{Fleet, Glance, Lookout, Vehicle};
use photinus::tracking::{self, Turned};
use rand_pcg::Pcg64;

use crate::contest::Contest;
use crate::decoding;
use crate::frames::{self, PAPER};

/// Frames after which words and frames are the same again: their bits.
const PERIOD: usize = 18;
const RATE_HZ: f64 = 60.0;
/// Frames until everybody is known.
const WARM: usize = 120;

/// Vehicles that blink, and what watches them.
struct Watch {
    frames: Vec<Vec<u8>>,
    locator: Locator,
    lookout: Option<Lookout>,
    frame: usize,
}

impl Watch {
    /// So many vehicles of an airframe that blinks so many signals; `with_time` says whether anybody follows them.
    fn new(count: usize, airframe: &Airframe, signals: usize, with_time: bool) -> Self {
        let (camera, words) = (crate::camera(), decoding::many_words());
        let locator = Locator::new(camera.clone(), airframe, None, locator::Settings::default());
        let lookout = with_time.then(|| lookout(&camera, airframe, count, signals, &words));
        let frames = (0..PERIOD).map(|frame| blinking(count, &camera, airframe, signals, &words, frame));
        let frames = frames.collect();
        let mut watch = Self { frames, locator: locator.expect("a locator"), lookout, frame: 0 };
        (0..WARM).for_each(|_| watch.look());
        if let Some(lookout) = &watch.lookout {
            let tracks = &lookout.tracked().tracks;
            let known = tracks
                .iter()
                .filter(|track| lookout.name(track.id).is_some_and(|name| name.probability > 0.99));
            println!("{count} {}s: {} tracks, {} known", airframe.name(), tracks.len(), known.count());
        }
        watch
    }

    fn look(&mut self) {
        self.frame += 1;
        let frame = &self.frames[self.frame % PERIOD];
        let frame = FrameView::packed(frame, PAPER.width, PAPER.height).expect("a frame");
        let gravity = Vector3::y_axis();
        let located = self.locator.locate(Input::frame(&frame).gravity(Some(&gravity)));
        let located = located.expect("the camera's size");
        let Some(lookout) = &mut self.lookout else {
            black_box(located);
            return;
        };
        let turned = Some(Turned { now_from_before: Rotation3::identity(), sigma_rad: 1e-4 });
        let time_s = self.frame as f64 / RATE_HZ;
        let glance = Glance { turned, gravity: Some(gravity), ..Glance::new(time_s, located) };
        black_box(lookout.look(&glance).expect("time passes"));
    }
}

/// The word of a signal of a vehicle.
fn word(vehicle: usize, signals: usize, signal: usize) -> usize {
    vehicle * signals + signal
}

fn lookout(camera: &Camera, airframe: &Airframe, count: usize, signals: usize, words: &[Word]) -> Lookout {
    let vehicle = |of: usize| Vehicle {
        id: of as u32,
        words: (0..signals).map(|signal| word(of, signals, signal)).collect(),
    };
    let book = CodeBook::new(words.to_vec()).expect("a book");
    let fleet = Fleet::new(book, (0..count).map(|of| (vehicle(of), RATE_HZ))).expect("a fleet");
    let (settings, tracking) = (locator::Settings::default(), tracking::Settings::default());
    Lookout::new(camera.clone(), airframe, &settings, tracking, Some(&fleet)).expect("a lookout")
}

/// A frame of vehicles that hover where they are in every frame.
fn blinking(
    count: usize,
    camera: &Camera,
    airframe: &Airframe,
    signals: usize,
    words: &[Word],
    frame: usize,
) -> Vec<u8> {
    let is_lit = |vehicle: usize, marker: usize| {
        let led = airframe.markers()[marker].leds[0];
        let signal = airframe.leds()[led].signal.unwrap_or(0) as usize;
        words[word(vehicle, signals, signal)].bit(frame + 5 * vehicle)
    };
    frames::vehicles(count, camera, airframe, &mut Pcg64::new(3, 9), is_lit)
}

/// Four arms with two LEDs each, each arm with a signal of its own.
fn quadrotor() -> Airframe {
    let ring = Ring { arms: 4, radius_m: 0.245, leds_per_arm: 2, splay_rad: std::f64::consts::FRAC_PI_2 };
    let ring = Airframe::from_ring("quadrotor", ring).expect("a quadrotor");
    let leds = ring.leds().iter().enumerate();
    let leds = leds.map(|(led, seen)| Led { signal: Some(led as u32 / 2), ..seen.clone() }).collect();
    Airframe::new(ring.name(), leds).expect("a quadrotor")
}

pub(crate) fn run() {
    let mut contest = Contest::beside_maximum("Locating with time, 752x480");
    for (airframe, signals) in [(crate::hexarotor(), 1), (quadrotor(), 4)] {
        for count in [1, 6, 12] {
            for (time, with_time) in [("", false), (", time", true)] {
                let mut watch = Watch::new(count, &airframe, signals, with_time);
                let words = if signals == 1 { "1 word" } else { "4 words" };
                contest.add(&format!("{count} of {words}{time}"), move |_| watch.look());
            }
        }
    }
    contest.run();
}
