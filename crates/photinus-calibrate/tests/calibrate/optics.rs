//! What is learned of the optics of rendered cameras against what they were rendered with. All cameras at full length:
//! `cargo run --release -p photinus-calibrate --example optics_of_cameras`.

use crate::rendered_leds::{Eye, difference};
use photinus::camera::Pixel;
use photinus::optics::Measured;
use photinus_calibrate::optics::{Collection, LearnError, Learned, Unseen, learn};
use photinus_sim::preset::{BLUEFOX_FIT, bluefox};
use photinus_sim::sensor::{ColumnSmear, Response};

const SIZE: (usize, usize) = (320, 240);

fn eye(name: &str) -> Eye {
    Eye::named(name).cropped(SIZE.0, SIZE.1)
}

fn learned(eye: &Eye, frames: u64, seed: u64) -> Learned {
    learn(&eye.recorded(frames, 5, seed)).expect("spots enough")
}

#[test]
fn a_sharp_lens_that_overflows_is_learned_from_its_frames() {
    let eye = eye("spill-0.5");
    let learned = learned(&eye, 120, 1);
    let middle = [160.0, 120.0];
    let found = learned.optics.spread.at(Pixel::new(middle[0], middle[1]));
    let (rms, width) = difference(found, &eye.truth(middle), 3.0);
    assert!(rms < 0.01 && width.abs() < 0.03, "{rms} {width}");
    let sensor = &learned.optics.sensor;
    assert!((sensor.saturation.level_dn - 255.0).abs() < 0.5, "{sensor:?}");
    assert!((sensor.read_noise_dn.value / 0.6 - 1.0).abs() < 0.03, "{sensor:?}");
    assert!((sensor.shot.value - 0.025).abs() < 0.005 + 3.0 * sensor.shot.sigma, "{sensor:?}");
    assert!((sensor.spill.value - 0.5).abs() < 0.06 + 2.0 * sensor.spill.sigma, "{sensor:?}");
    let dark = sensor.dark_dn.expect("darkness is not clipped");
    assert!((dark.value - 6.0).abs() < 0.1, "{dark:?}");
    for unseen in [Unseen::Darkness, Unseen::ReadNoise, Unseen::Saturation, Unseen::Spill] {
        assert!(!learned.unseen.contains(&unseen), "{unseen:?}");
    }
}

/// A lens sharper than a pixel with a wide halo, before darkness that is cut off at 0: the paper's camera. Pixels that read 0 or 1 are brighter
/// on average than they are, so that the halo seems too faint, the middle too bright, and bright spots flatter than faint ones.
#[test]
fn darkness_that_is_cut_off_bends_neither_the_point_spread_nor_the_response() {
    let eye = Eye { preset: bluefox(&BLUEFOX_FIT), ..eye("gaussian-0.6") };
    let learned = learned(&eye, 100, 4);
    let middle = [160.0, 120.0];
    let (found, truth) = (learned.optics.spread.at(Pixel::new(middle[0], middle[1])), eye.truth(middle));
    let (rms, width) = difference(found, &truth, 3.0);
    assert!(rms < 0.01 && width.abs() < 0.05, "{rms} {width}");
    let [found, truth] = [found, &truth].map(|spread| spread.share(0.0, 0.0));
    assert!((found / truth - 1.0).abs() < 0.05, "{found} of the light in the middle, not {truth}");
    let bent_dn = learned.optics.sensor.bent().map_or(0.0, |response| 200.0 * response.bend_per_dn.value);
    assert!(bent_dn.abs() < 0.03, "{:?}", learned.optics.sensor.response);
}

/// A sky that is brighter above spots than below them, and bends: it goes neither into the wings nor into the response.
#[test]
fn a_sky_that_is_uneven_under_the_spots_bends_nothing() {
    let mut eye = eye("gaussian-0.6");
    eye.sky_dn = |_, v| 11.0 - 9.0 * libm::tanh((v - 125.0) / 12.0);
    let learned = learn(&eye.recorded_between([95.0, 120.0], 150, 2, 6)).expect("spots enough");
    let middle = [160.0, 120.0];
    let (found, truth) = (learned.optics.spread.at(Pixel::new(middle[0], middle[1])), eye.truth(middle));
    let (rms, width) = difference(found, &truth, 3.0);
    assert!(rms < 0.01 && width.abs() < 0.05, "{rms} {width}");
    let bent_dn = learned.optics.sensor.bent().map_or(0.0, |response| 200.0 * response.bend_per_dn.value);
    assert!(bent_dn.abs() < 0.03, "{:?}", learned.optics.sensor.response);
}

/// Pixels get up to 1.9 times what a full one reads: so far, and no farther, it is known that nothing spills.
#[test]
fn wells_that_are_never_full_spill_nothing_whatever_two_spots_gain_by_it() {
    let eye = eye("gaussian-0.4");
    let learned = learn(&eye.recorded(150, 6, 102)).expect("spots enough");
    let sensor = &learned.optics.sensor;
    assert!(sensor.spill.value < 0.02 && learned.unseen.contains(&Unseen::Spill), "{:?}", sensor.spill);
    let well = sensor.full_well_dn.expect("charges above what a pixel reads");
    assert!((1.2..1.9).contains(&(well.value / 255.0)), "{well:?}");
}

