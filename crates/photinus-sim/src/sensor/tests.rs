//! Frames of unequal pixels against what EMVA 1288 measures of them.

use super::*;

const SIDE: usize = 500;

fn sensor() -> Sensor {
    Sensor {
        quantum_efficiency: 0.34,
        response: Response::Linear,
        electrons_per_dn: 20.0,
        full_well_e: 1e6,
        well_noise_e: 0.0,
        overflow: Overflow { spill: 0.0 },
        smear: ColumnSmear::NONE,
        read_noise_e: 30.0,
        dark_offset_dn: 20.0,
        corner_offset_dn: 0.0,
        dark_current_e_per_s: 0.0,
        hot_pixel_share: 0.0,
        hot_pixel_e_per_s: 0.0,
        pattern: Pattern::NONE,
        converter: Converter::EIGHT_BITS,
        shutter: Shutter::Global,
    }
}

/// Four frames, a million pixels, under an even light: as charge of markers, or as background.
fn frames(sensor: &Sensor, electrons: f32, as_background: bool) -> Vec<Vec<f64>> {
    let mut readout = Readout::of_unit(sensor, (SIDE, SIDE), 5);
    let frame = |key: u64| {
        let (mut background, mut charge) = (Background::new(SIDE, SIDE), Charge::new(SIDE, SIDE));
        if as_background {
            background.fill(|_, _| electrons);
        } else {
            (0..SIDE).for_each(|v| charge.add_row(v, 0, &[1.0; SIDE], electrons));
        }
        readout.expose(&mut charge, key);
        let mut pixels = vec![0; SIDE * SIDE];
        for (v, row) in pixels.chunks_mut(SIDE).enumerate() {
            readout.read_row(v, &background, &charge, key, row);
        }
        pixels.into_iter().map(f64::from).collect()
    };
    (0..4).map(frame).collect()
}

/// Mean, variance from frame to frame, and variance from pixel to pixel of the mean over frames with the former's part
/// taken away.
fn statistics(frames: &[Vec<f64>]) -> (f64, f64, f64) {
    let (count, pixels) = (frames.len() as f64, frames[0].len());
    let each: Vec<f64> =
        (0..pixels).map(|i| frames.iter().map(|frame| frame[i]).sum::<f64>() / count).collect();
    let mean = each.iter().sum::<f64>() / pixels as f64;
    let temporal = (0..pixels)
        .map(|i| frames.iter().map(|frame| (frame[i] - each[i]).powi(2)).sum::<f64>() / (count - 1.0))
        .sum::<f64>()
        / pixels as f64;
    let spatial = each.iter().map(|level| (level - mean).powi(2)).sum::<f64>() / pixels as f64;
    (mean, temporal, spatial - temporal / count)
}

#[test]
fn variance_over_mean_is_the_gain_whichever_way_a_frame_is_read() {
    for converter in [Converter::EIGHT_BITS, Converter::new(12).unwrap()] {
        for as_background in [false, true] {
            let sensor = Sensor { converter, ..sensor() };
            let [dark, light] = [400.0, 3600.0].map(|e| statistics(&frames(&sensor, e, as_background)));
            let gain = (light.1 - dark.1) / (light.0 - dark.0);
            assert!(
                (gain * 20.0 - 1.0).abs() < 0.01,
                "{gain} with {converter:?}, background {as_background}"
            );
            assert!((light.0 - 200.0).abs() < 0.02, "{}", light.0);
            assert!(light.2.abs() < 0.01, "no pattern: {}", light.2);
        }
    }
}

#[test]
fn dark_levels_and_gains_have_the_spread_that_was_asked_for() {
    let pattern = Pattern { offset_dn: 2.0, column_offset_dn: 1.0, gain: 0.02, well: 0.0 };
    for as_background in [false, true] {
        let sensor = Sensor { pattern, ..sensor() };
        let dark = statistics(&frames(&sensor, 0.0, as_background));
        // rounding adds its twelfth to what differs between pixels and frames together
        assert!((dark.2 / 5.0 - 1.0).abs() < 0.05, "{dark:?}");
        assert!((dark.1 / (2.25 + 1.0 / 12.0) - 1.0).abs() < 0.02, "{dark:?}");
        let light = statistics(&frames(&sensor, 3600.0, as_background));
        // 180 levels, 2 % of them, and the offsets
        let expected = 3.6 * 3.6 + 5.0;
        assert!((light.2 / expected - 1.0).abs() < 0.03, "{} not {expected}", light.2);
        assert!((light.1 / (2.25 + 9.0 + 1.0 / 12.0) - 1.0).abs() < 0.02, "{light:?}");
    }
}

#[test]
fn a_full_pixel_reads_its_well_with_the_wells_spread_and_noise_and_without_shot_noise() {
    let pattern = Pattern { well: 0.01, ..Pattern::NONE };
    let full = Sensor { full_well_e: 4000.0, well_noise_e: 40.0, pattern, read_noise_e: 10.0, ..sensor() };
    let (mean, temporal, spatial) = statistics(&frames(&full, 20_000.0, false));
    assert!((mean - 220.0).abs() < 0.05, "{mean}");
    assert!((temporal / (4.0 + 0.25 + 1.0 / 12.0) - 1.0).abs() < 0.02, "{temporal}");
    assert!((spatial / 4.0 - 1.0).abs() < 0.03, "1 % of 200 levels: {spatial}");
    let half = statistics(&frames(&full, 2000.0, false));
    assert!((half.1 / (5.0 + 0.25 + 1.0 / 12.0) - 1.0).abs() < 0.02, "half full it has shot noise: {half:?}");
}

#[test]
fn the_longer_way_of_plain_pixels_reads_what_the_short_one_does() {
    let (mut charge, mut background) = (Charge::new(SIDE, SIDE), Background::new(SIDE, SIDE));
    background.fill(|u, v| (u + 2 * v) as f32);
    charge.add_row(7, 20, &[100.0, 1500.0, 3000.0, 700.0], 1.0);
    let mut short = Readout::new(&sensor());
    // a spread far below rounding takes the longer way
    let pattern = Pattern { offset_dn: 1e-7, ..Pattern::NONE };
    let mut long = Readout::of_unit(&Sensor { pattern, ..sensor() }, (SIDE, SIDE), 1);
    let (mut a, mut b) = ([0; SIDE], [0; SIDE]);
    let mut differ = 0;
    for v in 0..SIDE {
        short.read_row(v, &background, &charge, 9, &mut a);
        long.read_row(v, &background, &charge, 9, &mut b);
        assert!(a.iter().zip(&b).all(|(a, b)| a.abs_diff(*b) <= 1));
        differ += a.iter().zip(&b).filter(|(a, b)| a != b).count();
    }
    // the sigma of the background's noise is linear between nodes on the short way
    assert!(differ < SIDE * SIDE / 100, "{differ}");
}

#[test]
fn units_differ_in_their_pattern_and_in_nothing_else() {
    let pattern = Pattern { offset_dn: 2.0, ..Pattern::NONE };
    let sensor = Sensor { pattern, read_noise_e: 0.0, ..sensor() };
    let read = |unit: u64, key: u64| {
        let mut row = [0; SIDE];
        let mut readout = Readout::of_unit(&sensor, (SIDE, SIDE), unit);
        readout.read_row(3, &Background::new(SIDE, SIDE), &Charge::new(SIDE, SIDE), key, &mut row);
        row
    };
    assert_eq!(read(1, 1), read(1, 2), "the same in every frame");
    assert_ne!(read(1, 1), read(2, 1));
}
