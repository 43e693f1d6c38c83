//! The same bits on every machine: a hash of all that is found in a fixed set of frames is written down here.

use photinus::spots::{Detections, Extent};

use crate::hash::Hash;
use crate::scene::{RULES, detect};

fn hash_extent(hash: &mut Hash, extent: Extent) {
    for side in [extent.left, extent.top, extent.right, extent.bottom] {
        hash.word(side.into());
    }
}

fn hash_detections(hash: &mut Hash, found: &Detections) {
    for spot in &found.spots {
        hash.numbers(&[spot.centre.u, spot.centre.v]);
        hash.numbers(spot.covariance_px2.iter());
        hash.numbers(&[spot.flux, spot.background, spot.marker_log_odds]);
        for word in [spot.area_px, spot.peak.into(), spot.saturated_px, spot.middle.0, spot.middle.1] {
            hash.word(word.into());
        }
        hash_extent(hash, spot.extent);
    }
    for rejected in &found.rejected {
        hash.numbers(&[rejected.centre.u, rejected.centre.v]);
        hash.word(rejected.area_px.into());
        hash.word(rejected.peak.into());
        rejected.reason.as_str().bytes().for_each(|byte| hash.word(byte.into()));
        hash_extent(hash, rejected.extent);
    }
}

/// Frames from whole-number arithmetic alone, so that they are the same everywhere: markers as paraboloids of many sizes,
/// heights and sub-pixel phases on a noisy background, single pixels, and a disc as large as the sun.
fn pixels(seed: u64) -> Vec<u8> {
    let mut state = seed;
    let mut random = |below: u64| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) % below
    };
    let (width, height) = (300i64, 200i64);
    let mut light: Vec<i64> = (0..width * height).map(|_| 8 + random(5) as i64).collect();
    let mut add = |u: i64, v: i64, radius: i64, top: i64| {
        // Places and radii in eighths of a pixel.
        for y in ((v - radius) / 8).max(0)..=((v + radius) / 8).min(height - 1) {
            for x in ((u - radius) / 8).max(0)..=((u + radius) / 8).min(width - 1) {
                let square = (8 * x - u) * (8 * x - u) + (8 * y - v) * (8 * y - v);
                light[(y * width + x) as usize] += (top - top * square / (radius * radius)).max(0);
            }
        }
    };
    for _ in 0..40 {
        let (u, v) = (random(8 * 300) as i64, random(8 * 200) as i64);
        add(u, v, 8 + random(40) as i64, 50 + random(500) as i64);
    }
    if seed.is_multiple_of(2) {
        add(8 * 200, 8 * 60, 8 * 30, 900);
    }
    light.into_iter().map(|light| light.clamp(0, 255) as u8).collect()
}

#[test]
fn detections_are_the_same_bit_for_bit_on_every_machine() {
    let mut hash = Hash::new();
    let (mut spots, mut rejected) = (0, 0);
    for rule in RULES {
        for seed in 0..8 {
            let found = detect(&pixels(seed), 300, 200, rule);
            spots += found.spots.len();
            rejected += found.rejected.len();
            hash_detections(&mut hash, &found);
        }
    }
    println!("{spots} spots, {rejected} rejected, hash {:#018x}", hash.value());
    // The sun stands in half of the frames, under both rules.
    assert!(spots > 200 && rejected >= 8);
    assert_eq!(hash.value(), 0x4767_f328_c9b0_ca95);
}
