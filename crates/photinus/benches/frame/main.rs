//! Time of a frame on one core, beside floors measured in the same run: `cargo bench -p photinus`.
//!
//! Times differ from machine to machine and from run to run; the ratios to the floors, above all to a pass that only takes
//! the maximum of the frame, are what to compare. Every contender runs in turn within each round, medians are over the
//! rounds. Run only some tables with `cargo bench -p photinus -- detection` (or `decoding`, `following`, `locating`, `watching`, `posing`, `clutter`), and
//! only some rows of one with `cargo bench -p photinus -- locating "6 hexarotors"`.

#![expect(clippy::print_stdout, reason = "a benchmark prints its table")]

mod clutter;
mod contest;
mod decoding;
mod detection;
mod following;
mod frames;
mod watching;

use std::cell::Cell;
use std::hint::black_box;
use std::rc::Rc;

use contest::Contest;
use frames::PAPER;
use nalgebra::Vector3;
use photinus::airframe::{Airframe, Ring};
use photinus::camera::{Camera, Ideal, IdealLaw, Model, Pixel};
use photinus::frame::FrameView;
use photinus::locator::{self, Input, Locator};

fn main() {
    let asked = std::env::args().skip(1).find(|argument| !argument.starts_with('-'));
    let tables = [
        ("detection", detection::run as fn()),
        ("decoding", decoding::run),
        ("following", following::run),
        ("locating", locating),
        ("watching", watching::run),
        ("posing", posing),
        ("clutter", clutter::run),
    ];
    for (name, run) in tables {
        if asked.as_ref().is_none_or(|asked| asked == name) {
            run();
        }
    }
}

/// The camera of the paper, by its linear law.
fn camera() -> Camera {
    let centre = Pixel::new(375.5, 239.5);
    let lens = Ideal::new(IdealLaw::Equidistant, [1.0 / 3.7673e-3; 2], centre).expect("a lens");
    Camera::new(Model::Ideal(lens), PAPER.width, PAPER.height, None).expect("a camera")
}

fn hexarotor() -> Airframe {
    let ring = Ring { arms: 6, radius_m: 0.4, leds_per_arm: 1, splay_rad: 0.0 };
    Airframe::from_ring("hexarotor", ring).expect("a hexarotor")
}

fn locating() {
    let mut contest = Contest::beside_maximum("Locating, 752x480");
    let (camera, airframe) = (camera(), hexarotor());
    let gravity = Vector3::y_axis();
    let mut all_told = Vec::new();
    for count in [1, 6, 12, 25, 50] {
        let frames = frames::hexarotors(count, &camera, &airframe);
        for (known, gravity) in [("", Some(gravity)), (", no gravity", None)] {
            let (frames, camera) = (frames.clone(), camera.clone());
            let mut locator =
                Locator::new(camera, &airframe, None, locator::Settings::default()).expect("a locator");
            let told = Rc::new(Cell::new(None));
            all_told.push((format!("{count} hexarotors{known}"), told.clone()));
            contest.add(&format!("locate, {count} hexarotors{known}"), move |i| {
                let frame =
                    FrameView::packed(&frames[i % frames.len()], PAPER.width, PAPER.height).expect("a frame");
                let located = locator.locate(Input::frame(&frame).gravity(gravity.as_ref()));
                told.set(Some(black_box(located.expect("the camera's size")).neighbours.len()));
            });
        }
    }
    contest.run();
    // Who gives up is fast.
    for (name, told) in all_told {
        if let Some(told) = told.get() {
            println!("{name}: {told} told");
        }
    }
}

/// One hexarotor by its spots alone: grouping, bounds and pose, without detection.
fn posing() {
    let mut contest = Contest::new("Posing one hexarotor, anonymous", "three spots at 5 m");
    let (camera, airframe) = (camera(), hexarotor());
    let gravity = Vector3::y_axis();
    for (name, yaw_rad, distance_m) in [
        ("three spots at 5 m", 0.5, 5.0),
        ("two spots at 5 m", 0.1, 5.0),
        ("three spots at 10 m", 0.5, 10.0),
        ("two spots at 10 m", 0.1, 10.0),
    ] {
        let spots = frames::spots(&camera, &airframe, yaw_rad, distance_m);
        let mut locator =
            Locator::new(camera.clone(), &airframe, None, locator::Settings::default()).expect("a locator");
        contest.add(name, move |_| {
            black_box(locator.locate(Input::spots(&spots).gravity(&gravity)).expect("spots have no size"));
        });
    }
    contest.run();
}
