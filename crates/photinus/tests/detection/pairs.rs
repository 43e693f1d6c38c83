//! Markers so near each other that neither is seen alone, where the point spread is known: as measured, or as frames have told it.

use std::sync::Arc;

use nalgebra::Vector2;
use photinus::camera::Pixel;
use photinus::frame::FrameView;
use photinus::optics::{Measured, Optics, PointSpread, Saturation, Sensor, SpreadField};
use photinus::spots::{Detector, Settings, Spot};
use rand_distr::{Distribution, Uniform};
use rand_pcg::Pcg64;

use crate::crowded::spread;
use crate::scene::{Scene, distance_px};

const NOISE_DN: f64 = 1.0;
const LEVEL_DN: f64 = 10.0;
/// Frames that tell of the camera before any is counted.
const FIRST: usize = 8;

/// What was claimed of the spots of pairs, and what was so.
#[derive(Default, Debug)]
struct Kept {
    pairs: u32,
    spots: u32,
    squares_px2: f64,
    nees: f64,
    light: u32,
    light_chi2: f64,
    towards_px: f64,
}

impl Kept {
    fn add(&mut self, spot: &Spot, at: Pixel, other: Pixel, light: f64) {
        let off = Vector2::new(spot.centre.u - at.u, spot.centre.v - at.v);
        let towards = Vector2::new(other.u - at.u, other.v - at.v).normalize();
        self.spots += 1;
        self.squares_px2 += off.norm_squared();
        self.towards_px += off.dot(&towards);
        self.nees += off.dot(&(spot.covariance_px2.try_inverse().unwrap() * off)) / 2.0;
        if let Some(told) = spot.light {
            self.light += 1;
            self.light_chi2 += ((told.value - light) / told.sigma).powi(2);
        }
    }

    fn rms_px(&self) -> f64 {
        (self.squares_px2 / f64::from(2 * self.spots)).sqrt()
    }

    fn nees(&self) -> f64 {
        self.nees / f64::from(self.spots)
    }
}

/// A camera of this point spread, as it is: the scene takes the light in the middle of a pixel for that of the pixel.
fn optics(width_px: f64) -> Optics {
    let whole = std::f64::consts::TAU * width_px * width_px;
    let samples = spread(width_px).samples().iter().map(|sample| sample / whole).collect();
    let spread = PointSpread::new(samples).unwrap();
    let known = |value| Measured { value, sigma: 1e-3 };
    let sensor = Sensor {
        dark_dn: Some(known(LEVEL_DN)),
        read_noise_dn: known(NOISE_DN),
        shot: known(1e-4),
        saturation: Saturation { level_dn: 255.0, spread_dn: 0.0 },
        spill: known(0.0),
        full_well_dn: None,
        column_smear: None,
        response: None,
    };
    let spread = SpreadField::even(spread, 0.005).unwrap();
    Optics { spread, sensor, vignetting: None, hot_pixels: photinus::optics::HotPixels::default() }
}

/// Pairs `gap_px` apart and lone markers between them, of these heights above the background.
fn pairs(
    detector: &mut Detector,
    width_px: f64,
    gap_px: Uniform<f64>,
    heights: [Uniform<f64>; 2],
    seed: u128,
) -> Kept {
    let mut rng = Pcg64::new(seed, 3);
    let phase = Uniform::new(-0.5, 0.5).unwrap();
    let direction = Uniform::new(0.0, std::f64::consts::TAU).unwrap();
    let mut kept = Kept::default();
    for frame in 0..FIRST + 12 {
        let mut scene = Scene::flat(320, 240, LEVEL_DN);
        let mut all = Vec::new();
        for place in 0..48 {
            let (column, row) = (f64::from(place % 8), f64::from(place / 8));
            let at = |px: f64, rng: &mut Pcg64| 20.0 + 40.0 * px + phase.sample(rng);
            let first = Pixel::new(at(column, &mut rng), at(row, &mut rng));
            let (sin, cos) = libm::sincos(direction.sample(&mut rng));
            let gap_px = gap_px.sample(&mut rng);
            let second = Pixel::new(first.u + gap_px * cos, first.v + gap_px * sin);
            let heights = heights.map(|height| height.sample(&mut rng));
            scene.marker(first, width_px, heights[0]);
            if place % 2 == 0 {
                scene.marker(second, width_px, heights[1]);
                all.push(([first, second], heights));
            }
        }
        let pixels = scene.noisy(NOISE_DN, &mut rng);
        let view = FrameView::packed(&pixels, scene.width, scene.height).unwrap();
        let found = detector.detect(&view, None).unwrap();
        for (places, heights) in all.iter().filter(|_| frame >= FIRST) {
            kept.pairs += 1;
            let near = |place: Pixel| {
                let off_px = |spot: &&Spot| distance_px(spot.centre, place);
                let nearest = found.spots.iter().min_by(|a, b| off_px(a).total_cmp(&off_px(b))).unwrap();
                (off_px(&nearest) < 1.2).then_some(nearest)
            };
            if let [Some(a), Some(b)] = places.map(near)
                && a != b
            {
                let light = |height: f64| height * std::f64::consts::TAU * width_px * width_px;
                kept.add(a, places[0], places[1], light(heights[0]));
                kept.add(b, places[1], places[0], light(heights[1]));
            }
        }
    }
    println!("{width_px} px wide: {kept:?}, rms {:.4} px, NEES {:.2}", kept.rms_px(), kept.nees());
    kept
}

fn range(low: f64, high: f64) -> Uniform<f64> {
    Uniform::new(low, high).unwrap()
}

fn measured(width_px: f64) -> Detector {
    Detector::with_optics(Settings::default(), Some(Arc::new(optics(width_px)))).unwrap()
}

#[test]
fn pairs_are_where_they_are_said_to_be_and_shine_as_said() {
    for (width_px, nearest_px) in [(0.5, 1.8), (0.7, 2.3), (1.0, 3.2)] {
        let gap_px = range(nearest_px, nearest_px + 2.0);
        for heights in [[range(60.0, 200.0); 2], [range(120.0, 200.0), range(40.0, 80.0)]] {
            let kept = pairs(&mut measured(width_px), width_px, gap_px, heights, 31);
            assert!(kept.spots > kept.pairs, "{kept:?}");
            assert!((0.75..1.3).contains(&kept.nees()), "{kept:?}");
            assert!(kept.towards_px.abs() / f64::from(kept.spots) < 0.004, "{kept:?}");
            assert!(kept.rms_px() < 0.03, "{kept:?}");
            assert!(kept.light * 10 > kept.spots * 9, "{kept:?}");
            assert!((0.6..1.4).contains(&(kept.light_chi2 / f64::from(kept.light))), "{kept:?}");
        }
    }
}

#[test]
fn pairs_that_are_full_in_the_middle_do_not_lean_towards_each_other() {
    for (width_px, gap_px) in [(0.6, range(2.5, 5.0)), (1.0, range(4.5, 6.0))] {
        let heights = [range(300.0, 900.0); 2];
        let kept = pairs(&mut measured(width_px), width_px, gap_px, heights, 32);
        assert!(kept.spots > kept.pairs, "{kept:?}");
        assert!((0.5..1.5).contains(&kept.nees()), "{kept:?}");
        assert!(kept.rms_px() < 0.03, "{kept:?}");
    }
}
