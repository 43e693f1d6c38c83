//! What is refused, and how.

use std::path::{Path, PathBuf};

use nalgebra::Vector3;

use super::*;

const SCENE: &str = r#"
name = "test"
preset = "bluefox-dsl215-bp365"
rate_hz = 60.0
duration_s = 2.0
exposure_us = 1000.0
[daylight]
sky = "clear"
latitude_deg = 50.0
longitude_deg = 14.4
time = 2018-05-10T10:00:00Z
[observer]
motion = { hover = { position_m = [0.0, 0.0, 3.0] } }
[[camera]]
name = "front"
file = "cameras/bluefox-dsl215.toml"
yaw_deg = 90.0
[[target]]
id = 1
airframe = "airframes/hexarotor-0.4.toml"
motion = { circle = { centre_m = [0.0, 8.0, 3.0], radius_m = 2.0, speed_m_s = 1.0, phase_deg = 270.0 } }
solid = [{ cylinder = { centre_m = [0.0, 0.0, 0.0], radius_m = 0.1, half_height_m = 0.1 } }]
"#;

fn scenes() -> PathBuf {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes")).to_owned()
}

fn parse(text: &str) -> photinus_io::Result<Scene> {
    Scene::parse(text, scenes().join("test.toml"))
}

#[test]
fn a_scene_is_read_with_its_files() {
    let scene = parse(SCENE).unwrap();
    assert_eq!((scene.frames, scene.targets[0].airframe.leds().len()), (120, 6));
    let ahead = scene.cameras[0].body_from_camera * Vector3::z();
    assert!((ahead - Vector3::y()).norm() < 1e-12, "yaw of 90 deg looks to the left");
    let down = scene.cameras[0].body_from_camera * Vector3::y();
    assert!((down + Vector3::z()).norm() < 1e-12);
    let elevation_deg = libm::asin(scene.daylight.unwrap().sun().unwrap().z).to_degrees();
    assert!((50.0..60.0).contains(&elevation_deg), "a May forenoon in Prague: {elevation_deg}");
}

#[test]
fn bad_scenes_are_refused_with_file_key_and_reason() {
    for (from, to, message) in [
        ("rate_hz = 60.0", "rate_hz = 60.0\nframes = 3", "line 5: unknown key `frames`"),
        (
            "radius_m = 2.0, s",
            "radius_m = -2.0, s",
            "`target[0].motion.circle.radius_m`: -2 is not a positive number",
        ),
        ("[0.0, 8.0, 3.0]", "[0.0, 2.3, 3.0]", "`target[0].motion`: at "),
        (
            "exposure_us = 1000.0",
            "exposure_us = 17000.0",
            "`exposure_us`: an exposure of 17000 us is longer than 16666.7 us",
        ),
        (
            "exposure_us = 1000.0",
            "exposure_us = nan",
            "`exposure_us`: NaN is out of range; give 0.1 to 60000000",
        ),
        (
            "hover = { position_m = [0.0, 0.0, 3.0] }",
            "recorded = { file = \"none.csv\" }",
            "`observer.motion.recorded.file`: there is no file ",
        ),
        (
            "position_m = [0.0, 0.0, 3.0]",
            "position_m = [0.0, inf, 3.0]",
            "`observer.motion.hover.position_m`: inf is out of range",
        ),
        ("airframes/hexarotor-0.4.toml", "airframes/none.toml", "`target[0].airframe`: there is no file "),
        ("name = \"front\"", "name = \"../x\"", "`camera[0].name`: `../x` cannot name a folder"),
        ("10:00:00Z", "10:00:00", "`daylight.time`: 2018-05-10T10:00:00 is no date and time in UTC"),
        (
            "latitude_deg = 50.0",
            "latitude_deg = 95",
            "`daylight.latitude_deg`: 95.0 is out of range; give -90 to 90",
        ),
        (
            "half_height_m = 0.1",
            "half_height_m = 0",
            "`target[0].solid[0].cylinder.half_height_m`: 0 is not a positive",
        ),
        ("bluefox-dsl215-bp365", "other", "line 3: unknown name `other`"),
        ("rate_hz = 60.0", "rate_hz = 1e-308", "`rate_hz`: 1e-308 is out of range; give 0.001 to 1000000"),
        ("exposure_us = 1000.0", "exposure_us = 1e300", "`exposure_us`: 1e300 is out of range"),
        (
            "[0.0, 0.0, 3.0] } }",
            "[0.0, 0.0, 3e6] } }",
            "`observer.motion.hover.position_m`: 3000000.0 is out of",
        ),
        ("yaw_deg = 90.0", "clock = { ppm = 1e9 }", "`camera[0].clock.ppm`: 1000000000.0 is out of range"),
        ("yaw_deg = 90.0", "clock = { phase = 1.0 }", "line 17: unknown key `phase`"),
        ("yaw_deg = 90.0", "exposure_us = 2e4", "`camera[0].exposure_us`: an exposure of 20000 us is longer"),
        ("[observer]", "[gyro]\nrate_hz = 0\n[observer]", "`gyro.rate_hz`: 0.0 is out of range"),
        ("[observer]", "[gyro]\nnoise_rad_s = 0\n[observer]", "line 12: missing key `rate_hz`"),
        ("[observer]", "[gravity]\nnoise_deg = -1\n[observer]", "`gravity.noise_deg`: -1.0 is out of range"),
        (
            "[observer]",
            "[odometry]\nrate_hz = 9\nplace_walk_m = nan\n[observer]",
            "`odometry.place_walk_m`: NaN is out of range",
        ),
        (
            "[observer]",
            "[recording]\nlost = 1.5\n[observer]",
            "`recording.lost`: 1.5 is out of range; give 0 to 1",
        ),
        (
            "[observer]",
            "[recording]\nlate_by_s = 0.02\n[observer]",
            "`recording.late_by_s`: 0.02 is out of range",
        ),
        ("[observer]", "[recording]\ndropped = 0.1\n[observer]", "line 13: unknown key `dropped`"),
        (
            "[[target]]",
            "[[camera]]\nname = \"front\"\nfile = \"cameras/bluefox-dsl215.toml\"\n[[target]]",
            "`camera[1].name`: another camera is called `front`",
        ),
        (
            "solid = ",
            "blink = { codes = \"codes/two-words.txt\", rate_hz = 60.0, words = [2] }\nsolid = ",
            "`target[0].blink.words`: word 2 of ",
        ),
        (
            "solid = ",
            "blink = { codes = \"codes/two-words.txt\", rate_hz = 60.0, words = [0, 1] }\nsolid = ",
            "`target[0].blink.words`: 2 words for 1 signals",
        ),
        (
            "solid = ",
            "blink = { codes = \"codes/two-words.txt\", rate_hz = 60.0, words = [0], first_word = 0 }\nsolid = ",
            "`target[0].blink.first_word`: words are given, too",
        ),
        (
            "solid = ",
            "blink = { codes = \"codes/two-words.txt\", rate_hz = 60.0, jitter_s = 0.01 }\nsolid = ",
            "`target[0].blink.jitter_s`: 0.01 is out of range; give 0 to 0.0016666666666666668",
        ),
        ("yaw_deg = 90.0", "yaw_deg = 9000.0", "`camera[0].yaw_deg`: 9000.0 is out of range"),
    ] {
        let text = SCENE.replacen(from, to, 1);
        assert_ne!(text, SCENE, "{from}");
        let error = parse(&text).map(|_| ()).unwrap_err().to_string();
        assert!(error.contains(&format!("test.toml, {message}")), "{error}\nnot {message}");
    }
}

