//! What holds for any frame.

use std::sync::Arc;

use std::fmt;

use photinus::frame::{FrameView, Mask};
use photinus::optics::{Gaussian, HotPixels, Measured, Optics, PointSpread, Saturation, Sensor, SpreadField};
use photinus::spots::{Brightness, Detections, Detector, Settings};
use proptest::prelude::*;

#[derive(Clone)]
struct Frame {
    width: usize,
    height: usize,
    pixels: Vec<u8>,
}

impl fmt::Debug for Frame {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{} x {}", self.width, self.height)?;
        self.pixels.chunks(self.width).try_for_each(|row| writeln!(f, "{row:?}"))
    }
}

impl Frame {
    fn view(&self) -> FrameView<'_> {
        FrameView::packed(&self.pixels, self.width, self.height).unwrap()
    }
}

/// Arbitrary pixels, few bright ones on an even background, and blocks of equal values.
fn frames() -> impl Strategy<Value = Frame> {
    let value = prop_oneof![
        any::<u8>().boxed(),
        prop_oneof![9 => Just(0u8), 1 => any::<u8>()].boxed(),
        prop_oneof![30 => 8u8..13, 1 => 200u8..].boxed(),
        prop_oneof![Just(0u8), Just(255u8)].boxed(),
        prop_oneof![8 => Just(255u8), 1 => 0u8..].boxed(),
    ];
    let kind = prop_oneof![Just(1usize), Just(1), Just(4), Just(13)];
    (1usize..90, 1usize..70, prop::collection::vec(value, 90 * 70), kind).prop_map(
        |(width, height, values, block)| {
            let pixels = (0..width * height).map(|i| values[(i / width / block) * 90 + (i % width) / block]);
            Frame { width, height, pixels: pixels.collect() }
        },
    )
}

fn settings() -> impl Strategy<Value = Settings> {
    let brightness = prop_oneof![
        Just(Brightness::Threshold(200)),
        Just(Brightness::Contrast(20)),
        (1u8..).prop_map(Brightness::Threshold),
        (1u8..).prop_map(Brightness::Contrast),
    ];
    let number = |most: f64| prop_oneof![Just(0.0), 0.0..most];
    (brightness, number(5.0), number(1.0), 1.0..60.0, 1.0..10.0, number(1.0)).prop_map(
        |(brightness, read_dn, shot, widest_px, elongation, reflection_ratio)| {
            let mut settings = Settings::default();
            settings.brightness = brightness;
            settings.noise.read_dn = read_dn;
            settings.noise.shot = shot;
            settings.shape.widest_px = widest_px;
            settings.shape.elongation = elongation;
            settings.shape.reflection_ratio = reflection_ratio;
            settings
        },
    )
}

/// Optics of some camera.
fn optics() -> Arc<Optics> {
    let parts = [Gaussian { share: 0.8, sigma_px: 0.6 }, Gaussian { share: 0.2, sigma_px: 2.0 }];
    let measured = |value: f64| Measured { value, sigma: 0.1 * value };
    let sensor = Sensor {
        dark_dn: None,
        read_noise_dn: measured(0.5),
        shot: measured(0.04),
        response: None,
        saturation: Saturation { level_dn: 250.0, spread_dn: 1.0 },
        spill: measured(0.4),
        full_well_dn: None,
        column_smear: None,
    };
    let spread = SpreadField::even(PointSpread::gaussians(&parts).unwrap(), 0.02).unwrap();
    Arc::new(Optics { spread, sensor, vignetting: None, hot_pixels: HotPixels::default() })
}

