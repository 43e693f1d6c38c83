//! Markers that blink are followed through their dark frames, turns, drops, clutter and crossings, against a simulator of its own.
//!
//! The table of docs/identity.md: `cargo test --release -p photinus --test following -- --ignored --nocapture table`.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]
#![allow(clippy::disallowed_methods, reason = "the simulator is no part of what must be the same everywhere")]
#![allow(clippy::print_stdout, reason = "a table is printed")]
#![allow(unreachable_pub, reason = "modules of one test")]

mod any;
#[path = "../hash/mod.rs"]
mod hash;
mod order;
mod plain;
mod same;
mod score;
mod table;
mod world;

use nalgebra::{Rotation3, Vector3};
use photinus::camera::Watched;
use photinus::following::{Follower, Frame, MarkerTrack, Settings, Turn};
use photinus::identity::CodeBook;
use photinus::identity::decoder::{self, Decoder, Who};
use photinus::locator::Sighting;
use photinus::pose::LogLight;
use score::{Followed, Nees, Score, nearest};
use world::{DEGREE, EXPOSURE_S, FAINTEST, GYRO_RAD_S, Marker, Swing, World, camera, detection_limit, words};

fn follower(acceleration_rad2_s3: f64) -> Follower {
    let decoder = Decoder::new(&CodeBook::new(words()).unwrap(), decoder::Settings::default()).unwrap();
    let mut settings = Settings::default();
    settings.acceleration_rad2_s3 = acceleration_rad2_s3;
    Follower::new(&camera(), Some(decoder), settings).unwrap()
}

/// The frame of a world that shows these sightings.
fn frame<'a>(world: &'a World, sightings: &'a [Sighting], turn: Option<Turn>) -> Frame<'a> {
    Frame {
        time_s: world.time_s,
        exposure_s: EXPOSURE_S,
        sightings,
        detection_limit: detection_limit(),
        turn,
        watched: Watched::new(&world.camera, None),
    }
}

/// Follows a frame.
fn follow<'a>(
    follower: &'a mut Follower,
    world: &World,
    sightings: &[Sighting],
    turn: Option<Turn>,
) -> &'a [MarkerTrack] {
    follower.follow(&frame(world, sightings, turn)).unwrap()
}

/// The next frame, with a gyro or without.
fn next<'a>(world: &mut World, follower: &'a mut Follower, has_gyro: bool) -> &'a [MarkerTrack] {
    let sightings = world.next();
    let turn = has_gyro.then(|| world.turned(GYRO_RAD_S));
    follow(follower, world, &sightings, turn)
}

/// How likely a marker that always shone does in a frame that does not show it, where its light, half over the limit, is so far from sure to be found.
fn lit_unseen(limit_sigma: f64) -> f64 {
    let mut world = World::new(3, 1);
    world.markers[0] = Marker { word: None, light: 1.5 * FAINTEST, ..world.markers[0].clone() };
    let mut follower = follower(world.acceleration);
    for number in 0..61 {
        let mut sightings = world.next();
        if number == 60 {
            sightings.clear();
        }
        let limit = detection_limit().map(|limit| LogLight { sigma: limit_sigma, ..limit });
        follower.follow(&Frame { detection_limit: limit, ..frame(&world, &sightings, None) }).unwrap();
    }
    follower.tracks().iter().map(|track| track.lit).fold(0.0, f64::max)
}

#[test]
fn what_is_not_surely_found_may_shine_unseen() {
    let [sharp, blunt] = [0.1, 0.6].map(lit_unseen);
    assert!(sharp < 0.5 * blunt && blunt > 0.1, "{sharp} {blunt}");
}

/// What six seconds showed of markers that were all followed.
#[derive(Debug, Default)]
struct Outcome {
    /// Of bearing and rate.
    nees: Nees,
    /// Markers that were in the image for long.
    markers: usize,
    /// Those that the decoder is sure of, and those of them that it is wrong about.
    decided: usize,
    wrong: usize,
}

