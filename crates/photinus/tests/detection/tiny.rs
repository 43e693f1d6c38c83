//! Markers of one pixel and frames of a few: borders, exact zeros, strides.

use photinus::camera::Pixel;
use photinus::frame::{FrameView, Mask};
use photinus::spots::{Detector, Settings};

use crate::scene::{RULES, Scene, detect, distance_px, spot_at};

/// Corners, middles of the sides, and the pixels next to them.
fn on_the_border(width: usize, height: usize) -> Vec<(usize, usize)> {
    let columns = [0, 1, width / 2, width - 2, width - 1];
    let rows = [0, 1, height / 2, height - 2, height - 1];
    let all = rows.into_iter().flat_map(|v| columns.into_iter().map(move |u| (u, v)));
    all.filter(|&place| place != (width / 2, height / 2)).collect()
}

#[test]
fn a_marker_of_one_pixel_is_found_at_every_border() {
    for (width, height) in [(752, 480), (97, 61), (16, 16), (33, 17)] {
        for (u, v) in on_the_border(width, height) {
            for level in [0, 3, 40] {
                let mut pixels = vec![level; width * height];
                pixels[v * width + u] = 255;
                for rule in RULES {
                    let found = detect(&pixels, width, height, rule);
                    let at = format!("({u}, {v}) in {width}x{height} at level {level} with {rule:?}");
                    assert_eq!((found.spots.len(), found.rejected.len()), (1, 0), "{at}");
                    let spot = &found.spots[0];
                    let off = distance_px(spot.centre, Pixel::new(u as f64, v as f64));
                    assert!(off < 0.05, "{at}: {off} px off");
                    assert_eq!((spot.area_px, spot.peak, spot.saturated_px), (1, 255, 1), "{at}");
                    assert_eq!(spot.middle, (u as u32, v as u32), "{at}");
                }
            }
        }
    }
}

#[test]
fn a_marker_cut_by_the_border_is_found_and_says_how_unsure_it_is() {
    let (width, height) = (120, 80);
    let (mut worst_widths, mut worst_sigmas, mut count) = (0.0_f64, 0.0_f64, 0);
    for (width_px, brightness) in
        [(0.8, 200.0), (1.2, 150.0), (1.2, 240.0), (1.2, 600.0), (2.0, 200.0), (2.0, 3000.0), (3.0, 20_000.0)]
    {
        for (u, v) in on_the_border(width, height) {
            for phase in [-0.4, 0.0, 0.3] {
                let mut scene = Scene::flat(width, height, 5.0);
                let place = Pixel::new(u as f64 + phase, v as f64 + phase);
                scene.marker(place, width_px, brightness);
                let found = scene.detect(&scene.clean(), RULES[1]);
                assert_eq!((found.spots.len(), found.rejected.len()), (1, 0), "{place:?}");
                let spot = &found.spots[0];
                let off = distance_px(spot.centre, place);
                count += 1;
                worst_widths = worst_widths.max(off / width_px);
                worst_sigmas = worst_sigmas.max(off / spot.sigma_px());
            }
        }
    }
    println!("{count} cut markers: worst {worst_widths:.2} widths, worst {worst_sigmas:.1} sigma");
    assert!(worst_widths < 2.0 && worst_sigmas < 3.5, "{worst_widths} widths, {worst_sigmas} sigma");
}

#[test]
fn zeros_beside_a_marker_hide_nothing() {
    // 255, 0, 255, 0, ... : every 255 of an even row is a marker of its own; rows between are 0.
    let (width, height) = (64, 32);
    let pairs: Vec<u8> = (0..width * height)
        .map(|i| if (i % width) % 2 == 0 && (i / width) % 2 == 0 { 255 } else { 0 })
        .collect();
    let found = detect(&pairs, width, height, RULES[0]);
    assert_eq!((found.spots.len(), found.rejected.len()), (width * height / 4, 0));
    assert!(found.spots.iter().all(|spot| spot.area_px == 1));

    // A row that begins 255, 0 stops no scan: markers follow in that row and in every later one.
    let mut pixels = vec![5u8; 200 * 100];
    for v in (10..100).step_by(20) {
        for u in (10..200).step_by(20) {
            pixels[v * 200 + u..][..2].copy_from_slice(&[255, 0]);
        }
    }
    for rule in RULES {
        let found = detect(&pixels, 200, 100, rule);
        assert_eq!((found.spots.len(), found.rejected.len()), (50, 0), "{rule:?}");
    }
}

