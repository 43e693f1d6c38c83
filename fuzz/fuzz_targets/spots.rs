//! Any frame, mask and settings: every qualifying pixel is found or rejected, and every number has a meaning.
#![no_main]

use libfuzzer_sys::fuzz_target;
use photinus::frame::{FrameView, Mask};
use photinus::spots::{Brightness, Detector, Settings};

/// Width, height, padding, rule, level and the other settings take a byte each; the pixels follow and repeat.
fn check(bytes: &[u8]) -> Option<()> {
    let (&[width, height, padding, flags, level, read, shot, widest, elongation, reflection], rest) =
        bytes.split_first_chunk()?;
    let (width, height) = (1 + usize::from(width), 1 + usize::from(height % 96));
    let stride = width + usize::from(padding % 40);
    let pixels: Vec<u8> = rest.iter().copied().cycle().take(stride * height).collect();
    let frame = FrameView::new(&pixels, width, height, stride).ok()?;
    let mask = (flags & 2 != 0).then(|| {
        let inverted: Vec<u8> = pixels.iter().map(|pixel| pixel & (flags >> 2)).collect();
        FrameView::new(&inverted, width, height, stride).map(|view| Mask::from_frame(&view))
    });
    let mask = mask.transpose().expect("of the frame's size");
    let mut settings = Settings::default();
    settings.brightness =
        if flags & 1 == 0 { Brightness::Threshold(level) } else { Brightness::Contrast(level) };
    settings.noise.read_dn = f64::from(read) / 32.0;
    settings.noise.shot = f64::from(shot) / 256.0;
    settings.shape.widest_px = 1.0 + f64::from(widest);
    settings.shape.elongation = 1.0 + f64::from(elongation) / 16.0;
    settings.shape.reflection_ratio = f64::from(reflection) / 255.0;
    let mut detector = Detector::new(settings).ok()?;
    let found = detector.detect(&frame, mask.as_ref()).expect("the mask is of the frame's size").clone();
    for spot in &found.spots {
        let covariance = &spot.covariance_px2;
        assert!(covariance.iter().all(|value| value.is_finite()), "{spot:?}");
        assert!(covariance.m11 > 0.0 && covariance.determinant() > 0.0, "{spot:?}");
        assert!(spot.centre.u.is_finite() && spot.centre.v.is_finite() && spot.flux.is_finite(), "{spot:?}");
        assert!((0.0..=255.0).contains(&spot.background), "{spot:?}");
        assert!(spot.marker_log_odds.is_finite(), "{spot:?}");
    }
    if flags & 1 == 0 {
        let areas = found.spots.iter().map(|spot| spot.area_px);
        let area: u32 = areas.chain(found.rejected.iter().map(|rejected| rejected.area_px)).sum();
        let bright = (0..height).flat_map(|v| frame.row(v)).filter(|&&pixel| pixel >= level).count();
        assert_eq!(area as usize, bright);
    }
    assert_eq!(detector.detect(&frame, mask.as_ref()).expect("as before"), &found);
    Some(())
}

fuzz_target!(|bytes: &[u8]| {
    let _ = check(bytes);
});
