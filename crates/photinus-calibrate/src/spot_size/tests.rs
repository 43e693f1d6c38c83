use super::*;

/// Areas with the scatter of where a point falls in its pixel: by the fractional part of an irrational walk.
fn recording(offset_px: f64, scale_px_m2: f64, count: usize) -> Vec<Sample> {
    let place = |i: usize, step: f64| (i as f64 * step).fract();
    (0..count)
        .map(|i| {
            let distance_m = 0.5 * libm::pow(20.0, place(i, 0.618_033_988_75));
            let top_px = offset_px + scale_px_m2 / (distance_m * distance_m);
            let area_px = (top_px * (0.5 + 0.5 * place(i, 0.414_213_562_37))).round() as u32;
            Sample { distance_m, area_px }
        })
        .collect()
}

#[test]
fn the_envelope_is_the_edge_of_what_made_the_areas() {
    let samples = recording(2.0, 30.0, 2000);
    let found = calibrate(&samples, 0.0).unwrap();
    assert!(found.outliers.is_empty());
    assert!(samples.iter().all(|sample| sample.area_px <= found.curve.max_area_px(sample.distance_m)));
    for distance_m in [0.5, 1.0, 2.0, 4.0, 9.0] {
        let true_px = 2.0 + 30.0 / (distance_m * distance_m);
        let (upper_px, median_px) =
            (found.envelope.envelope.area_px(distance_m), found.median.envelope.area_px(distance_m));
        assert!((upper_px - true_px).abs() < 0.05 * true_px + 0.1, "{distance_m} m: {upper_px} {true_px}");
        assert!((median_px - 0.75 * true_px).abs() < 0.05 * true_px + 0.3, "{distance_m} m: {median_px}");
    }
    assert!(found.margin < 0.1, "{}", found.margin);
    assert!(found.envelope.sigma[1] > 0.0 && found.envelope.sigma[1] < 3.0, "{:?}", found.envelope.sigma);
    assert_eq!(found.bins.iter().map(|bin| bin.samples).sum::<usize>(), 2000);
    assert_eq!(found, calibrate(&samples, 0.0).unwrap(), "the same samples give the same answer");
}

#[test]
fn single_pixels_begin_and_several_end_where_the_samples_say() {
    let found = calibrate(&recording(1.2, 20.0, 1000), 0.0).unwrap();
    let ends = (found.first_one_px_m.unwrap(), found.last_two_px_m.unwrap());
    assert!(ends.0 > 3.0 && ends.0 < 5.2, "{ends:?}");
    assert!(ends.1 > 7.0 && ends.1 < 8.2, "20 / (1.5 - 1.2) is 8.2 m squared: {ends:?}");
}

#[test]
fn spots_of_something_else_do_not_raise_the_curve() {
    let mut samples = recording(2.0, 30.0, 1000);
    let clean = calibrate(&samples, 0.0).unwrap();
    for index in [100, 400, 700] {
        samples[index].area_px = 500;
    }
    let found = calibrate(&samples, 0.0).unwrap();
    assert_eq!(found.outliers, [100, 400, 700]);
    assert!((found.share_above - 0.003).abs() < 1e-9);
    let (with, without) = (found.curve.upper(), clean.curve.upper());
    assert!((with.scale_px_m2 / without.scale_px_m2 - 1.0).abs() < 0.1, "{with:?} {without:?}");
}

#[test]
fn brighter_leds_raise_the_scale_alone() {
    let samples = recording(2.0, 30.0, 500);
    let (same, brighter) =
        (calibrate(&samples, 0.0).unwrap().curve, calibrate(&samples, 0.25).unwrap().curve);
    assert!((brighter.upper().scale_px_m2 / same.upper().scale_px_m2 - 1.25).abs() < 1e-12);
    assert!((brighter.upper().offset_px - same.upper().offset_px).abs() < 1e-12);
}

#[test]
fn what_makes_no_curve_is_refused_with_its_reason() {
    let good = recording(2.0, 30.0, 200);
    assert!(matches!(calibrate(&[], 0.0), Err(SpotSizeError::TooFew { spots: 0 })));
    assert!(matches!(calibrate(&good, f64::NAN), Err(SpotSizeError::Brighter(_))));
    let with = |change: fn(&mut Sample)| {
        let mut samples = good.clone();
        samples.iter_mut().for_each(change);
        calibrate(&samples, 0.0)
    };
    assert!(matches!(with(|s| s.area_px = 0), Err(SpotSizeError::TooFew { spots: 0 })));
    assert!(matches!(with(|s| s.distance_m = 3.0 + 0.1 * s.distance_m), Err(SpotSizeError::Span { .. })));
    assert_eq!(with(|s| s.area_px = (s.distance_m * 10.0) as u32), Err(SpotSizeError::NotFalling));
    let nan = [good.as_slice(), &[Sample { distance_m: f64::NAN, area_px: 3 }]].concat();
    assert!(matches!(calibrate(&nan, 0.0), Err(SpotSizeError::Distance { sample: 200, .. })));
    for area_px in [1, u32::MAX] {
        let flat: Vec<Sample> = good.iter().map(|s| Sample { area_px, ..*s }).collect();
        assert_eq!(calibrate(&flat, 0.0), Err(SpotSizeError::NotFalling), "{area_px}");
    }
}
