//! `calibrate airframe-light`: the airframe that it writes, and what it refuses.

use photinus::airframe::Lobe;
use photinus_io::airframe::read_airframe;

use crate::stage::Stage;

/// A robot with LEDs as narrow as cos^3, told as cosines, that flies away and turns.
pub(crate) fn scene(duration_s: f64) -> String {
    let scenes = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes");
    format!(
        "name = \"narrow\"\nseed = 77\npreset = \"bluefox-dsl215-bp365\"\nrate_hz = 10.0\nduration_s = {duration_s:?}\n\
         exposure_us = 1000.0\n[observer]\nmotion = {{ hover = {{ position_m = [0.0, 0.0, 5.0] }} }}\n\
         [[camera]]\nname = \"front\"\nfile = \"{scenes}/cameras/bluefox-dsl215.toml\"\n\
         [[target]]\nid = 1\nairframe = \"{scenes}/airframes/quadrotor-0.245.toml\"\nwind_m_s = 4.0\n\
         motion = {{ line = {{ from_m = [1.6, 0.4, 4.8], to_m = [6.0, -0.6, 5.6], duration_s = {duration_s:?} }} }}\n\
         spin = [{{ start_s = 0.0, duration_s = {duration_s:?}, turns = 3.3 }}]\n\
         lobe = {{ cosine = 3.0 }}\nleds = {{ spread = 0.2 }}\n"
    )
}

#[test]
fn a_flight_gives_lobes_and_powers_that_locate_believes() {
    let stage = Stage::new("airframe-light");
    stage.file("scene.toml", scene(30.0));
    assert_eq!(stage.run("simulate scene.toml --out flight -q").code, 0);
    let done = stage.run("calibrate airframe-light flight --out learned.toml");
    assert_eq!(done.code, 0, "{}", done.err);
    for part in ["lobe       of 8 LEDs: cosine^3.", "the light of", "looks the same in 4 turns"] {
        assert!(done.out.contains(part), "{part} is not in\n{}", done.out);
    }
    let file = read_airframe(stage.path("learned.toml")).unwrap();
    let Lobe::Cosine { power } = file.airframe.leds()[0].lobe else { panic!("{:?}", file.airframe) };
    assert!((2.7..3.4).contains(&power), "{power}");
    assert!(file.tolerances.power_sigma.is_some_and(|sigma| (0.005..0.1).contains(&sigma)), "{file:?}");
    let done = stage.run("info learned.toml");
    assert!(
        done.out.contains("all directional by cosine^3.") && done.out.contains(", known to "),
        "{}",
        done.out
    );
    let done = stage.run("locate flight --airframe learned.toml --frames 5 --out seen.jsonl");
    assert_eq!(done.code, 0, "{}", done.err);
    stage.refuses(
        "convert learned.toml learned.txt",
        &["learned.txt: LED 0 shines by a power", "; write TOML"],
    );
}

#[test]
fn what_tells_nothing_of_light_is_refused() {
    let stage = Stage::new("airframe-light-refused");
    stage.file("scene.toml", scene(2.0));
    assert_eq!(stage.run("simulate scene.toml --out short -q").code, 0);
    for (words, parts) in [
        ("short", &["short: ", "frames show one neighbour alone", ": 30 are needed; record longer"][..]),
        ("short --out short/airframe.toml --force", &["this file is an input"]),
        ("no", &["no: ", "; check the path"]),
        ("frame.png", &["no airframe: give --airframe FILE"]),
        ("short --camera hexa.toml", &["hexa.toml"]),
    ] {
        stage.refuses(&format!("calibrate airframe-light {words}"), parts);
    }
}
