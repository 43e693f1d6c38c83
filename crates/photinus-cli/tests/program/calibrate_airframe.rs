//! `calibrate airframe`: the airframe that it writes, and what it refuses.

use nalgebra::{Rotation3, Vector3};
use photinus::camera::Bearing;
use photinus_io::airframe::read_airframe;
use photinus_io::read_camera;

use crate::stage::Stage;

const SQUARE: &str = "0.2 0.2 0 0 0 0 0\n0.2 -0.2 0 0 0 0 0\n-0.2 -0.2 0 0 0 0 0\n-0.2 0.2 0 0 0 0 0\n0 0 0.15 2 0 0 0\n\
                      0.3 0 0.1 2 0 0 0\n";

/// Photos of an airframe whose LED 5 sits 3 cm from where it should, and is not seen in every photo.
pub(crate) fn sightings(stage: &Stage, airframe: &str) -> String {
    let camera = read_camera(stage.path("camera.toml")).unwrap().camera;
    let mut leds_m: Vec<Vector3<f64>> = read_airframe(stage.path(airframe))
        .unwrap()
        .airframe
        .leds()
        .iter()
        .map(|led| led.position_m)
        .collect();
    leds_m[5].z += 0.03;
    let mut table = "photo,led,u_px,v_px\n".to_owned();
    for photo in 0..12 {
        let (sin, cos) = libm::sincos(2.4 * f64::from(photo));
        let centre_m = Vector3::new(cos, sin, 0.4 + 0.15 * f64::from(photo % 5)) * 0.6;
        let camera_from_body = Rotation3::look_at_rh(&centre_m, &Vector3::new(0.0, 0.1, 1.0));
        for (led, led_m) in leds_m.iter().enumerate().filter(|(led, _)| *led != 5 || photo % 3 != 0) {
            let pixel = camera.pixel(&Bearing::new(camera_from_body * (led_m - centre_m)).unwrap()).unwrap();
            table += &format!("photo{photo}.png,{led},{:.2},{:.2}\n", pixel.u, pixel.v);
        }
    }
    table
}

#[test]
fn photos_from_all_around_give_the_airframe() {
    let stage = Stage::new("airframe-measured");
    stage.file("square.txt", SQUARE);
    stage.file("seen.csv", sightings(&stage, "square.txt"));
    let words = "calibrate airframe seen.csv --camera camera.toml --nominal square.txt --distance 0-1=0.4 --out measured.toml";
    let done = stage.run(words);
    assert_eq!(done.code, 0);
    assert!(done.out.contains("sightings in 12 photos"), "{}", done.out);
    let leds_m: Vec<Vector3<f64>> = read_airframe(stage.path("measured.toml"))
        .unwrap()
        .airframe
        .leds()
        .iter()
        .map(|led| led.position_m)
        .collect();
    let apart_m = |a: usize, b: usize| -> f64 { (leds_m[a] - leds_m[b]).norm() };
    assert!((apart_m(0, 1) - 0.4).abs() < 1e-6 && (apart_m(0, 2) - 0.08_f64.sqrt() * 2.0).abs() < 2e-3);
    let expected_m: f64 = Vector3::new(0.3, 0.0, -0.02).norm();
    assert!((apart_m(4, 5) - expected_m).abs() < 2e-3, "{} {expected_m}", apart_m(4, 5));
    assert_eq!(stage.run("info measured.toml").code, 0);
}

#[test]
fn what_gives_no_airframe_is_refused() {
    let stage = Stage::new("airframe-refused");
    stage.file("square.txt", SQUARE);
    let good = sightings(&stage, "square.txt");
    stage.file("seen.csv", &good);
    stage.file("seven.csv", format!("{good}photo1.png,7,30,30\n"));
    stage.file("few.csv", good.lines().take(8).collect::<Vec<_>>().join("\n"));
    for (words, parts) in [
        ("seven.csv", &["seven.csv, line 70: there is no LED 7: square has 6; LEDs are counted from 0"][..]),
        ("few.csv", &["few.csv: 0 photos show 4 or more LEDs that other photos show too", "; add photos"]),
        ("seen.csv --distance 0-9=1", &["--distance 0-9=1: square has LEDs 0 to 5"]),
        ("seen.csv --distance 0-1", &["such as 0-3=0.8"]),
        ("seen.csv --distance 2-2=1", &["between LEDs 2 and 2: two LEDs", "; check the distances"]),
    ] {
        stage
            .refuses(&format!("calibrate airframe {words} --camera camera.toml --nominal square.txt"), parts);
    }
}
