//! Frames against calculations of their own.

use std::path::Path;

use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use photinus::camera::{Bearing, Pixel};

use super::*;
use crate::background::Water;
use crate::sensor::{Charge, Shutter};

/// A camera at the origin that looks east, and whatever `rest` says.
fn scene(exposure_us: f64, rest: &str) -> Scene {
    let text = format!(
        "name = \"test\"\npreset = \"bluefox-dsl215-bp365\"\nrate_hz = 20.0\nduration_s = 2.0\nexposure_us = {exposure_us}\n\
         [observer]\nmotion = {{ hover = {{ position_m = [0.0, 0.0, 3.0] }} }}\n\
         [[camera]]\nname = \"front\"\nfile = \"cameras/bluefox-dsl215.toml\"\n{rest}"
    );
    let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/test.toml"));
    let mut scene = Scene::parse(&text, path).unwrap_or_else(|error| panic!("{error}"));
    scene.preset.emitter.unit_spread = 0.0;
    scene.preset.sensor.hot_pixel_share = 0.0;
    scene
}

/// A single LED that faces the camera.
fn led(motion: &str, more: &str) -> String {
    format!(
        "[[target]]\nid = 1\nairframe = \"airframes/single-led.toml\"\nheading_deg = 180.0\nmotion = {motion}\n{more}"
    )
}

fn first(scene: &Scene) -> Rendered {
    Simulator::new(scene, 0).unwrap().frame(0)
}

/// The markers' light alone, without noise, in an exposure of its own.
fn exposed(simulator: &mut Simulator, start_s: f64, length_s: f64) -> Charge {
    simulator.expose(simulator.renderer.view().exposure(start_s, length_s));
    simulator.renderer.markers(&simulator.snapshot)
}

/// Sum of grey levels above dark in a window of 25 px around a place.
fn light_at(rendered: &Rendered, place: Pixel) -> f64 {
    let frame = rendered.image.view();
    let (u, v) = (place.u.round() as usize, place.v.round() as usize);
    (v - 12..=v + 12).flat_map(|v| &frame.row(v)[u - 12..=u + 12]).map(|&g| f64::from(g)).sum()
}

const AXIS: Pixel = Pixel { u: 375.5, v: 239.5 };

#[test]
fn the_light_of_a_far_led_is_that_of_a_hand_calculation() {
    let mut scene = scene(1000.0, &led("{ hover = { position_m = [10.0, 0.0, 3.0] } }", ""));
    scene.preset.sensor.read_noise_e = 0.0;
    scene.preset.sensor.dark_offset_dn = 20.0;
    // 200 mW / pi / (10 m)^2, pupil of 0.78 mm, 10.45 % passed, 1 ms, 5.029e-19 J per photon, QE 34 %, 60 electrons per level
    let irradiance = 0.2 / core::f64::consts::PI / 100.0;
    let watts = irradiance * core::f64::consts::PI * 0.39e-3 * 0.39e-3 * 0.1045;
    let levels = watts * 1e-3 / 5.028_9e-19 * 0.34 / 60.0;
    let dark = 25.0 * 25.0 * 20.0;
    let frames = 40;
    let mut simulator = Simulator::new(&scene, 0).unwrap();
    let mean = (0..frames).map(|n| light_at(&simulator.frame(n), AXIS) - dark).sum::<f64>()
        / f64::from(frames as u32);
    assert!((mean / levels - 1.0).abs() < 0.03, "{mean} not {levels}");
}

#[test]
fn a_moving_led_leaves_a_streak_of_its_way() {
    // 8 m away, 3 m/s across at the middle of the line: in 40 ms 0.12 m, 3.98 px by the linear law
    let motion = "{ line = { from_m = [8.0, 1.9099, 3.0], to_m = [8.0, -1.9099, 3.0], duration_s = 2.0 } }";
    let scene = scene(40_000.0, &led(motion, ""));
    let speed = core::f64::consts::PI / 2.0 / 2.0 * (2.0 * 1.9099);
    let expected_px = 265.442 * libm::atan(speed * 0.04 / 8.0);
    let mut simulator = Simulator::new(&scene, 0).unwrap();
    simulator.frame(20); // from 1.00 s on, just past the middle
    let charge = exposed(&mut simulator, 0.98, 0.04);
    let (mut sum, mut mean, mut square) = (0.0, 0.0, 0.0);
    for v in 0..480 {
        for (u, &e) in charge.row(v).iter().enumerate() {
            let (u, e) = (u as f64, f64::from(e));
            sum += e;
            mean += e * u;
            square += e * u * u;
        }
    }
    let variance = square / sum - (mean / sum) * (mean / sum);
    // a line of length L has variance L^2 / 12; point spread and pixel add theirs
    let spread = 0.5085 * 0.301 * 0.301 + 0.4915 * 2.239 * 2.239 + 1.0 / 12.0;
    let length_px = (12.0 * (variance - spread)).sqrt();
    assert!((length_px / expected_px - 1.0).abs() < 0.03, "{length_px} not {expected_px}");
    assert!((mean / sum - AXIS.u).abs() < 0.02);
}