#[test]
fn what_frames_do_not_show_is_said_to_be_unseen() {
    let mut eye = eye("gaussian-0.6");
    // black is clipped, and nothing is full
    eye.preset.sensor.dark_offset_dn = -4.0;
    eye.brightest_dn = 150.0;
    let learned = learned(&eye, 60, 2);
    for unseen in [Unseen::Darkness, Unseen::Saturation, Unseen::Spill, Unseen::Vignetting] {
        assert!(learned.unseen.contains(&unseen), "{unseen:?} in {:?}", learned.unseen);
    }
    let sensor = &learned.optics.sensor;
    assert!(sensor.dark_dn.is_none() && sensor.saturation.level_dn > 254.9, "{sensor:?}");
    assert!(sensor.spill.sigma > 0.2, "what is believed is wide: {sensor:?}");
}

#[test]
fn too_few_spots_are_refused() {
    let eye = eye("gaussian-0.6");
    assert!(matches!(learn(&eye.recorded(2, 5, 1)), Err(LearnError::TooFew { needed: 40, .. })));
    assert!(matches!(learn(&Collection::default()), Err(LearnError::TooFew { found: 0, .. })));
}

/// A sensor with hot pixels, smear along columns and a soft response.
fn faulty() -> Eye {
    let mut eye = eye("gaussian-0.6");
    let sensor = &mut eye.preset.sensor;
    sensor.smear = ColumnSmear { share: 3e-4 };
    sensor.response = Response::Soft { ceiling_dn: 400.0 };
    // whatever a response does to so little charge is far below a sigma
    eye.hot = (0..10).map(|k| (20 + 27 * k, 15 + 20 * k, 8.0 + k as f64)).collect();
    eye
}

/// Mean of squared errors over squared claims.
fn squares(claims: &[(Measured, f64)]) -> f64 {
    claims.iter().map(|(found, truth)| ((found.value - truth) / found.sigma).powi(2)).sum::<f64>()
        / claims.len() as f64
}

#[test]
fn hot_pixels_smear_and_response_are_as_wrong_as_they_say() {
    const SEEDS: u64 = 5;
    let eye = faulty();
    let (mut levels, mut smears, mut bends) = (Vec::new(), Vec::new(), Vec::new());
    for seed in 0..SEEDS {
        let optics = learned(&eye, 60, seed).optics;
        let hot = &optics.hot_pixels;
        assert_eq!(hot.iter().len(), eye.hot.len(), "no more and no fewer than there are: {hot:?}");
        for &(column, row, level_dn) in &eye.hot {
            let found = hot.at(column as u32, row as u32).expect("listed").level_dn;
            let read_dn = -400.0 * libm::expm1(-level_dn / 400.0);
            levels.push((found, read_dn));
        }
        smears.push((optics.sensor.column_smear.expect("light moved"), 3e-4));
        bends.push((optics.sensor.response.expect("lights differ").bend_per_dn, 1.0 / 400.0));
    }
    let [of_levels, of_smears, of_bends] = [&levels, &smears, &bends].map(|claims| squares(claims));
    assert!((0.3..2.0).contains(&of_levels), "{of_levels}: {levels:?}");
    assert!(of_smears < 3.5, "{of_smears}: {smears:?}");
    assert!(of_bends < 3.5, "{of_bends}: {bends:?}");
    let sure = |claims: &[(Measured, f64)], share: f64| {
        claims.iter().all(|(found, truth)| found.sigma < share * truth)
    };
    assert!(
        sure(&levels, 0.1) && sure(&smears, 0.3) && sure(&bends, 0.05),
        "{levels:?} {smears:?} {bends:?}"
    );
}

#[test]
fn a_camera_that_is_turned_learns_what_its_lens_passes() {
    let eye = Eye::named("vignette").small_and_wide();
    let learned = learn(&eye.turned(160, 24, 0.005, 7)).expect("spots enough");
    let vignetting = learned.optics.vignetting.expect("LEDs moved over the image");
    for deg in [20.0_f64, 40.0, 55.0] {
        let (share, sigma) = vignetting.share(deg.to_radians());
        let truth = eye.preset.lens.illumination(deg.to_radians());
        assert!(
            (share - truth).abs() < 3.5 * sigma && sigma < 0.05,
            "{share} ± {sigma} for {truth} at {deg}"
        );
    }
    // LEDs that are elsewhere in each frame say nothing
    assert!(learned.unseen.iter().all(|unseen| *unseen != Unseen::Vignetting));
    let elsewhere = learn(&eye.recorded(60, 5, 1)).expect("spots enough");
    assert!(elsewhere.optics.vignetting.is_none() && elsewhere.unseen.contains(&Unseen::Vignetting));
}
