//! Sensors whose pixels answer to light by a few percent more and less in turn, and whose full wells read less than 255.

use photinus::camera::Pixel;
use photinus::spots::Brightness;
use rand_distr::{Distribution, Uniform};
use rand_pcg::Pcg64;

use crate::scene::{Scene, distance_px};

/// What a full well reads, grey levels.
const FULL_DN: f64 = 200.0;
/// How much more and less pixels answer in turn.
const PATTERN: f64 = 0.045;
/// Which pixels answer more: every other column, row, both in turn, or one of four.
const PATTERNS: [fn(usize, usize) -> bool; 4] =
    [|u, _| u % 2 == 0, |_, v| v % 2 == 0, |u, v| (u + v) % 2 == 0, |u, v| u % 2 == 0 && v % 2 == 0];

fn rules() -> impl Iterator<Item = Brightness> {
    let contrasts = [20, 30, 40, 60, 80].map(Brightness::Contrast);
    contrasts.into_iter().chain([60, 100, 140, 180].map(Brightness::Threshold))
}

/// What the sensor gives of a scene.
fn told(scene: &Scene, pattern: fn(usize, usize) -> bool, rng: &mut Pcg64) -> Vec<u8> {
    scene
        .clipped(FULL_DN)
        .answered(|u, v| 1.0 + if pattern(u, v) { PATTERN } else { -PATTERN })
        .noisy(1.0, rng)
}

fn place(rng: &mut Pcg64) -> Pixel {
    let phase = Uniform::new(-0.5, 0.5).unwrap();
    Pixel::new(24.0 + phase.sample(rng), 23.0 + phase.sample(rng))
}

#[test]
fn one_marker_is_one_spot_whatever_the_pattern_on_its_plateau() {
    let mut rng = Pcg64::new(17, 2);
    for pattern in PATTERNS {
        for (width_px, height) in [(0.8, 300.0), (1.0, 600.0), (1.2, 1000.0), (1.2, 3000.0), (2.0, 500.0)] {
            for _ in 0..20 {
                let mut scene = Scene::flat(48, 48, 22.0);
                scene.marker(place(&mut rng), width_px, height);
                let pixels = told(&scene, pattern, &mut rng);
                for rule in rules() {
                    let found = scene.detect(&pixels, rule);
                    assert_eq!(found.spots.len(), 1, "{width_px} px, {height}, {rule:?}: {found:?}");
                }
            }
        }
    }
}

#[test]
fn two_markers_three_pixels_apart_are_two_spots_whatever_the_pattern() {
    let mut rng = Pcg64::new(18, 2);
    let direction = Uniform::new(0.0, std::f64::consts::TAU).unwrap();
    for pattern in PATTERNS {
        for height in [120.0, 170.0] {
            for _ in 0..20 {
                let mut scene = Scene::flat(48, 48, 22.0);
                let first = place(&mut rng);
                let (sin, cos) = libm::sincos(direction.sample(&mut rng));
                let both = [first, Pixel::new(first.u + 3.0 * cos, first.v + 3.0 * sin)];
                both.iter().for_each(|&place| scene.marker(place, 0.7, height));
                let pixels = told(&scene, pattern, &mut rng);
                for rule in [Brightness::Contrast(20), Brightness::Contrast(40), Brightness::Threshold(60)] {
                    let found = scene.detect(&pixels, rule);
                    assert_eq!(found.spots.len(), 2, "{height}, {rule:?}: {found:?}");
                    for place in both {
                        assert!(
                            found.spots.iter().any(|spot| distance_px(spot.centre, place) < 0.7),
                            "{found:?}"
                        );
                    }
                }
            }
        }
    }
}
