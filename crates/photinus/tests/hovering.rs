//! A detector that knows nothing of the camera learns from vehicles that hover: every frame shows the same spots at the same phases in their pixels.
//!
//! Points behind a lens of Moffat's profile, which is none of the shapes that are learnt, integrated over pixels by sampling. Checked: when they move
//! afterwards, errors of centres over what is claimed of them, from both sides.

#![allow(clippy::print_stdout, reason = "the measured numbers are worth reading")]
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use photinus::camera::Pixel;
use photinus::frame::FrameView;
use photinus::spots::{Detector, Settings};
use rand_distr::{Distribution, StandardNormal, Uniform};
use rand_pcg::Pcg64;

const SIDE: usize = 128;
const DARK_DN: f64 = 6.0;
/// Frames of hovering, and those that count.
const LEARNT: usize = 40;
const COUNTED: usize = 50;
/// Samples of a pixel along a side.
const SAMPLES: usize = 5;

/// The light of a point of summit 1 in the pixel this far away: Moffat's profile of scale 0.7 px and exponent 2.2.
fn share(du_px: f64, dv_px: f64) -> f64 {
    let place = |sample: usize| (sample as f64 + 0.5) / SAMPLES as f64 - 0.5;
    let at = |sample: usize| {
        let (u, v) = (du_px + place(sample % SAMPLES), dv_px + place(sample / SAMPLES));
        libm::pow(1.0 + (u * u + v * v) / (0.7 * 0.7), -2.2)
    };
    (0..SAMPLES * SAMPLES).map(at).sum::<f64>() / (SAMPLES * SAMPLES) as f64
}

/// Squared error of centres over the claim, per axis, of frames after `LEARNT` in which the spots hover or move; a summit is this high.
fn claims(hovers: bool, summit_dn: f64, seed: u64) -> f64 {
    let mut rng = Pcg64::new(u128::from(seed), 5);
    let phase = Uniform::new(-0.5, 0.5).unwrap();
    let mut detector = Detector::new(Settings::default()).unwrap();
    let place = |rng: &mut Pcg64, spot: usize| {
        Pixel::new(24.0 + 40.0 * spot as f64 + phase.sample(rng), 64.0 + phase.sample(rng))
    };
    let hovering = [0, 1, 2].map(|spot| place(&mut rng, spot));
    let (mut squares, mut count) = (0.0, 0.0);
    for number in 0..LEARNT + COUNTED {
        let is_still = hovers && number < LEARNT;
        let places = if is_still { hovering } else { [0, 1, 2].map(|spot| place(&mut rng, spot)) };
        let mut light = vec![0.0; SIDE * SIDE];
        for (place, brightness) in places.iter().zip([1.0, 0.6, 0.35]) {
            for (index, light) in light.iter_mut().enumerate() {
                let (du, dv) = ((index % SIDE) as f64 - place.u, (index / SIDE) as f64 - place.v);
                if du * du + dv * dv < 144.0 {
                    *light += summit_dn * brightness * share(du, dv);
                }
            }
        }
        let mut value = |light: f64| {
            let noise: f64 = StandardNormal.sample(&mut rng);
            (DARK_DN + light + noise * libm::sqrt(0.36 + 0.02 * light)).round().clamp(0.0, 255.0) as u8
        };
        let pixels: Vec<u8> = light.into_iter().map(&mut value).collect();
        let found = detector.detect(&FrameView::packed(&pixels, SIDE, SIDE).unwrap(), None).unwrap();
        for place in places.iter().filter(|_| number >= LEARNT) {
            let near = |spot: &&photinus::spots::Spot| {
                libm::hypot(spot.centre.u - place.u, spot.centre.v - place.v) < 2.0
            };
            // The faintest is not always as bright as the contrast wants it.
            let Some(spot) = found.spots.iter().find(near) else { continue };
            for (error, axis) in [(spot.centre.u - place.u, 0), (spot.centre.v - place.v, 1)] {
                squares += error * error / spot.covariance_px2[(axis, axis)];
                count += 1.0;
            }
        }
    }
    assert!(count > 1.6 * (3 * COUNTED) as f64, "{count}");
    squares / count
}

#[test]
fn what_was_learnt_of_spots_that_hover_holds_when_they_move() {
    for (summit_dn, most, most_in_all) in [(150.0, 1.7, 1.4), (900.0, 2.6, 2.0)] {
        for hovers in [false, true] {
            let found = [0, 1, 2, 3].map(|seed| claims(hovers, summit_dn, seed));
            println!("summits of {summit_dn}, hovering {hovers}: squared error over claim {found:.2?}");
            let mean = found.iter().sum::<f64>() / found.len() as f64;
            assert!(found.iter().all(|found| (0.5..most).contains(found)), "{found:?}");
            assert!((0.7..most_in_all).contains(&mean), "{mean}");
        }
    }
}