#[test]
fn every_scene_of_the_library_is_read() {
    let mut read = 0;
    for entry in std::fs::read_dir(scenes()).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|end| end == "toml") {
            Scene::read(&path).unwrap_or_else(|error| panic!("{error}"));
            read += 1;
        }
    }
    assert!(read >= 1);
}

#[test]
fn an_led_does_not_switch_without_end_in_an_exposure() {
    let blink = "blink = { codes = \"codes/two-words.txt\", rate_hz = 1e6 }\nsolid = ";
    let text = SCENE.replace("solid = ", blink).replace("rate_hz = 60.0", "rate_hz = 20.0");
    assert!(parse(&text).is_ok());
    let error = parse(&text.replace("1000.0", "40000.0")).unwrap_err().to_string();
    assert!(error.contains("`target[0].blink.rate_hz`: an exposure of 0.04 s holds 40000 bits"), "{error}");
}

/// The scene of the documentation, which has every table.
fn example() -> String {
    let document = std::fs::read_to_string(scenes().join("../docs/scenes.md")).unwrap();
    let lines = document.lines().skip_while(|line| !line.starts_with("    name ="));
    let example = lines.take_while(|line| line.is_empty() || line.starts_with("    "));
    example.map(|line| line.trim_start().to_owned() + "\n").collect()
}

#[test]
fn the_example_of_the_documentation_is_read() {
    let text = example();
    let scene = parse(&text).unwrap_or_else(|error| panic!("{error}"));
    let camera = &scene.cameras[0];
    assert_eq!(
        (camera.exposure_us, scene.targets[0].blink.as_ref().unwrap().words.as_slice()),
        (Some(500.0), &[1][..])
    );
    assert_eq!((camera.clock, camera.phase_s), (crate::clock::Clock { offset_s: 0.002, ppm: 20.0 }, 0.004));
    let (instruments, recording) = (&scene.instruments, &scene.recording);
    assert!(instruments.gyro.is_some() && instruments.gravity.is_some() && instruments.odometry.is_some());
    assert_eq!(
        (recording.lost, recording.late, recording.late_by_s, recording.swapped),
        (0.01, 0.02, 0.005, 0.005)
    );
}

/// Whatever number stands in a scene: it is refused, or a frame can be rendered.
#[test]
fn no_number_of_a_scene_panics() {
    const NUMBERS: [&str; 10] =
        ["nan", "-inf", "1e300", "-1", "1e-308", "0", "3", "0.001", "1e5", "99999999999999999999"];
    let text = example();
    let is_number = |c: char| c.is_ascii_digit() || matches!(c, '.' | '-');
    let starts: Vec<usize> = text
        .char_indices()
        .filter(|(at, c)| {
            c.is_ascii_digit() && !text[..*at].ends_with(|c: char| is_number(c) || c.is_alphabetic())
        })
        .map(|(at, _)| at)
        .collect();
    let (mut read, mut refused) = (0, 0);
    for (index, start) in starts.iter().enumerate() {
        let length = text[*start..].chars().take_while(|c| is_number(*c)).count();
        for number in [NUMBERS[index % 10], NUMBERS[(index * 7 + 3) % 10]] {
            let damaged = format!("{}{number}{}", &text[..*start], &text[start + length..]);
            let Ok(scene) = parse(&damaged) else {
                refused += 1;
                continue;
            };
            read += 1;
            crate::Simulator::new(&scene, 0).unwrap().frame(1);
        }
    }
    assert!(read > 20 && refused > 20, "{read} {refused}");
}
