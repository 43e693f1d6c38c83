//! What is learned of the optics of rendered cameras against what they were rendered with. All cameras at full length:
//! `cargo run --release -p photinus-calibrate --example optics_of_cameras`.

mod rendered_leds;

use photinus::camera::Pixel;
use photinus_calibrate::optics::{Collection, LearnError, Learned, Unseen, learn};
use rendered_leds::{Eye, difference};

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