#[test]
fn a_thousand_markers_of_one_pixel_are_a_thousand_spots() {
    for (spacing, level) in [(18, 5), (9, 5), (6, 0), (5, 60)] {
        let (columns, rows) = (40, 25);
        let (width, height) = (columns * spacing, rows * spacing);
        let mut pixels = vec![level; width * height];
        for i in 0..columns * rows {
            pixels[(i / columns * spacing + spacing / 2) * width + i % columns * spacing + spacing / 2] = 255;
        }
        for rule in RULES {
            let found = detect(&pixels, width, height, rule);
            assert_eq!((found.spots.len(), found.rejected.len()), (1000, 0), "spacing {spacing} {rule:?}");
            for (i, spot) in found.spots.iter().enumerate() {
                let place = (
                    (i % columns * spacing + spacing / 2) as u32,
                    (i / columns * spacing + spacing / 2) as u32,
                );
                assert_eq!(spot.middle, place, "in the order of a scan by rows");
            }
        }
    }
}

#[test]
fn frames_of_a_few_pixels_are_frames() {
    for (width, height) in [(1, 1), (1, 40), (17, 3), (2, 2), (40, 1), (16, 16), (5, 30)] {
        for level in [0, 10, 120] {
            let flat = vec![level; width * height];
            let (u, v) = (width / 2, height / 2);
            let mut lit = flat.clone();
            lit[v * width + u] = 255;
            for rule in RULES {
                let size = format!("{width}x{height} at {level} with {rule:?}");
                let found = detect(&flat, width, height, rule);
                assert_eq!((found.spots.len(), found.rejected.len()), (0, 0), "{size}");
                // A single pixel has no surroundings to stand out from.
                if (width, height) == (1, 1) && rule == RULES[1] {
                    continue;
                }
                let found = detect(&lit, width, height, rule);
                assert_eq!((found.spots.len(), found.rejected.len()), (1, 0), "{size}");
                let spot = spot_at(&found, Pixel::new(u as f64, v as f64), 0.8);
                assert!(spot.sigma_px() < 1.0, "{size}: {spot:?}");
            }
        }
    }
}

#[test]
fn the_stride_changes_nothing() {
    let (width, height) = (75, 50);
    let mut scene = Scene::flat(width, height, 12.0);
    for (u, v) in [(0.3, 20.2), (74.0, 49.0), (30.4, 30.7), (33.6, 30.5)] {
        scene.marker(Pixel::new(u, v), 1.1, 220.0);
    }
    let packed = scene.clean();
    let mask_pixels: Vec<u8> = (0..width * height).map(|i| u8::from(i % width < 60)).collect();
    let mask = Mask::from_frame(&FrameView::packed(&mask_pixels, width, height).unwrap());
    for rule in RULES {
        let mut settings = Settings::default();
        settings.brightness = rule;
        // What a frame teaches of the camera changes the next one.
        let detect = |frame: &FrameView<'_>| {
            let mut detector = Detector::new(settings).unwrap();
            detector.detect(frame, Some(&mask)).unwrap().clone()
        };
        let expected = detect(&FrameView::packed(&packed, width, height).unwrap());
        assert!(!expected.spots.is_empty() && !expected.rejected.is_empty());
        for stride in [76, 80, 128, 1000] {
            // Padding of 255 would show if it were looked at; the last row has none.
            let mut padded = vec![255u8; stride * (height - 1) + width];
            for v in 0..height {
                padded[v * stride..][..width].copy_from_slice(&packed[v * width..][..width]);
            }
            let frame = FrameView::new(&padded, width, height, stride).unwrap();
            assert_eq!(detect(&frame), expected, "stride {stride}");
        }
    }
}
