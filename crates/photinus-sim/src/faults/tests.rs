//! Faults together: the order, the seed, errors in between.

use nalgebra::{Unit, Vector3};
use photinus_io::Error;
use photinus_io::dataset::{TruthLed, TruthNeighbour};
use photinus_io::frames::Moved;

use super::*;

/// A frame of a test.
pub(super) fn shot(index: u64, pixels: Vec<u8>, width: usize, height: usize) -> Shot {
    let frame = Frame {
        image: GreyImage::new(pixels, width, height).unwrap(),
        index,
        time_s: Some(index as f64 / 60.0),
        source: format!("images/{index:06}.png"),
        gravity: Some(Unit::new_normalize(Vector3::new(0.1, 0.9, 0.2))),
        exposure_s: None,
        moved: Moved::default(),
        conversions: Vec::new(),
    };
    Shot { frame, truth: None }
}

/// Truth of one neighbour with LEDs at these pixels, numbered in their order.
pub(super) fn truth(frame: u64, leds_px: &[[f64; 2]]) -> TruthFrame {
    let led = |(led, &[u_px, v_px]): (u32, &[f64; 2])| TruthLed { u_px, v_px, led: Some(led) };
    let neighbour = TruthNeighbour {
        id: 1,
        position_m: [0.0, 0.0, 5.0],
        orientation_xyzw: [0.0, 0.0, 0.0, 1.0],
        distance_m: 5.0,
        velocity_m_s: None,
        leds: (0..).zip(leds_px).map(led).collect(),
    };
    TruthFrame { frame, time_s: frame as f64 / 60.0, neighbours: vec![neighbour], ..TruthFrame::default() }
}

/// Shots after one fault.
pub(super) fn faulty(fault: Fault, seed: u64, shots: Vec<Shot>) -> Vec<Shot> {
    let faults = Faults { list: vec![fault], seed };
    faults.inject(shots.into_iter().map(Ok)).map(|shot| shot.unwrap()).collect()
}

fn grey(count: u64) -> Vec<Shot> {
    let textured = |frame: u64| (0..64 * 48).map(|i| ((i * 37 + frame * 11) % 200) as u8).collect();
    let with_truth = |frame| Shot {
        truth: Some(truth(frame, &[[10.0, 20.0], [20.0, 21.0], [30.0, 20.0]])),
        ..shot(frame, textured(frame), 64, 48)
    };
    (0..count).map(with_truth).collect()
}

fn all_faults() -> Vec<Fault> {
    let words = Fault::WORDS.iter().map(|(word, _)| word.replace("400,200", "30,20"));
    words.map(|word| word.parse().unwrap()).collect()
}

#[test]
fn the_same_seed_gives_the_same_bytes_and_another_one_others() {
    for fault in all_faults() {
        let once = faulty(fault, 3, grey(40));
        assert_eq!(once, faulty(fault, 3, grey(40)), "{fault}");
        let told = matches!(fault, Fault::Airframe(_) | Fault::Focal(_));
        assert_eq!(once == grey(40), told, "{fault}");
        let is_random = matches!(
            fault,
            Fault::Noise(_)
                | Fault::Hot(_)
                | Fault::Lamp(Lamp::Somewhere)
                | Fault::Gravity(_)
                | Fault::Dropped(_)
                | Fault::Duplicated(_)
                | Fault::Swapped(_)
                | Fault::Torn(_)
        );
        assert_eq!(once != faulty(fault, 4, grey(40)), is_random, "{fault}");
    }
}

#[test]
fn a_frame_does_not_depend_on_those_before_it_unless_it_shows_them() {
    for fault in all_faults() {
        if matches!(fault, Fault::Duplicated(_) | Fault::Swapped(_) | Fault::Torn(_)) {
            continue;
        }
        let (all, late) = (faulty(fault, 3, grey(12)), faulty(fault, 3, grey(12).split_off(7)));
        assert!(all.ends_with(&late), "{fault}");
    }
}

#[test]
fn faults_happen_in_their_order_and_two_of_a_kind_are_independent() {
    let inject = |words: &[&str]| {
        let list = words.iter().map(|word| word.parse().unwrap()).collect();
        let shots = Faults { list, seed: 1 }.inject(grey(1).into_iter().map(Ok));
        shots.map(|shot| shot.unwrap()).collect::<Vec<_>>()
    };
    assert_ne!(inject(&["gain=0.5", "hot=5"]), inject(&["hot=5", "gain=0.5"]));
    assert_eq!(inject(&["mirrored", "mirrored"]), grey(1));
    assert_eq!(inject(&[]), grey(1));
    let difference = |shots: Vec<Shot>| {
        let of = |pixels: &[u8]| pixels.iter().map(|&grey| f64::from(grey)).collect::<Vec<_>>();
        let (noisy, before) = (of(shots[0].frame.image.pixels()), grey(1));
        let squares = noisy.iter().zip(of(before[0].frame.image.pixels())).map(|(a, b)| (a - b).powi(2));
        squares.sum::<f64>() / noisy.len() as f64
    };
    let (once, twice) = (difference(inject(&["noise=3"])), difference(inject(&["noise=3", "noise=3"])));
    assert!((twice / once - 2.0).abs() < 0.2, "{once} {twice}: the same numbers twice would give 4");
}

#[test]
fn an_error_stays_in_its_place() {
    for fault in all_faults() {
        let broken = || Error::format("images/000001.png", "broken");
        let shots = grey(3).into_iter().enumerate();
        let shots = shots.map(|(i, shot)| if i == 1 { Err(broken()) } else { Ok(shot) });
        let faults = Faults { list: vec![fault], seed: 11 };
        let after: Vec<_> =
            faults.inject(shots).map(|shot| shot.map_err(|error| error.to_string())).collect();
        assert_eq!(after.iter().filter(|shot| **shot == Err(broken().to_string())).count(), 1, "{fault}");
        assert!(after.len() == 3 || matches!(fault, Fault::Dropped(_)), "{fault}");
    }
}

#[test]
fn what_is_told_is_off_by_all_factors_together() {
    use photinus::airframe::Ring;
    use photinus::camera::{Ideal, IdealLaw, Model, Pixel};

    let list = vec![Fault::Airframe(1.1), Fault::Focal(0.9), Fault::Noise(3.0), Fault::Airframe(2.0)];
    let faults = Faults { list, seed: 0 };
    let ring = Ring { arms: 4, radius_m: 0.3, leds_per_arm: 1, splay_rad: 0.0 };
    let told = faults.airframe(&Airframe::from_ring("quad", ring).unwrap()).unwrap();
    assert!((told.max_radius_m() - 0.66).abs() < 1e-12);
    let lens = Ideal::new(IdealLaw::Equidistant, [300.0; 2], Pixel::new(50.0, 50.0)).unwrap();
    let camera = Camera::new(Model::Ideal(lens), 100, 100, None).unwrap();
    let Model::Ideal(told) = faults.camera(&camera).unwrap().model().clone() else { panic!() };
    assert!((told.focal_px()[0] - 270.0).abs() < 1e-9);
}
