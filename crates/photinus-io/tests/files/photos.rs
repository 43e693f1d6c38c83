//! Photos of LED grids, as taken and disturbed: every LED is a spot and nothing else is.
//!
//! Skipped, and said so, where the photos are not there.

#![allow(clippy::print_stdout, reason = "the numbers are worth reading")]
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use std::path::PathBuf;

use photinus::frame::FrameView;
use photinus::spots::{Brightness, Detections, Detector, Settings, Spot};
use photinus_io::image::read_image;
use photinus_testing::real_data;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;

/// A photo and the number of LEDs in it.
struct Photo {
    name: String,
    leds: usize,
    picture: Picture,
}

#[derive(Clone)]
struct Picture {
    width: usize,
    height: usize,
    pixels: Vec<u8>,
}

impl Picture {
    fn new(width: usize, height: usize, value: impl Fn(usize, usize) -> u8) -> Self {
        Self { width, height, pixels: (0..width * height).map(|i| value(i % width, i / width)).collect() }
    }

    fn at(&self, u: usize, v: usize) -> u8 {
        self.pixels[v * self.width + u]
    }

    fn detect(&self) -> Detections {
        self.detect_by(Brightness::default())
    }

    fn detect_by(&self, brightness: Brightness) -> Detections {
        let frame = FrameView::packed(&self.pixels, self.width, self.height).unwrap();
        let mut settings = Settings::default();
        settings.brightness = brightness;
        Detector::new(settings).unwrap().detect(&frame, None).unwrap().clone()
    }

    /// Without the first columns and rows: everything moves on the grid of tiles.
    fn cropped(&self, left: usize, top: usize) -> Self {
        Self::new(self.width - left, self.height - top, |u, v| self.at(u + left, v + top))
    }

    fn mirrored(&self) -> Self {
        Self::new(self.width, self.height, |u, v| self.at(self.width - 1 - u, v))
    }

    fn transposed(&self) -> Self {
        Self::new(self.height, self.width, |u, v| self.at(v, u))
    }

    fn scaled(&self, brightness: f64) -> Self {
        Self::new(self.width, self.height, |u, v| {
            (f64::from(self.at(u, v)) * brightness).round().min(255.0) as u8
        })
    }

    fn noisy(&self, sigma: f64, seed: u128) -> Self {
        let mut rng = Pcg64::new(seed, 1);
        let mut value = |pixel: u8| {
            let noise: f64 = StandardNormal.sample(&mut rng);
            (f64::from(pixel) + sigma * noise).round().clamp(0.0, 255.0) as u8
        };
        Self { pixels: self.pixels.iter().map(|&pixel| value(pixel)).collect(), ..*self }
    }
}

/// The photos of both grids, none where they are absent.
fn photos() -> Vec<Photo> {
    let mut photos = Vec::new();
    for (folder, leds) in [("grid-960x600", 35), ("grid-752x480", 48)] {
        let Some(folder) = real_data(folder) else { continue };
        let entries = std::fs::read_dir(folder).unwrap();
        let mut paths: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
        paths.sort();
        for path in paths {
            let image = read_image(&path).unwrap_or_else(|error| panic!("{error}")).image;
            let (width, height) = (image.width(), image.height());
            let picture = Picture { width, height, pixels: image.pixels().to_vec() };
            let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
            photos.push(Photo { name, leds, picture });
        }
    }
    photos
}

fn apart_px(a: &Spot, b: &Spot) -> f64 {
    libm::hypot(a.centre.u - b.centre.u, a.centre.v - b.centre.v)
}

/// The spots that are more likely markers than not: reflections are spots too, with their odds.
fn markers(spots: &[Spot]) -> Vec<Spot> {
    spots.iter().filter(|spot| spot.marker_log_odds > 0.0).cloned().collect()
}

#[test]
fn every_led_is_a_spot_and_nothing_else_is() {
    for Photo { name, leds, picture } in photos() {
        let found = markers(&picture.detect().spots);
        assert_eq!(found.len(), leds, "{name}");
        for (i, spot) in found.iter().enumerate() {
            assert!((0.0..picture.width as f64).contains(&spot.centre.u), "{name}: {spot:?}");
            assert!((0.0..picture.height as f64).contains(&spot.centre.v), "{name}: {spot:?}");
            assert!(found[i + 1..].iter().all(|other| apart_px(spot, other) > 2.0), "{name}: {spot:?}");
        }
    }
}

#[test]
fn moved_turned_dimmed_and_noisy_photos_have_the_same_spots() {
    for Photo { name, leds, picture } in photos() {
        let see = |what: &str, picture: Picture| {
            assert_eq!(markers(&picture.detect().spots).len(), leds, "{name} {what}");
        };
        for (left, top) in [(1, 0), (0, 1), (3, 5), (7, 2), (8, 8), (13, 11)] {
            see(&format!("cropped by ({left}, {top})"), picture.cropped(left, top));
        }
        see("mirrored", picture.mirrored());
        see("transposed", picture.transposed());
        for brightness in [0.5, 0.7, 0.85] {
            see(&format!("times {brightness}"), picture.scaled(brightness));
        }
        for sigma in [1.0, 2.0, 3.0] {
            see(&format!("noise {sigma}"), picture.noisy(sigma, 3));
        }
    }
}

/// The pixels of one of the cameras answer by a few percent more and less in turn. No two LEDs are as near as 5 px.
#[test]
fn wherever_the_threshold_lies_no_led_is_two_spots() {
    for Photo { name, picture, .. } in photos() {
        let contrasts = [30, 40, 60, 80].map(Brightness::Contrast);
        for rule in contrasts.into_iter().chain([60, 100, 140, 180].map(Brightness::Threshold)) {
            let found = markers(&picture.detect_by(rule).spots);
            for (i, spot) in found.iter().enumerate() {
                let alone = found[i + 1..].iter().all(|other| apart_px(spot, other) > 5.0);
                assert!(alone, "{name}, {rule:?}: {spot:?}");
            }
        }
    }
}
