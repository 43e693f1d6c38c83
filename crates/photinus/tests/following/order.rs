//! Frames in any order, of clocks that jump: what is told of vehicles has a meaning, what is refused changes nothing, and the same comes out twice.

use nalgebra::{Matrix3, Unit, Vector3};
use photinus::airframe::{Airframe, Ring};
use photinus::identity::CodeBook;
use photinus::locator::{self, Input, Locator};
use photinus::lookout::{Fleet, Glance, Lookout, Vehicle};
use photinus::spots::Spot;
use photinus::tracking::{Placed, Settings, Tracked};
use proptest::prelude::*;

use crate::world::{World, camera, words};

fn airframe() -> Airframe {
    let ring = Ring { arms: 6, radius_m: 0.4, leds_per_arm: 1, splay_rad: 0.0 };
    Airframe::from_ring("hexarotor", ring).unwrap()
}

fn lookout(airframe: &Airframe) -> Lookout {
    let vehicles = (0..4).map(|word| (Vehicle { id: 1 + word as u32, words: vec![word] }, 60.0));
    let fleet = Fleet::new(CodeBook::new(words()).unwrap(), vehicles).unwrap();
    Lookout::new(camera(), airframe, &locator::Settings::default(), Settings::default(), Some(&fleet))
        .unwrap()
}

/// By how much the time of a frame is off that of the one before, s.
fn step_s(kind: u8, size: f64) -> f64 {
    match kind {
        0 => 0.0,
        1 => -0.3 * size,
        2 => -2.0 * size,
        3 => 20.0 * (size - 0.5),
        4 => f64::NAN,
        _ => size / 30.0,
    }
}

fn has_a_meaning(tracked: &Tracked) -> bool {
    tracked.tracks.iter().all(|track| {
        let covariances = [&track.position_covariance_m2, &track.velocity_covariance_m2_s2];
        let is_covariance = |covariance: &&Matrix3<f64>| covariance.cholesky().is_some();
        track.position_m.iter().chain(track.velocity_m_s.iter()).all(|value| value.is_finite())
            && covariances.iter().all(is_covariance)
            && (0.0..=1.0).contains(&track.existence)
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn frames_come_in_any_order(
        seed in any::<u64>(),
        steps in proptest::collection::vec((0..16_u8, 0.0..1.0_f64), 1..40),
    ) {
        let airframe = airframe();
        let mut world = World::new(seed % 1000, 6);
        world.clutter = 4;
        let mut locator = Locator::new(camera(), &airframe, None, locator::Settings::default()).unwrap();
        let mut both = [lookout(&airframe), lookout(&airframe)];
        let down = Unit::new_normalize(Vector3::y());
        let (mut time_s, mut newest_id) = (100.0, None);
        for (kind, size) in steps {
            let next_s = time_s + step_s(kind, size);
            let spots: Vec<Spot> = world.next().into_iter().map(|seen| seen.spot).collect();
            let located = locator.locate(Input::spots(&spots).gravity(&down)).unwrap();
            let glance = Glance { gravity: Some(down), ..Glance::new(next_s, located) };
            let before = both[0].tracked().clone();
            let told = both.each_mut().map(|lookout| lookout.look(&glance).cloned());
            prop_assert_eq!(format!("{:?}", &told[0]), format!("{:?}", &told[1]));
            match &told[0] {
                Err(_) => prop_assert_eq!(both[0].tracked(), &before),
                Ok(tracked) => {
                    time_s = next_s;
                    prop_assert!(has_a_meaning(tracked), "{:?}", tracked);
                    if tracked.placed == Placed::Reset {
                        let is_new = |id: u64| newest_id.is_none_or(|newest| id > newest);
                        prop_assert!(tracked.tracks.iter().all(|track| is_new(track.id)));
                    }
                    newest_id = newest_id.max(tracked.tracks.iter().map(|track| track.id).max());
                }
            }
            for name in both[0].names() {
                prop_assert!((0.0..=1.0).contains(&name.probability), "{:?}", name);
            }
        }
    }
}
