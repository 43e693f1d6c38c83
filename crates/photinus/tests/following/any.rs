//! Whatever is seen, at whatever times, what is told has a meaning.

use nalgebra::{Matrix3, Rotation3, Vector3};
use photinus::camera::Watched;
use photinus::following::{Frame, Turn};
use photinus::pose::LogLight;
use proptest::prelude::*;

use crate::follower;
use crate::world::{EXPOSURE_S, World, camera};

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn what_is_told_has_a_meaning(
        seed in any::<u64>(),
        frames in proptest::collection::vec((-4.0..1.0_f64, 0..8_u8, proptest::array::uniform3(-0.5..0.5_f64), proptest::option::of(1e-3..1e4_f64)), 1..60),
    ) {
        let mut world = World::new(seed % 1000, 6);
        world.clutter = 10;
        let (camera, mut follower) = (camera(), follower(0.1));
        let mut time_s = -3.0;
        for (log_passed, kind, turn, faintest_light) in frames {
            time_s += 10_f64.powf(log_passed);
            let mut sightings = world.next();
            match kind {
                0 => sightings.clear(),
                1 => sightings.extend_from_within(..),
                2 => sightings.iter_mut().for_each(|seen| seen.covariance_rad2 = Matrix3::zeros()),
                3 => sightings.iter_mut().for_each(|seen| seen.log_light = None),
                4 => sightings.iter_mut().for_each(|seen| seen.covariance_rad2 *= 1e4),
                _ => {}
            }
            let turn = Turn { now_from_before: Rotation3::new(Vector3::from(turn)), sigma_rad: 1e-3 };
            let frame = Frame {
                time_s,
                exposure_s: EXPOSURE_S,
                sightings: &sightings,
                detection_limit: faintest_light
                    .map(|light| LogLight { value: libm::log(light), sigma: 0.2 }),
                turn: (kind % 2 == 0).then_some(turn),
                watched: Watched::new(&camera, None),
            };
            for track in follower.follow(&frame).unwrap() {
                let is_probability = |p: f64| (0.0..=1.0 + 1e-9).contains(&p);
                prop_assert!(is_probability(track.existence) && is_probability(track.lit), "{track:?}");
                prop_assert!(is_probability(track.sighting_probability), "{track:?}");
                prop_assert!(track.sighting.is_none_or(|index| index < sightings.len()));
                prop_assert!((track.bearing.vector().norm() - 1.0).abs() < 1e-9);
                prop_assert!(track.bearing.vector().dot(&track.rate_rad_s).abs() < 1e-6 * (1.0 + track.rate_rad_s.norm()));
                prop_assert!(track.covariance.diagonal().min() >= 0.0, "{track:?}");
                prop_assert!((track.covariance - track.covariance.transpose()).norm() < 1e-12);
            }
        }
    }
}