fn areas(found: &Detections) -> u64 {
    let spots = found.spots.iter().map(|spot| u64::from(spot.area_px));
    spots.chain(found.rejected.iter().map(|rejected| u64::from(rejected.area_px))).sum()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]

    #[test]
    fn every_qualifying_pixel_is_in_one_spot_or_rejected(frame in frames(), threshold in 1u8..) {
        let mut settings = Settings::default();
        settings.brightness = Brightness::Threshold(threshold);
        let mut detector = Detector::new(settings).unwrap();
        let found = detector.detect(&frame.view(), None).unwrap();
        let qualify = frame.pixels.iter().filter(|&&pixel| pixel >= threshold).count();
        prop_assert_eq!(areas(found), qualify as u64);
        let saturated: u32 = found.spots.iter().map(|spot| spot.saturated_px).sum();
        prop_assert!(saturated as usize <= frame.pixels.iter().filter(|&&pixel| pixel == 255).count());
    }

    #[test]
    fn every_number_has_a_meaning(frame in frames(), settings in settings()) {
        let mut detector = Detector::new(settings).unwrap();
        let found = detector.detect(&frame.view(), None).unwrap();
        for spot in &found.spots {
            // Light may have fallen beside what is bright of it, even outside the frame, but not far.
            let near = (f64::from(spot.area_px) / std::f64::consts::PI).sqrt() + 3.0;
            let beyond = |at: f64, first: u32, last: u32| (f64::from(first) - at).max(at - f64::from(last));
            prop_assert!(beyond(spot.centre.u, spot.extent.left, spot.extent.right) < near, "{:?}", spot);
            prop_assert!(beyond(spot.centre.v, spot.extent.top, spot.extent.bottom) < near, "{:?}", spot);
            let covariance = spot.covariance_px2;
            prop_assert!(covariance.iter().all(|value| value.is_finite()), "{:?}", spot);
            prop_assert!(covariance.m11 > 0.0 && covariance.determinant() > 0.0, "{:?}", spot);
            prop_assert!((covariance.m12 - covariance.m21).abs() <= 1e-9 * covariance.trace(), "{:?}", spot);
            prop_assert!(spot.flux.is_finite(), "{:?}", spot);
            prop_assert!((1e-6..1.0 - 1e-6).contains(&spot.probability()), "{:?}", spot);
            prop_assert!((0.0..=255.0).contains(&spot.background), "{:?}", spot);
            prop_assert!(spot.area_px >= 1 && spot.saturated_px <= spot.area_px, "{:?}", spot);
            prop_assert!((spot.saturated_px > 0) == (spot.peak == 255), "{:?}", spot);
            let ((u, v), extent) = (spot.middle, spot.extent);
            prop_assert!((extent.left..=extent.right).contains(&u) && (extent.top..=extent.bottom).contains(&v), "{:?}", spot);
            prop_assert!((extent.right as usize) < frame.width && (extent.bottom as usize) < frame.height);
            prop_assert!(spot.area_px <= extent.width() * extent.height(), "{:?}", spot);
        }
        for rejected in &found.rejected {
            prop_assert!(rejected.centre.u.is_finite() && rejected.centre.v.is_finite() && rejected.area_px >= 1);
        }
        prop_assert!(found.spots.is_sorted_by_key(|spot| spot.extent.top));
        prop_assert!(found.rejected.is_sorted_by_key(|rejected| (rejected.extent.top, rejected.extent.left)));
    }

    /// With the optics given; without, the contrast rule learns them from what it sees, the same from the same frames.
    #[test]
    fn what_was_seen_before_changes_nothing_but_what_is_learnt(
        before in frames(), frame in frames(), settings in settings(), seed in any::<u8>(),
    ) {
        let mask_pixels: Vec<u8> = frame.pixels.iter().map(|&pixel| u8::from(pixel ^ seed > 60)).collect();
        let mask = Mask::from_frame(&FrameView::packed(&mask_pixels, frame.width, frame.height).unwrap());
        let knowing = || Detector::with_optics(settings, Some(optics())).unwrap();
        let mut warm = knowing();
        warm.detect(&before.view(), None).unwrap();
        for mask in [None, Some(&mask)] {
            let fresh = knowing().detect(&frame.view(), mask).unwrap().clone();
            prop_assert_eq!(warm.detect(&frame.view(), mask).unwrap(), &fresh);
            prop_assert_eq!(warm.detect(&frame.view(), mask).unwrap(), &fresh);
        }
        let learnt = || {
            let mut detector = Detector::new(settings).unwrap();
            detector.detect(&before.view(), None).unwrap();
            detector.detect(&frame.view(), Some(&mask)).unwrap().clone()
        };
        prop_assert_eq!(learnt(), learnt());
    }
}
