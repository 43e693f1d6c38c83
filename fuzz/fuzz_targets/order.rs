//! Frames of any spots at any times, in any order: what is told of tracks has a meaning, and a frame that is refused changes nothing.
#![no_main]

use libfuzzer_sys::fuzz_target;
use photinus::airframe::{Airframe, Ring};
use photinus::camera::{Camera, Ideal, IdealLaw, Model, Pixel};
use photinus::identity::{CodeBook, Word};
use photinus::locator::{self, Input, Locator};
use photinus::lookout::{Fleet, Glance, Lookout, Vehicle};
use photinus::spots::{Extent, Spot};
use photinus::tracking::Settings;

/// Each frame takes two bytes of time, in steps of 2 ms, one for how many spots it has, and two for the place of each.
const STEP_S: f64 = 2e-3;
const MOST_FRAMES: usize = 60;

fn spot(u: u8, v: u8) -> Spot {
    let centre = Pixel::new(20.0 + 2.5 * f64::from(u), 20.0 + 1.6 * f64::from(v));
    let (left, top) = (centre.u as u32, centre.v as u32);
    Spot {
        centre,
        covariance_px2: nalgebra_identity(),
        area_px: 9,
        peak: 200,
        saturated_px: 0,
        flux: 800.0,
        light: None,
        background: 5.0,
        marker_log_odds: 3.0,
        middle: (left, top),
        extent: Extent { left, top, right: left + 1, bottom: top + 1 },
    }
}

/// A tenth of a pixel each way; the matrix is whatever type the field has.
fn nalgebra_identity<M: From<[[f64; 2]; 2]>>() -> M {
    M::from([[0.01, 0.0], [0.0, 0.01]])
}

fn check(bytes: &[u8]) -> Option<()> {
    let lens = Ideal::new(IdealLaw::Equidistant, [265.0; 2], Pixel::new(375.5, 239.5)).ok()?;
    let camera = Camera::new(Model::Ideal(lens), 752, 480, None).ok()?;
    let ring = Ring { arms: 6, radius_m: 0.4, leds_per_arm: 1, splay_rad: 0.0 };
    let airframe = Airframe::from_ring("hexarotor", ring).ok()?;
    let word = |number: u32| Word::new(&(0..10).map(|bit| number >> bit & 1 == 1).collect::<Vec<_>>());
    let book = CodeBook::new([0b01_0001_1101, 0b01_1010_1100].into_iter().filter_map(word).collect()).ok()?;
    let vehicles = (0..2).map(|word| (Vehicle { id: 1 + word as u32, words: vec![word] }, 60.0));
    let fleet = Fleet::new(book, vehicles).ok()?;
    let settings = locator::Settings::default();
    let mut locator = Locator::new(camera.clone(), &airframe, None, settings).ok()?;
    let mut lookout = Lookout::new(camera, &airframe, &settings, Settings::default(), Some(&fleet)).ok()?;
    let (mut rest, mut time_s) = (bytes, 100.0);
    for _ in 0..MOST_FRAMES {
        let (&[low, high, count], after) = rest.split_first_chunk()?;
        let (places, after) = after.split_at_checked(2 * usize::from(count % 8))?;
        rest = after;
        time_s += STEP_S * f64::from(i16::from_le_bytes([low, high]));
        let spots: Vec<Spot> = places.as_chunks().0.iter().map(|&[u, v]| spot(u, v)).collect();
        let located = locator.locate(Input::spots(&spots)).expect("spots have no size");
        let before = lookout.tracked().clone();
        if lookout.look(&Glance::new(time_s, located)).is_err() {
            assert_eq!(lookout.tracked(), &before);
        }
        for track in &lookout.tracked().tracks {
            assert!(track.position_m.iter().all(|value| value.is_finite()), "{track:?}");
            assert!(track.position_covariance_m2.trace() > 0.0, "{track:?}");
            assert!((0.0..=1.0).contains(&track.existence), "{track:?}");
        }
    }
    Some(())
}

fuzz_target!(|bytes: &[u8]| {
    let _ = check(bytes);
});
