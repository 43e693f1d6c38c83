//! Markers that move while the shutter is open.

use std::sync::Arc;

use photinus::camera::Pixel;
use photinus::frame::FrameView;
use photinus::optics::{Gaussian, HotPixels, Measured, Optics, PointSpread, Saturation, Sensor, SpreadField};
use photinus::spots::{Detector, Settings};
use rand_distr::{Distribution, Uniform};
use rand_pcg::Pcg64;

use crate::scene::{Scene, distance_px};

const WIDTH_PX: f64 = 0.6;
const NOISE_DN: f64 = 1.0;
const FRAMES: usize = 30;

/// The camera of these frames, as a calibration finds it.
fn optics() -> Arc<Optics> {
    // Scenes take light at the middle of pixels: that of a Gaussian, not integrated over them, as a table of that shape has it.
    let narrower = (WIDTH_PX * WIDTH_PX - 1.0 / 12.0_f64).sqrt();
    let spread = PointSpread::gaussians(&[Gaussian { share: 1.0, sigma_px: narrower }]).unwrap();
    let measured = |value: f64| Measured { value, sigma: 0.1 * value };
    let sensor = Sensor {
        dark_dn: None,
        read_noise_dn: measured(NOISE_DN),
        shot: Measured { value: 1e-4, sigma: 1e-4 },
        response: None,
        saturation: Saturation { level_dn: 255.0, spread_dn: 0.0 },
        spill: Measured { value: 0.0, sigma: 0.01 },
        full_well_dn: None,
        column_smear: None,
    };
    Arc::new(Optics {
        spread: SpreadField::even(spread, 0.02).unwrap(),
        sensor,
        vignetting: None,
        hot_pixels: HotPixels::default(),
    })
}

/// What became of the markers of all frames.
#[derive(Debug, Default)]
struct Outcome {
    markers: usize,
    found: usize,
    doubles: usize,
    /// Sums of squared errors over their claimed variance, two to a spot, and of squared errors, px^2.
    claims: f64,
    squares_px2: f64,
}

fn smeared(length_px: f64, optics: Option<Arc<Optics>>) -> Outcome {
    let mut detector = Detector::with_optics(Settings::default(), optics).unwrap();
    let mut rng = Pcg64::new(11, 4);
    let share = Uniform::new(0.0, 1.0).unwrap();
    let mut outcome = Outcome::default();
    for _ in 0..FRAMES {
        let mut scene = Scene::flat(220, 160, 6.0);
        let angle = std::f64::consts::PI * share.sample(&mut rng);
        let (sin, cos) = libm::sincos(angle);
        let places: Vec<Pixel> = (0..6)
            .map(|i| {
                let (column, row) = (f64::from(i % 3), f64::from(i / 3));
                let mut place = |px: f64| px + share.sample(&mut rng);
                Pixel::new(place(40.0 + 70.0 * column), place(40.0 + 80.0 * row))
            })
            .collect();
        for &place in &places {
            let height = 90.0 + 110.0 * share.sample(&mut rng);
            // As bright at its summit whatever its length.
            let steps = 1 + (8.0 * length_px) as i32;
            let still = 1.0 + length_px / (2.5 * WIDTH_PX);
            for step in 0..steps {
                let along = length_px * ((f64::from(step) + 0.5) / f64::from(steps) - 0.5);
                let there = Pixel::new(place.u + along * cos, place.v + along * sin);
                scene.marker(there, WIDTH_PX, height * still / f64::from(steps));
            }
        }
        let pixels = scene.noisy(NOISE_DN, &mut rng);
        let frame = FrameView::packed(&pixels, scene.width, scene.height).unwrap();
        let found = detector.detect(&frame, None).unwrap();
        for &place in &places {
            outcome.markers += 1;
            let near: Vec<_> =
                found.spots.iter().filter(|spot| distance_px(spot.centre, place) < 1.0 + length_px).collect();
            outcome.doubles += near.len().saturating_sub(1);
            let Some(spot) = near.first().filter(|_| near.len() == 1) else { continue };
            outcome.found += 1;
            let off = nalgebra::Vector2::new(spot.centre.u - place.u, spot.centre.v - place.v);
            let inverse = spot.covariance_px2.try_inverse().unwrap();
            outcome.claims += (off.transpose() * inverse * off)[0];
            outcome.squares_px2 += off.norm_squared();
        }
    }
    outcome
}

#[test]
fn the_centre_is_that_of_the_middle_of_the_exposure() {
    let known = [0.0, 1.0, 2.0, 3.0, 4.0, 6.0, 8.0].map(|length_px| (length_px, Some(optics())));
    let unknown = [0.0, 3.0, 6.0].map(|length_px| (length_px, None));
    for (length_px, optics) in known.into_iter().chain(unknown) {
        let what = format!("{length_px} px, {}", if optics.is_some() { "known" } else { "unknown" });
        let outcome = smeared(length_px, optics);
        let claims = outcome.claims / (2 * outcome.found) as f64;
        let rms_px = (outcome.squares_px2 / (2 * outcome.found) as f64).sqrt();
        println!("{what}: squared error over claim {claims:.2}, rms {rms_px:.3} px, {outcome:?}");
        assert_eq!((outcome.found, outcome.doubles), (outcome.markers, 0), "{what}");
        assert!((0.2..1.25).contains(&claims) && rms_px < 0.02, "{what}: {claims}, {rms_px} px");
    }
}
