//! The same bits on every machine: a hash of all that is told of markers that come out of whole-number noise.

use nalgebra::Matrix2;
use photinus::camera::{Pixel, Watched};
use photinus::following::{Follower, Frame};
use photinus::identity::decoder::Identity;
use photinus::locator::Sighting;
use photinus::pose::LogLight;

use crate::hash::Hash;
use crate::world::{EXPOSURE_S, camera, detection_limit, words};
use crate::{follower, world};

/// 0 to 1, in steps of 2^-31, without any function of the machine.
fn share(state: &mut u64) -> f64 {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*state >> 33) as f64 / f64::from(1_u32 << 31)
}

/// Ten markers that move to and fro and blink, and two points of clutter.
fn see(frame: u32, pattern: &Sighting, state: &mut u64) -> Vec<Sighting> {
    let (camera, words) = (camera(), words());
    let mut sightings = Vec::new();
    for marker in 0..12_u32 {
        let (u, v) = if marker < 10 {
            let aside = f64::from((frame * (marker + 1) / 4) % 120);
            (60.0 + 60.0 * f64::from(marker) + (aside - 60.0).abs(), 100.0 + 25.0 * f64::from(marker))
        } else {
            (10.0 + 730.0 * share(state), 10.0 + 460.0 * share(state))
        };
        if marker >= 10 || words[marker as usize].bit((frame + marker) as usize) {
            let place = Pixel::new(u + 0.3 * share(state), v + 0.3 * share(state));
            let (bearing, jacobian) = camera.bearing_with_jacobian(place).unwrap();
            let covariance_rad2 = jacobian * (Matrix2::identity() * 0.01) * jacobian.transpose();
            let log_light = Some(LogLight { value: 6.5 + 0.1 * share(state), sigma: 0.05 });
            sightings.push(Sighting { bearing, covariance_rad2, log_light, ..pattern.clone() });
        }
    }
    sightings
}

#[test]
fn tracks_are_the_same_bit_for_bit_on_every_machine() {
    // what is not drawn here takes no part
    let pattern = Sighting { rad_per_px: 3.8e-3, ..world::any_sighting() };
    let (camera, mut state, mut hash, mut told) = (camera(), 1, Hash::new(), 0);
    let mut follower: Follower = follower(0.1);
    for frame in 0..180 {
        let sightings = see(frame, &pattern, &mut state);
        let tracks = follower.follow(&Frame {
            time_s: f64::from(frame) / 60.0,
            exposure_s: EXPOSURE_S,
            sightings: &sightings,
            detection_limit: detection_limit(),
            turn: None,
            watched: Watched::new(&camera, None),
        });
        for track in tracks.unwrap() {
            told += 1;
            hash.word(track.number);
            hash.numbers(track.bearing.vector().iter().chain(&track.rate_rad_s).chain(&track.covariance));
            hash.numbers(&[track.existence, track.lit, track.sighting_probability]);
            if let Some(Identity { probability, .. }) = track.identity {
                hash.number(probability);
            }
        }
    }
    println!("{told} tracks, {:#018x}", hash.value());
    assert!(told > 1000, "{told}");
    assert_eq!(hash.value(), 0x69e6_db1e_86bf_9abd);
}