#[test]
fn rows_of_a_rolling_shutter_see_a_mover_later() {
    let motion = "{ line = { from_m = [8.0, 1.9099, 3.0], to_m = [8.0, -1.9099, 3.0], duration_s = 2.0 } }";
    let mut scene = scene(1000.0, &led(motion, ""));
    let mean_u = |scene: &Scene| {
        let mut simulator = Simulator::new(scene, 0).unwrap();
        let charge = exposed(&mut simulator, 1.0, 1e-3);
        let row = (238..242).flat_map(|v| charge.row(v).iter().enumerate());
        let (sum, mean) =
            row.fold((0.0, 0.0), |(s, m), (u, &e)| (s + f64::from(e), m + f64::from(e) * u as f64));
        mean / sum
    };
    let global = mean_u(&scene);
    scene.preset.sensor.shutter = Shutter::Rolling { line_s: 50e-6 };
    let delay_s = 50e-6 * 239.5;
    let expected_px = 265.442 * libm::atan(3.0 * delay_s / 8.0);
    assert!((mean_u(&scene) - global - expected_px).abs() < 0.03, "{} {global}", mean_u(&scene));
}

#[test]
fn an_led_gives_the_share_of_its_light_that_its_code_leaves() {
    let motion = "{ hover = { position_m = [10.0, 0.0, 3.0] } }";
    // bits of 1/60 s; the third of the word is on, from 33.3 ms on
    let blink = "blink = { codes = \"codes/two-words.txt\", rate_hz = 60.0, shift_s = 0.0328333333 }";
    let always = first(&scene(1000.0, &led(motion, "")));
    let half = first(&scene(1000.0, &led(motion, blink)));
    let off = first(&scene(1000.0, &led(motion, &blink.replace("0.0328333333", "0.0"))));
    let (always_dn, half_dn) = (light_at(&always, AXIS), light_at(&half, AXIS));
    let off_dn = light_at(&off, AXIS);
    assert!(((half_dn - off_dn) / (always_dn - off_dn) - 0.5).abs() < 0.06, "{off_dn} {half_dn} {always_dn}");
    assert_eq!((always.truth.neighbours[0].leds.len(), off.truth.neighbours[0].leds.len()), (1, 0));
}

#[test]
fn truth_is_where_the_camera_model_has_the_leds_and_gravity_points_down() {
    let rest = "pitch_deg = 20.0\nroll_deg = 10.0\n[[target]]\nid = 9\nairframe = \"airframes/hexarotor-0.4.toml\"\n\
                motion = { circle = { centre_m = [6.0, 0.5, 2.0], radius_m = 1.0, speed_m_s = 3.0 } }\n";
    let scene = scene(1000.0, rest);
    let rendered = Simulator::new(&scene, 0).unwrap().frame(7);
    let truth = &rendered.truth.neighbours[0];
    assert!((rendered.truth.time_s - 0.3505).abs() < 1e-12);
    let [x, y, z, w] = truth.orientation_xyzw;
    let camera_from_body = UnitQuaternion::new_normalize(Quaternion::new(w, x, y, z));
    let seen_from = camera_from_body.inverse() * -Vector3::from(truth.position_m);
    assert!(truth.leds.len() >= 2);
    for led in &truth.leds {
        let on_body = &scene.targets[0].airframe.leds()[led.led.unwrap() as usize];
        assert!(on_body.intensity(&seen_from) > 0.0);
        let seen_m = camera_from_body * on_body.position_m + Vector3::from(truth.position_m);
        let pixel = scene.cameras[0].camera.pixel(&Bearing::new(seen_m).unwrap()).unwrap();
        assert!(libm::hypot(pixel.u - led.u_px, pixel.v - led.v_px) < 1e-9);
    }
    // pitched 20 deg down, then rolled: down is ahead by sin 20 deg
    let gravity = rendered.gravity;
    let (sin, cos) = libm::sincos(20.0_f64.to_radians());
    assert!((gravity.z - sin).abs() < 1e-12, "{gravity:?}");
    assert!((gravity.y - cos * libm::cos(10.0_f64.to_radians())).abs() < 1e-12);
}

#[test]
fn an_airframe_hides_the_led_behind_it() {
    let behind = led("{ hover = { position_m = [8.0, 0.0, 3.0] } }", "");
    let hub = "solid = [{ sphere = { centre_m = [0.0, 0.0, 0.0], radius_m = 0.15 } }]\n";
    let front = |y_m: f64| {
        format!(
            "[[target]]\nid = 2\nairframe = \"airframes/hexarotor-0.4.toml\"\n\
             motion = {{ hover = {{ position_m = [4.0, {y_m}, 3.0] }} }}\n{hub}"
        )
    };
    let leds_behind =
        |y_m: f64| first(&scene(1000.0, &format!("{behind}{}", front(y_m)))).truth.neighbours[0].leds.len();
    assert_eq!([leds_behind(0.0), leds_behind(0.14), leds_behind(0.16)], [0, 0, 1]);
}

