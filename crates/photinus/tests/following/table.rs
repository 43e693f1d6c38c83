//! Following beside plain nearest assignment, as a table.

use nalgebra::Rotation3;
use photinus::following::{MarkerTrack, Settings};

use crate::plain::Plain;
use crate::score::{Followed, Score};
use crate::world::{DEGREE, GYRO_RAD_S, Swing, World};
use crate::{AFTER, BEFORE, crossing, follow, follower, pair};

const SEEDS: std::ops::Range<u64> = 1000..1020;

/// Users do not know how markers accelerate.
fn by_default() -> f64 {
    Settings::default().acceleration_rad2_s3
}

/// Both, on the same frames: what happened, per 100 markers and seconds.
fn row(name: &str, has_gyro: bool, make: impl Fn(u64) -> World) {
    let (mut lost, mut switches, mut wrong, mut markers, mut frames) = ([0; 2], [0; 2], [0; 2], 0, 0);
    for seed in SEEDS {
        let mut world = make(seed);
        let (mut follower, mut plain) = (follower(by_default()), Plain::default());
        let mut scores = [Score::default(), Score::default()];
        for _ in 0..360 {
            let sightings = world.next();
            let turn = world.turned(GYRO_RAD_S);
            let told = follow(&mut follower, &world, &sightings, has_gyro.then_some(turn));
            let own: Vec<Followed> = told.iter().map(Followed::from).collect();
            let turned = if has_gyro { turn.now_from_before } else { Rotation3::identity() };
            let other = plain.follow(&sightings, world.passed_s(), &turned);
            scores[0].add(&world, &own);
            scores[1].add(&world, &other);
        }
        for (which, score) in scores.iter().enumerate() {
            lost[which] += score.lost;
            switches[which] += score.switches;
            wrong[which] += score.false_tracks;
        }
        markers += scores[0].markers;
        frames += scores[0].frames;
    }
    let seconds = markers as f64 / 60.0;
    for (which, method) in ["following", "nearest"].into_iter().enumerate() {
        println!(
            "| {name} | {method} | {:.3} | {:.2} | {:.2} |",
            100.0 * lost[which] as f64 / markers as f64,
            100.0 * switches[which] as f64 / seconds,
            wrong[which] as f64 / frames as f64,
        );
    }
}

#[test]
#[ignore = "prints the table of docs/identity.md"]
fn table() {
    println!(
        "| 20 markers | | frames without % | changes of number in 100 s of a marker | false tracks in a frame |"
    );
    println!("|---|---|---|---|---|");
    row("still", true, |seed| World::new(seed, 20));
    row("150 deg/s, gyro of 0.3 deg/s", true, |seed| {
        let mut world = World::new(seed, 20);
        world.swing = Some(Swing { amplitude_rad: 20.0 * DEGREE, most_rad_s: 150.0 * DEGREE });
        world
    });
    row("40 deg/s without a gyro", false, |seed| {
        let mut world = World::new(seed, 20);
        world.swing = Some(Swing { amplitude_rad: 15.0 * DEGREE, most_rad_s: 40.0 * DEGREE });
        world
    });
    row("30 % of frames dropped", true, |seed| {
        let mut world = World::new(seed, 20);
        world.dropped = 0.3;
        world
    });
    row("20 points of clutter in a frame", true, |seed| {
        let mut world = World::new(seed, 20);
        world.clutter = 20;
        world
    });
    row("both", true, |seed| {
        let mut world = World::new(seed, 20);
        (world.dropped, world.clutter) = (0.3, 20);
        world
    });
    println!("\n| 200 crossings of two | | changed or lost |\n|---|---|---|");
    for (name, is_steady) in [("blinking", false), ("steady", true)] {
        let mut changed = [0; 2];
        for seed in 2000..2200 {
            let mut world = crossing(seed, is_steady);
            let (mut follower, mut plain) = (follower(by_default()), Plain::default());
            let mut before = [[None; 2]; 2];
            for frame in 1..=AFTER {
                let sightings = world.next();
                let turn = world.turned(GYRO_RAD_S);
                let told: &[MarkerTrack] = follow(&mut follower, &world, &sightings, Some(turn));
                let own: Vec<Followed> = told.iter().map(Followed::from).collect();
                let other = plain.follow(&sightings, world.passed_s(), &turn.now_from_before);
                for (which, tracks) in [own, other].iter().enumerate() {
                    let now = pair(&world, tracks);
                    if frame == BEFORE {
                        before[which] = now;
                    } else if frame == AFTER {
                        changed[which] += usize::from(now != before[which]);
                    }
                }
            }
        }
        for (method, changed) in ["following", "nearest"].into_iter().zip(changed) {
            println!("| {name} | {method} | {changed} |");
        }
    }
}
