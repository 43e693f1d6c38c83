//! `calibrate mask`: what stays with the camera is masked, and what moves is located as before.

use photinus_io::mask::read_mask;
use photinus_io::results::{FrameRecord, read_results};

use crate::stage::Stage;

fn records(stage: &Stage, file: &str) -> Vec<FrameRecord> {
    read_results(stage.path(file)).unwrap().collect::<Result<_, _>>().unwrap()
}

/// A quadrotor that crosses the view.
fn flight(stage: &Stage, seconds: u32) {
    let scenes = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes");
    stage.file(
        "scene.toml",
        format!(
            "name = \"passing\"\nseed = 9\npreset = \"bluefox-dsl215-bp365\"\nrate_hz = 15.0\nduration_s = {seconds}.0\n\
             exposure_us = 1000.0\n[observer]\nmotion = {{ hover = {{ position_m = [0.0, 0.0, 5.0] }} }}\n\
             [[camera]]\nname = \"front\"\nfile = \"{scenes}/cameras/bluefox-dsl215.toml\"\n\
             [[target]]\nid = 1\nairframe = \"{scenes}/airframes/quadrotor-0.245.toml\"\n\
             motion = {{ line = {{ from_m = [4.0, 1.5, 5.0], to_m = [4.0, -1.5, 5.0], duration_s = {seconds}.0 }} }}\n"
        ),
    );
    assert_eq!(stage.run("simulate scene.toml --out flight -q").code, 0);
}

#[test]
fn hot_pixels_are_masked_and_the_neighbour_is_not() {
    let stage = Stage::new("calibrate-mask");
    flight(&stage, 3);
    assert_eq!(stage.run("inject flight --fault hot=12 --out hot -q").code, 0);
    let told = stage.run("calibrate mask hot --out mask.png");
    assert_eq!(told.code, 0, "{}", told.err);
    assert!(told.out.contains("places stay in 45 frames"), "{}", told.out);
    let mask = read_mask(stage.path("mask.png")).unwrap().mask;
    assert!((12..12 * 40).contains(&mask.ignored_px()), "{} px", mask.ignored_px());

    assert_eq!(stage.run("detect hot --mask mask.png -q --out masked.jsonl").code, 0);
    assert_eq!(stage.run("detect flight -q --out clean.jsonl").code, 0);
    let spots = |file: &str| records(&stage, file).iter().map(|frame| frame.spots.len()).sum::<usize>();
    let (masked, clean) = (spots("masked.jsonl"), spots("clean.jsonl"));
    assert!(masked <= clean && masked + 4 >= clean, "{masked} of {clean}");

    let clean = stage.run("calibrate mask flight --out nothing.png");
    assert!(clean.code == 0 && clean.out.contains("nothing stays in 45 frames"), "{}", clean.out);
}

#[test]
fn too_few_frames_and_wrong_names_are_refused() {
    let stage = Stage::new("calibrate-mask-few");
    flight(&stage, 1);
    let few = stage.run("calibrate mask flight --out mask.png");
    assert_eq!(few.code, 2);
    assert!(few.err.contains("15 frames can be used, 20 are needed"), "{}", few.err);
    let named = stage.run("calibrate mask flight --out mask.toml");
    assert!(named.code == 2 && named.err.contains("a PNG image is written there"), "{}", named.err);
    assert!(!stage.path("mask.png").exists() && !stage.path("mask.toml").exists());
}