#[test]
fn water_shows_each_marker_upside_down_and_dimmer() {
    let water = "[water]\nlevel_m = 0.0\nwind_m_s = 0.0\n";
    let scene = scene(1000.0, &led("{ hover = { position_m = [6.0, 0.0, 3.0] } }", water));
    let mut simulator = Simulator::new(&scene, 0).unwrap();
    let charge = exposed(&mut simulator, 0.0, 1e-3);
    let (mut direct_e, mut mirrored_e, mut row) = (0.0, 0.0, 0.0);
    for v in 0..480 {
        let sum: f64 = charge.row(v).iter().map(|&e| f64::from(e)).sum();
        if v < 350 {
            direct_e += sum;
        } else {
            mirrored_e += sum;
            row += sum * v as f64;
        }
    }
    // 3 m above and 3 m below, 6 m ahead: 45 deg. Twice the square of the distance, the lobe, the illumination, Fresnel.
    let expected =
        0.5 * core::f64::consts::FRAC_1_SQRT_2 * 0.9 * Water::reflectance(core::f64::consts::FRAC_1_SQRT_2);
    assert!(
        (mirrored_e / direct_e / expected - 1.0).abs() < 0.02,
        "{} not {expected}",
        mirrored_e / direct_e
    );
    assert!((row / mirrored_e - AXIS.v - 265.442 * core::f64::consts::FRAC_PI_4).abs() < 0.2);
}

#[test]
fn the_sun_is_a_saturated_disc_where_it_stands() {
    let rest = format!(
        "yaw_deg = -120.0\npitch_deg = -40.0\n[daylight]\nsky = \"clear\"\nlatitude_deg = 50.0\nlongitude_deg = 14.4\n\
         time = 2018-05-10T10:00:00Z\n{}",
        led("{ hover = { position_m = [6.0, 0.0, 3.0] } }", "")
    );
    let scene = scene(1000.0, &rest);
    let world_from_camera = scene.observer.pose(0.0) * scene.cameras[0].body_from_camera;
    let towards = scene.daylight.unwrap().sun().unwrap().into_inner();
    let place = scene.cameras[0]
        .camera
        .pixel(&Bearing::new(world_from_camera.rotation.inverse() * towards).unwrap())
        .unwrap();
    let image = first(&scene).image;
    let saturated: Vec<(f64, f64)> = (0..480)
        .flat_map(|v| {
            image
                .view()
                .row(v)
                .iter()
                .enumerate()
                .filter(|(_, g)| **g == 255)
                .map(move |(u, _)| (u as f64, v as f64))
                .collect::<Vec<_>>()
        })
        .collect();
    let count = saturated.len() as f64;
    let centre =
        saturated.iter().fold((0.0, 0.0), |(u, v), place| (u + place.0 / count, v + place.1 / count));
    assert!(libm::hypot(centre.0 - place.u, centre.1 - place.v) < 0.5, "{centre:?} {place:?}");
    assert!((2000.0..20_000.0).contains(&count), "40 px wide and more: {count}");
}

#[test]
fn a_frame_is_the_same_whoever_renders_it_and_when() {
    let scene =
        Scene::read(Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/swarm-12.toml"))).unwrap();
    let mut one = Simulator::new(&scene, 0).unwrap();
    let in_order: Vec<Rendered> = (0..4).map(|n| one.frame(n)).collect();
    assert_eq!(Simulator::new(&scene, 0).unwrap().frame(2), in_order[2], "alone");
    for threads in [1, 3] {
        let mut taken = Vec::new();
        let take = |rendered| -> Result<(), ()> {
            taken.push(rendered);
            Ok(())
        };
        Simulator::new(&scene, 0).unwrap().render(0..4, threads, take).unwrap();
        assert_eq!(taken, in_order, "{threads} threads");
    }
    let refused =
        Simulator::new(&scene, 0).unwrap().render(0..400, 2, |rendered| match rendered.truth.frame {
            3 => Err("enough"),
            _ => Ok(()),
        });
    assert_eq!(refused, Err("enough"));
    let mut other = scene.clone();
    other.set_seed(2);
    assert_ne!(Simulator::new(&other, 0).unwrap().frame(0).image, in_order[0].image);
    let leds: usize = in_order[0].truth.neighbours.iter().map(|neighbour| neighbour.leds.len()).sum();
    assert!(leds >= 24, "{leds} LEDs of twelve hexarotors are in view");
}

#[test]
fn rows_of_a_rolling_shutter_see_a_later_bit() {
    let motion = "{ hover = { position_m = [10.0, 0.0, 3.0] } }";
    // the third bit of the word begins at 33.3 ms: 6 ms after the frame does, 6 ms before its middle row is exposed
    let blink = "blink = { codes = \"codes/two-words.txt\", rate_hz = 60.0, shift_s = 0.0273333333 }";
    let mut scene = scene(1000.0, &led(motion, blink));
    let light = |scene: &Scene| exposed(&mut Simulator::new(scene, 0).unwrap(), 0.0, 1e-3).total();
    let global_e = light(&scene);
    scene.preset.sensor.shutter = Shutter::Rolling { line_s: 50e-6 };
    let rolling_e = light(&scene);
    assert!(global_e <= 0.0 && rolling_e > 100.0, "{global_e} {rolling_e}");
}