/// In each of these worlds, for six seconds: nobody is lost, nobody changes.
fn all_are_followed(seeds: std::ops::Range<u64>, has_gyro: bool, change: impl Fn(&mut World)) -> Outcome {
    let mut outcome = Outcome::default();
    for seed in seeds {
        let mut world = World::new(seed, 20);
        change(&mut world);
        let mut follower = follower(world.acceleration);
        let mut score = Score::default();
        for _ in 0..360 {
            let tracks = next(&mut world, &mut follower, has_gyro);
            score.add(&world, &tracks.iter().map(Followed::from).collect::<Vec<_>>());
            for index in 0..world.markers.len() {
                if let Some(track) = tracks.iter().find(|track| score.own(index) == Some(track.number)) {
                    outcome.nees.add(track, world.truth(index));
                }
            }
        }
        assert_eq!((score.lost, score.switches), (0, 0), "{seed} {score:?}");
        assert!(score.markers > 9 * score.frames, "{seed} {score:?}");
        for index in (0..world.markers.len()).filter(|&index| score.is_settled_for(index, 150)) {
            let own = follower.tracks().iter().find(|track| score.own(index) == Some(track.number));
            let identity = own.unwrap().identity.unwrap();
            let is_right = Some(identity.who) == world.markers[index].word.map(Who::Word);
            let is_sure = identity.probability > 0.99;
            outcome.markers += 1;
            outcome.decided += usize::from(is_sure);
            outcome.wrong += usize::from(is_sure && !is_right);
        }
    }
    outcome
}

impl Outcome {
    fn check(&self, bearing: std::ops::Range<f64>, rate: std::ops::Range<f64>) {
        let [of_bearing, of_rate] = self.nees.means();
        assert!(bearing.contains(&of_bearing) && rate.contains(&of_rate), "{of_bearing} {of_rate}");
        // the decoder's own rates
        assert!(20 * self.decided > 18 * self.markers && 50 * self.wrong <= self.markers, "{self:?}");
    }
}

#[test]
fn a_still_camera_loses_nobody_and_knows_how_sure_it_is() {
    all_are_followed(0..5, true, |_| ()).check(1.85..2.15, 1.75..2.15);
}

#[test]
fn turns_of_150_degrees_per_second_with_a_gyro() {
    let swing = Swing { amplitude_rad: 20.0 * DEGREE, most_rad_s: 150.0 * DEGREE };
    all_are_followed(10..15, true, |world| world.swing = Some(swing)).check(1.8..2.15, 1.7..2.15);
}

/// What all rates have in common is told apart from the observer's turn by nothing, and said to be unsure.
#[test]
fn turns_of_40_degrees_per_second_without_a_gyro() {
    let swing = Swing { amplitude_rad: 15.0 * DEGREE, most_rad_s: 40.0 * DEGREE };
    all_are_followed(20..25, false, |world| world.swing = Some(swing)).check(1.7..2.15, 1.1..2.15);
}

#[test]
fn frames_are_dropped() {
    all_are_followed(30..35, true, |world| world.dropped = 0.3).check(1.8..2.15, 1.7..2.15);
}

#[test]
fn clutter_is_not_followed() {
    all_are_followed(40..45, true, |world| world.clutter = 20).check(1.8..2.15, 1.7..2.15);
}

/// Two markers on great circles that cross, at any angle and speed, as near as they come to each other; the camera is still.
fn crossing(seed: u64, is_steady: bool) -> World {
    let mut world = World::new(seed, 0);
    world.acceleration = 1e-3;
    let speed = world.between(0.15, 0.5);
    let angle = world.between(0.3, std::f64::consts::PI);
    for (number, course) in [0.0, angle].into_iter().enumerate() {
        let speed = speed * world.between(0.7, 1.3);
        let side = Vector3::new(course.cos(), course.sin(), 0.0);
        // both are straight ahead 2 s after the beginning, give or take a pixel
        let miss = Vector3::from_fn(|row, _| if row < 2 { 0.002 * world.normal() } else { 0.0 });
        let turn = Rotation3::new(Vector3::z().cross(&side) * (-2.0 * speed));
        let marker = world.marker(Vector3::z());
        world.markers.push(Marker {
            ahead: turn * (Vector3::z() + miss).normalize(),
            rate_rad_s: turn * side * speed,
            word: (!is_steady).then_some(number),
            ..marker
        });
    }
    world
}

/// Who follows the two.
fn pair(world: &World, tracks: &[Followed]) -> [Option<u64>; 2] {
    [0, 1].map(|index| nearest(tracks, &world.truth(index).0).map(|track| track.number))
}

/// Frames before and after a crossing.
const BEFORE: usize = 90;
const AFTER: usize = 240;

#[test]
fn crossings_change_nobody() {
    for is_steady in [false, true] {
        for seed in 100..140 {
            let mut world = crossing(seed, is_steady);
            let mut follower = follower(0.02);
            let mut before = [None; 2];
            for frame in 1..=AFTER {
                let tracks = next(&mut world, &mut follower, true);
                let tracks: Vec<Followed> = tracks.iter().map(Followed::from).collect();
                if frame == BEFORE {
                    before = pair(&world, &tracks);
                    assert!(before[0].is_some() && before[0] != before[1], "{seed} {before:?}");
                }
            }
            let tracks: Vec<Followed> = follower.tracks().iter().map(Followed::from).collect();
            assert_eq!(pair(&world, &tracks), before, "{seed}, steady: {is_steady}");
        }
    }
}

