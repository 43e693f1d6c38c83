//! What is wider than points are before any lens: clutter, unless all markers are.

use photinus::camera::Pixel;
use photinus::spots::{Brightness, Spot};

use crate::scene::Scene;

/// The fixed threshold is one that shows narrow points wherever in a pixel they fall.
const RULES: [Brightness; 2] = [Brightness::Threshold(80), Brightness::Contrast(20)];

/// Spots of these widths, 200 grey levels high, four in a row.
fn spots(widths_px: &[f64], rule: Brightness) -> Vec<Spot> {
    let mut scene = Scene::flat(400, 300, 20.0);
    for (index, &width_px) in widths_px.iter().enumerate() {
        let place = Pixel::new(50.0 + 90.2 * (index % 4) as f64, 50.0 + 90.4 * (index / 4) as f64);
        scene.marker(place, width_px, 200.0);
    }
    let found = scene.detect(&scene.clean(), rule);
    assert_eq!(found.spots.len(), widths_px.len(), "{:?}", found.rejected);
    found.spots
}

#[test]
fn what_is_wider_than_points_beside_it_is_no_point() {
    for rule in RULES {
        let spots = spots(&[1.0, 5.0, 1.1, 0.9, 6.0, 1.0, 0.9, 1.2], rule);
        for spot in &spots {
            let is_wide = spot.area_px > 20;
            assert!((spot.probability() < 0.2) == is_wide, "{} px: {}", spot.area_px, spot.probability());
        }
        assert_eq!(spots.iter().filter(|spot| spot.probability() < 0.2).count(), 2);
    }
}

#[test]
fn out_of_focus_all_points_are_wide() {
    for rule in RULES {
        for width_px in [1.5, 3.0, 5.0] {
            let spots = spots(&[width_px; 8], rule);
            let least = spots.iter().map(Spot::probability).fold(1.0, f64::min);
            assert!(least > 0.8, "{width_px} px: {least}");
        }
    }
}

#[test]
fn what_is_wide_because_light_is_hidden_says_nothing() {
    for rule in RULES {
        let mut scene = Scene::flat(400, 300, 20.0);
        for index in 0..6 {
            let at = f64::from(index);
            scene.marker(Pixel::new(50.0 + 50.0 * at, 60.0), 1.0, 200.0);
            // Full in the middle, and cut by the border.
            scene.marker(Pixel::new(50.0 + 50.0 * at, 150.0), 3.0, 4000.0);
            scene.marker(Pixel::new(50.0 + 50.0 * at, 299.0), 3.0, 150.0);
        }
        let found = scene.detect(&scene.clean(), rule);
        let wide = found.spots.iter().filter(|spot| spot.area_px > 15);
        let least = wide.map(Spot::probability).fold(1.0, f64::min);
        assert!(least > 0.5, "{rule:?}: {least}");
    }
}
