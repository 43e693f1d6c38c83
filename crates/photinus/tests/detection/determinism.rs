//! The same bits on every machine: a hash of all that is found in a fixed set of frames is written down here.

use photinus::spots::{Detections, Extent};

use crate::scene::{RULES, detect};

/// FNV-1a over 64-bit words.
struct Hash(u64);

impl Hash {
    fn word(&mut self, word: u64) {
        for byte in word.to_le_bytes() {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }

    fn number(&mut self, number: f64) {
        self.word(number.to_bits());
    }

    fn extent(&mut self, extent: Extent) {
        for side in [extent.left, extent.top, extent.right, extent.bottom] {
            self.word(side.into());
        }
    }

    fn detections(&mut self, found: &Detections) {
        for spot in &found.spots {
            self.number(spot.centre.u);
            self.number(spot.centre.v);
            spot.covariance_px2.iter().for_each(|&value| self.number(value));
            self.number(spot.flux);
            self.number(spot.background);
            for word in [spot.area_px, spot.peak.into(), spot.saturated_px, spot.middle.0, spot.middle.1] {
                self.word(word.into());
            }
            self.extent(spot.extent);
        }
        for rejected in &found.rejected {
            self.number(rejected.centre.u);
            self.number(rejected.centre.v);
            self.word(rejected.area_px.into());
            self.word(rejected.peak.into());
            rejected.reason.as_str().bytes().for_each(|byte| self.word(byte.into()));
            self.extent(rejected.extent);
        }
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
    let mut hash = Hash(0xcbf2_9ce4_8422_2325);
    let (mut spots, mut rejected) = (0, 0);
    for rule in RULES {
        for seed in 0..8 {
            let found = detect(&pixels(seed), 300, 200, rule);
            spots += found.spots.len();
            rejected += found.rejected.len();
            hash.detections(&found);
        }
    }
    println!("{spots} spots, {rejected} rejected, hash {:#018x}", hash.0);
    assert!(spots > 200 && rejected > 20);
    assert_eq!(hash.0, 0x5c4e_afc0_0ac3_245b);
}