/// A marker that comes is followed within a few of its lit frames; one that goes is said to be gone, and its number is not used again.
#[test]
fn markers_come_and_go() {
    let mut world = World::new(50, 8);
    world.markers[0].from_to_s = [2.0, 4.0];
    world.markers[1].from_to_s = [0.0, 3.0];
    let mut follower = follower(world.acceleration);
    let (mut first_s, mut last_s, mut last) = (None, [0.0; 2], [None; 2]);
    while world.time_s < 8.0 {
        next(&mut world, &mut follower, true);
        for index in 0..2 {
            let there: Vec<Followed> =
                follower.tracks().iter().map(Followed::from).filter(|track| track.is_there).collect();
            if let Some(track) = nearest(&there, &world.truth(index).0) {
                last_s[index] = world.time_s;
                last[index] = Some(track.number);
                if index == 0 {
                    first_s.get_or_insert(world.time_s);
                }
            }
        }
    }
    assert!((2.0..2.3).contains(&first_s.unwrap()), "{first_s:?}");
    assert!((4.0..5.5).contains(&last_s[0]) && (3.0..4.5).contains(&last_s[1]), "{last_s:?}");
    assert!(follower.tracks().iter().all(|track| !last.contains(&Some(track.number))), "{last:?}");
}

/// A marker that the camera turns away from is not held to be gone at once.
#[test]
fn markers_beyond_the_border_come_back() {
    let mut world = World::new(51, 0);
    let marker = world.marker(Rotation3::new(Vector3::new(0.0, 1.2, 0.0)) * Vector3::z());
    world.acceleration = 1e-5;
    world.markers.push(Marker { rate_rad_s: Vector3::zeros(), ..marker });
    // for 0.3 s of each 2 s it is out of the image
    world.swing = Some(Swing { amplitude_rad: 13.0 * DEGREE, most_rad_s: 40.0 * DEGREE });
    let mut follower = follower(1e-3);
    let mut numbers = std::collections::BTreeSet::new();
    let mut outside = 0;
    for _ in 0..360 {
        let tracks = next(&mut world, &mut follower, true);
        numbers.extend(tracks.iter().map(|track| track.number));
        outside += usize::from(!world.is_there(0));
    }
    assert!(outside > 20, "{outside}");
    assert_eq!(numbers.len(), 1, "{numbers:?}");
}

/// The sightings of a frame are a set, and a follower that begins again is a new one but for its numbers.
#[test]
fn frames_are_replayed_to_the_bit() {
    let run = |mut follower: Follower| {
        let mut world = World::new(60, 20);
        (world.clutter, world.dropped) = (10, 0.1);
        for _ in 0..120 {
            next(&mut world, &mut follower, false);
        }
        follower
    };
    let first = run(follower(0.02));
    assert!(first.tracks().len() > 15);
    assert_eq!(first.tracks(), run(follower(0.02)).tracks());
    let mut again = run(follower(0.02));
    again.restart();
    assert!(again.tracks().is_empty());
    let numberless = |follower: &Follower| {
        let strip = |track: &MarkerTrack| MarkerTrack { number: 0, ..*track };
        follower.tracks().iter().map(strip).collect::<Vec<_>>()
    };
    assert_eq!(numberless(&first), numberless(&run(again)));
}

#[test]
fn times_that_stand_change_nothing() {
    let mut world = World::new(61, 5);
    let mut follower = follower(0.02);
    for _ in 0..60 {
        next(&mut world, &mut follower, true);
    }
    let before = follower.tracks().to_vec();
    let now_s = world.time_s;
    let sightings = world.next();
    for time_s in [now_s, now_s - 1.0, f64::NAN, f64::INFINITY] {
        let camera = camera();
        let watched = Watched::new(&camera, None);
        let frame = Frame {
            time_s,
            exposure_s: EXPOSURE_S,
            sightings: &sightings,
            detection_limit: detection_limit(),
            turn: None,
            watched,
        };
        assert_eq!(follower.follow(&frame), Err(decoder::TimeStands));
        assert_eq!(follower.tracks(), before);
    }
    let mut wrong = Settings::default();
    wrong.missed = 1.5;
    assert!(Follower::new(&camera(), None, wrong).is_err());
}
