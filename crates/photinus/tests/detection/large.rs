//! Near neighbours, the sun, streaks, reflections, the own airframe.

use photinus::camera::Pixel;
use photinus::frame::{FrameView, Mask};
use photinus::spots::Reason;
use rand_pcg::Pcg64;

use crate::scene::{RULES, Scene, detect_masked, distance_px, rejected_as, spot_at};

const WIDTH: usize = 752;
const HEIGHT: usize = 480;

#[test]
fn a_hexarotor_at_half_a_metre_is_not_the_sun() {
    // Three LEDs 20 px wide are saturated and in view at once; their edges are soft.
    let mut rng = Pcg64::new(2, 2);
    let mut worst_px = 0.0_f64;
    for edge in [1.0, 2.0, 4.0] {
        for phase in [0.0, 0.25, 0.5, 0.8] {
            let places = [(200.0, 240.0), (376.0, 250.0), (560.0, 235.0)]
                .map(|(u, v)| Pixel::new(u + phase, v - phase));
            let mut scene = Scene::flat(WIDTH, HEIGHT, 8.0);
            for place in places {
                scene.disc(place, 10.0, edge);
            }
            let pixels = scene.noisy(1.0, &mut rng);
            for rule in RULES {
                let found = scene.detect(&pixels, rule);
                assert_eq!((found.spots.len(), found.rejected.len()), (3, 0), "edge {edge} {rule:?}");
                for place in places {
                    let spot = spot_at(&found, place, 1.0);
                    worst_px = worst_px.max(distance_px(spot.centre, place));
                    assert!(spot.saturated_px > 150);
                }
            }
        }
    }
    println!("20 px wide: worst {worst_px:.3} px");
    assert!(worst_px < 0.1, "{worst_px}");
}

#[test]
fn the_sun_is_rejected_and_the_markers_beside_it_are_found() {
    let mut rng = Pcg64::new(4, 1);
    let suns = [(560.0, 120.0), (376.3, 240.7), (5.0, 470.0), (750.0, 200.0), (300.0, -8.0), (745.0, 6.0)];
    for sun in suns.map(|(u, v)| Pixel::new(u, v)) {
        let mut scene = Scene::flat(WIDTH, HEIGHT, 8.0);
        scene.sun(sun);
        let grid = (0..11)
            .flat_map(|i| (0..7).map(move |j| (40.0 + 67.0 * f64::from(i), 38.0 + 67.0 * f64::from(j))));
        let places: Vec<Pixel> =
            grid.map(|(u, v)| Pixel::new(u, v)).filter(|&p| distance_px(p, sun) > 120.0).collect();
        for &place in &places {
            scene.marker(place, 1.0, 400.0);
        }
        let pixels = scene.noisy(2.0, &mut rng);
        for rule in RULES {
            let found = scene.detect(&pixels, rule);
            assert_eq!(rejected_as(&found, Reason::Sun), 1, "{sun:?} {rule:?}");
            for &place in &places {
                assert!(spot_at(&found, place, 0.3).marker_log_odds > 0.0, "{sun:?} {rule:?}");
            }
            // The rest is glare, and known as such.
            let likely = found.spots.iter().filter(|spot| spot.marker_log_odds > 0.0).count();
            assert_eq!(likely, places.len(), "{sun:?} {rule:?}");
            // What is on its slope stays where it shows.
            for spot in found.spots.iter().filter(|spot| spot.saturated_px == 0) {
                let (u, v, extent) = (spot.centre.u, spot.centre.v, spot.extent);
                let across = f64::from(extent.left) - 1.0..=f64::from(extent.right) + 1.0;
                let down = f64::from(extent.top) - 1.0..=f64::from(extent.bottom) + 1.0;
                assert!(across.contains(&u) && down.contains(&v), "{sun:?} {rule:?} {spot:?}");
            }
        }
    }
}

#[test]
fn streaks_are_rejected_in_every_direction() {
    for degrees in (0..180).step_by(15) {
        let mut scene = Scene::flat(160, 160, 8.0);
        let (sin, cos) = libm::sincos(f64::from(degrees).to_radians());
        for step in -30..=30 {
            let along = f64::from(step) / 2.0;
            scene.marker(Pixel::new(60.0 + along * cos, 70.0 + along * sin), 0.8, 120.0);
        }
        scene.marker(Pixel::new(120.0, 120.0), 1.2, 300.0);
        for rule in RULES {
            let found = scene.detect(&scene.clean(), rule);
            assert_eq!(rejected_as(&found, Reason::Streak), 1, "{degrees} deg {rule:?}: {found:?}");
            assert_eq!(found.spots.len(), 1, "{degrees} deg {rule:?}");
        }
    }
}

#[test]
fn a_large_dim_surface_is_a_reflection() {
    let mut rng = Pcg64::new(4, 8);
    let mut scene = Scene::flat(300, 200, 10.0);
    scene.lit_box((60, 50), (119, 99), 100.0);
    scene.marker(Pixel::new(200.4, 150.2), 1.2, 200.0);
    let found = scene.detect(&scene.noisy(1.5, &mut rng), RULES[1]);
    assert_eq!((found.spots.len(), rejected_as(&found, Reason::Reflection)), (1, 1), "{found:#?}");
    spot_at(&found, Pixel::new(200.4, 150.2), 0.1);
}

#[test]
fn what_the_mask_covers_is_rejected_as_masked() {
    let (width, height) = (200, 120);
    let looked_at: Vec<u8> = (0..width * height).map(|i| u8::from(i / width < 80)).collect();
    let mask = Mask::from_frame(&FrameView::packed(&looked_at, width, height).unwrap());
    let mut scene = Scene::flat(width, height, 8.0);
    // The own airframe's glow: more than half of it below the mask's edge at row 80; one marker above, one beneath.
    scene.disc(Pixel::new(60.0, 84.0), 9.0, 2.0);
    scene.marker(Pixel::new(150.0, 30.0), 1.2, 300.0);
    scene.marker(Pixel::new(150.0, 100.0), 1.2, 300.0);
    for rule in RULES {
        let found = detect_masked(&scene.clean(), (width, height), rule, Some(&mask));
        assert_eq!((found.spots.len(), rejected_as(&found, Reason::Mask)), (1, 2), "{rule:?}: {found:?}");
        spot_at(&found, Pixel::new(150.0, 30.0), 0.1);
        let without = scene.detect(&scene.clean(), rule);
        assert_eq!((without.spots.len(), without.rejected.len()), (3, 0), "{rule:?}");
    }
}
