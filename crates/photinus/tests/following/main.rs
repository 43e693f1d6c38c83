//! Markers that blink are followed through their dark frames, turns, drops, clutter and crossings, against a simulator of its own.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]
#![allow(clippy::disallowed_methods, reason = "the simulator is no part of what must be the same everywhere")]
#![allow(unreachable_pub, reason = "modules of one test")]

mod score;
mod world;

use photinus::camera::Watched;
use photinus::following::{Follower, Frame, MarkerTrack, Settings, Turn};
use photinus::identity::CodeBook;
use photinus::identity::decoder::{self, Decoder, Who};
use nalgebra::{Rotation3, Vector3};
use score::Score;
use world::{EXPOSURE_S, FAINTEST, Swing, World, camera, words};

fn follower(acceleration_rad2_s3: f64) -> Follower {
    let decoder = Decoder::new(&CodeBook::new(words()).unwrap(), decoder::Settings::default()).unwrap();
    let settings = Settings { acceleration_rad2_s3, ..Settings::default() };
    Follower::new(&camera(), Some(decoder), settings).unwrap()
}

/// One frame; the gyro has this noise, rad/s, where there is one.
fn next<'a>(world: &mut World, follower: &'a mut Follower, gyro: Option<f64>) -> &'a [MarkerTrack] {
    let sightings = world.next();
    let turn = gyro.map(|noise_rad_s| {
        let (now_from_before, sigma_rad) = world.turned(noise_rad_s);
        Turn { now_from_before, sigma_rad }
    });
    let camera = world.camera.clone();
    let frame = Frame {
        time_s: world.time_s,
        exposure_s: EXPOSURE_S,
        sightings: &sightings,
        faintest_light: FAINTEST,
        turn,
        watched: Watched::new(&camera, None),
    };
    follower.follow(&frame).unwrap()
}

/// Follows for so many frames and scores them.
fn follow(world: &mut World, follower: &mut Follower, gyro: Option<f64>, frames: usize) -> Score {
    let mut score = Score::default();
    for _ in 0..frames {
        let tracks = next(world, follower, gyro);
        score.add(world, tracks);
    }
    println!("NEES {:.2?}, lost {}, switches {}, false {}, of {} frames, {} tracks", score.nees(), score.lost, score.switches, score.false_tracks, score.frames, score.numbers.len());
    score
}

/// All markers that have settled are known by their words at the end.
fn all_are_known(world: &World, follower: &Follower, score: &Score) {
    for (index, marker) in world.markers.iter().enumerate().filter(|(index, _)| score.is_settled(*index)) {
        let (ahead, _) = world.truth(index);
        let gap = |track: &&MarkerTrack| (track.bearing.vector() - ahead).norm();
        let track = follower.tracks().iter().min_by(|a, b| gap(a).total_cmp(&gap(b))).unwrap();
        let identity = track.identity.unwrap();
        if Some(identity.who)!= marker.word.map(Who::Word) {println!( "{index}{identity:?} {:?} {:?}", track.number, score.closest[index]);}
    }
}

const DEGREE: f64 = std::f64::consts::PI / 180.0;

#[test]
fn a_still_camera_loses_nobody_and_knows_how_sure_it_is() {
    for seed in 0..5 {
        let mut world = World::new(seed, 20);
        let mut follower = follower(world.acceleration);
        let score = follow(&mut world, &mut follower, Some(0.3 * DEGREE), 360);
        all_are_known(&world, &follower, &score);
    }
}

#[test]
fn turns_of_150_degrees_per_second_with_a_gyro() {
    for seed in 10..15 {
        let mut world = World::new(seed, 20);
        world.swing = Some(Swing { amplitude_rad: 20.0 * DEGREE, most_rad_s: 150.0 * DEGREE });
        let mut follower = follower(world.acceleration);
        let score = follow(&mut world, &mut follower, Some(0.3 * DEGREE), 360);
        all_are_known(&world, &follower, &score);
    }
}

#[test]
fn turns_of_40_degrees_per_second_without_a_gyro() {
    for seed in 20..25 {
        let mut world = World::new(seed, 20);
        world.swing = Some(Swing { amplitude_rad: 15.0 * DEGREE, most_rad_s: 40.0 * DEGREE });
        let mut follower = follower(world.acceleration);
        let score = follow(&mut world, &mut follower, None, 360);
        all_are_known(&world, &follower, &score);
    }
}

#[test]
fn drops_and_clutter() {
    for seed in 30..35 {
        let mut world = World::new(seed, 20);
        world.dropped = 0.3;
        world.clutter = 20;
        let mut follower = follower(world.acceleration);
        let score = follow(&mut world, &mut follower, Some(0.3 * DEGREE), 360);
        all_are_known(&world, &follower, &score);
    }
}

/// Two markers on great circles that cross, at any angle and speed, as near as they come to each other; the camera is still.
fn crossing(seed: u64, steady: bool) -> World {
    let mut world = World::new(seed, 0);
    world.acceleration = 1e-3;
    let speed = world.between(0.15, 0.5);
    let angle = world.between(0.3, std::f64::consts::PI);
    for (number, course) in [0.0, angle].into_iter().enumerate() {
        let speed = speed * world.between(0.7, 1.3);
        let side = Vector3::new(course.cos(), course.sin(), 0.0);
        // both are straight ahead 2 s after the beginning, give or take a pixel
        let miss = Vector3::from_fn(|row, _| if row < 2 { 0.002 * world.normal() } else { 0.0 });
        let mut marker = world.marker(Vector3::z());
        let turn = Rotation3::new(Vector3::z().cross(&side) * (-2.0 * speed));
        marker.ahead = turn * (Vector3::z() + miss).normalize();
        marker.rate_rad_s = turn * side * speed;
        marker.word = (!steady).then_some(number);
        world.markers.push(marker);
    }
    world
}

#[test]
fn crossings() {
    for steady in [false, true] {
        let (mut swaps, mut more) = (0, 0);
        for seed in 100..200 {
            let mut world = crossing(seed, steady);
            let mut follower = follower(0.02);
            let mut own = [None; 2];
            for frame in 0..240 {
                let tracks = next(&mut world, &mut follower, Some(0.3 * DEGREE)).to_vec();
                if frame == 90 || frame == 239 {
                    let now = [0, 1].map(|index| {
                        let (ahead, _) = world.truth(index);
                        let gap = |track: &&MarkerTrack| (track.bearing.vector() - ahead).norm();
                        let near = tracks.iter().filter(|track| gap(track) < 0.015);
                        near.min_by(|a, b| gap(a).total_cmp(&gap(b))).map(|track| track.number)
                    });
                    if frame == 90 {
                        own = now;
                    } else {
                        if now != own || now[0].is_none() { println!("{steady} {seed} {own:?} {now:?}"); }
                        swaps += usize::from(now != own);
                        more += usize::from(tracks.len() > 2);
                    }
                }
            }
        }
        println!("steady {steady}: {swaps} swaps, {more} with more tracks");
    }
}
