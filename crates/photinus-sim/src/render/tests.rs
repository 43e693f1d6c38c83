//! Lamps, lobes, mirrors, the observer's own airframe, long streaks: frames against calculations of their own.

use std::path::Path;

use photinus::airframe::{self, Airframe, LobeTable};
use photinus::camera::Pixel;

use crate::cameras::worlds;
use crate::sensor::{Charge, ColumnSmear, Converter, Pattern};
use crate::{Rendered, Scene, Simulator};

const AXIS: Pixel = Pixel { u: 375.5, v: 239.5 };

/// A camera at the origin that looks east, and whatever `rest` says; no noise of LEDs, no hot pixels.
fn scene(rest: &str) -> Scene {
    let text = format!(
        "name = \"test\"\npreset = \"bluefox-dsl215-bp365\"\nrate_hz = 20.0\nduration_s = 2.0\nexposure_us = 1000.0\n\
         {rest}\n[observer]\nmotion = {{ hover = {{ position_m = [0.0, 0.0, 3.0] }} }}\n\
         [[camera]]\nname = \"front\"\nfile = \"cameras/bluefox-dsl215.toml\"\n"
    );
    let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/test.toml"));
    let mut scene = Scene::parse(&text, path).unwrap_or_else(|error| panic!("{error}"));
    scene.preset.emitter.unit_spread = 0.0;
    scene.preset.sensor.hot_pixel_share = 0.0;
    scene
}

/// A single LED 6 m ahead that faces the camera.
fn led(more: &str) -> String {
    format!(
        "[[target]]\nid = 1\nairframe = \"airframes/single-led.toml\"\nheading_deg = 180.0\n\
         motion = {{ hover = {{ position_m = [6.0, 0.0, 3.0] }} }}\n{more}\n"
    )
}

/// The light of a frame before noise and overflow, sum and centroid within a window of 41 px around a place.
fn light(scene: &Scene, around: Pixel) -> (f64, f64, f64) {
    let mut simulator = Simulator::new(scene, 0).unwrap();
    let charge = simulator.light_of(0);
    let (u, v) = (around.u.round() as usize, around.v.round() as usize);
    let (mut sum, mut at_u, mut at_v) = (0.0, 0.0, 0.0);
    for row in v - 20..=v + 20 {
        for column in u - 20..=u + 20 {
            let e = f64::from(charge.at(column, row));
            (sum, at_u, at_v) = (sum + e, at_u + e * column as f64, at_v + e * row as f64);
        }
    }
    (sum, at_u / sum, at_v / sum)
}

#[test]
fn a_target_shines_by_its_own_lobe_and_the_powers_of_its_leds() {
    let turned = |lobe: &str| led(lobe).replace("180.0", "120.0"); // 60 deg off its axis
    let sum = |rest: &str| light(&scene(rest), AXIS).0;
    let plain = sum(&turned(""));
    for (lobe, against) in [
        ("lobe = { cosine = 3.0 }", 0.25), // cos^3 over cos
        ("leds = { dead = [1] }\nlobe = \"omni\"", 2.0),
        ("lobe = { table = { step_deg = 40.0, intensity = [1.0, 0.6, 0.2] } }", 0.8),
        ("leds = { weak = [{ led = 0, power = 0.3 }] }", 0.3),
    ] {
        let share = sum(&turned(lobe)) / plain;
        assert!((share / against - 1.0).abs() < 2e-3, "{share} not {against}: {lobe}");
    }
    // what the airframe itself says: 60 deg off the axis cos^3 is 1/8, the table 0.4, the cosine 1/2
    let table = LobeTable::new(&[0.0, 80.0, 100.0].map(f64::to_radians), &[1.0, 0.2, 0.0]).unwrap();
    for (lobe, power, against) in
        [(airframe::Lobe::Cosine { power: 3.0 }, 0.5, 0.125), (airframe::Lobe::Table(table), 1.5, 1.2)]
    {
        let mut told = scene(&turned(""));
        let mut leds = told.targets[0].airframe.leds().to_vec();
        (leds[0].lobe, leds[0].power) = (lobe, power);
        told.targets[0].airframe = Airframe::new("told", leds).unwrap();
        let share = light(&told, AXIS).0 / plain;
        assert!((share / against - 1.0).abs() < 2e-3, "{share} not {against}");
    }
    let dead = scene(&led("leds = { dead = [0] }"));
    let rendered = Simulator::new(&dead, 0).unwrap().frame(0);
    assert!(rendered.truth.neighbours[0].leds.is_empty() && light(&dead, AXIS).0 <= 0.0);
}

#[test]
fn truth_has_misplaced_markers_where_they_are() {
    let of = |leds: &str| {
        let scene = scene(&led(leds));
        let rendered = Simulator::new(&scene, 0).unwrap().frame(0);
        let (_, u, v) = light(&scene, AXIS);
        let truth = rendered.truth.neighbours[0].leds[0].clone();
        // the centroid of a core of 0.3 px is pulled towards pixel centres by up to 0.03 px
        assert!(libm::hypot(truth.u_px - u, truth.v_px - v) < 0.08, "{truth:?} {u} {v}");
        (truth.u_px, truth.v_px, rendered.truth.neighbours[0].position_m)
    };
    let (should, is) = (of(""), of("leds = { misplaced_m = 0.02 }"));
    let off_px = libm::hypot(should.0 - is.0, should.1 - is.1);
    // 2 cm at 6 m are 0.9 px
    assert!((0.1..4.0).contains(&off_px), "{off_px}");
    assert!((should.2[2] - is.2[2]).abs() < 1e-12, "the vehicle is where it was");
}

#[test]
fn lamps_shine_as_leds_do_and_move_with_what_they_are_beside() {
    let lamp = |more: &str| format!("[[lamp]]\n{more}\n{}", led("leds = { dead = [0, 1] }"));
    let lone = light(&scene(&led("")), AXIS);
    let fixed = light(&scene(&lamp("position_m = [3.0, 0.0, 3.0]\npower = 0.25\nradius_m = 0.0005")), AXIS);
    assert!((fixed.0 / lone.0 - 1.0).abs() < 1e-3, "a quarter at half the distance: {}", fixed.0 / lone.0);
    // 1 m to the left of a body that looks back at the camera is to the camera's right
    let beside = lamp("position_m = [0.0, 1.0, 0.0]\nbeside = 1");
    let place = Pixel::new(AXIS.u + 265.442 * libm::atan(1.0 / 6.0), AXIS.v);
    let (sum, u, _) = light(&scene(&beside), place);
    assert!(sum > 0.0 && (u - place.u).abs() < 0.05, "{u} not {}", place.u);
    let truth = Simulator::new(scene(&beside), 0).unwrap().frame(0).truth;
    assert!(truth.neighbours[0].leds.is_empty(), "a lamp is no marker");
}

#[test]
fn a_plate_shows_an_led_again_as_far_as_it_is_and_a_ball_much_dimmer() {
    // a plate a meter below the LED that faces up
    let plate = "mirror = [{ plate = { centre_m = [1.0, 0.0, -1.0], normal = [0.0, 0.0, 1.0], radius_m = 4.0, reflectance = 1.0 } }]";
    let omni = "leds = { dead = [1] }\nlobe = \"omni\"\n";
    let lone = light(&scene(&led(omni)), AXIS).0;
    let place = Pixel::new(AXIS.u, AXIS.v + 265.442 * libm::atan(2.0 / 6.0));
    let (sum, u, v) = light(&scene(&led(&format!("{omni}{plate}"))), place);
    // the image 2 m below: the square of the distance, and what the lens passes at that angle
    let angle = libm::atan(2.0 / 6.0) / core::f64::consts::FRAC_PI_2;
    let expected = 36.0 / 40.0 * (1.0 - 0.4 * angle * angle);
    assert!((sum / lone / expected - 1.0).abs() < 2e-3, "{sum} {lone}");
    assert!((u - place.u).abs() < 0.1 && (v - place.v).abs() < 0.1, "{u} {v} not {place:?}");
    let ball = "mirror = [{ sphere = { centre_m = [0.0, 0.5, 0.0], radius_m = 0.05, reflectance = 0.5 } }]";
    let side = Pixel::new(AXIS.u + 265.442 * libm::atan(0.47 / 6.0), AXIS.v);
    let (sum, ..) = light(&scene(&led(&format!("{omni}{ball}"))), side);
    let (near, ..) = light(&scene(&led(omni)), side);
    let share = (sum - near) / lone;
    // R r^2 / 4 d^2 at half a metre, 1/800: about, with more reflectance and less width aside
    assert!((0.8..1.8).contains(&(share * 800.0)), "{share}");
}

#[test]
fn a_vehicle_before_the_sun_takes_its_light_away() {
    let day = "[daylight]\nsky = \"clear\"\nlatitude_deg = 50.0\nlongitude_deg = 14.4\ntime = 2018-05-10T17:30:00Z\n";
    let mut bare = scene(&format!("{day}{}", led("")));
    let sun = bare.daylight.unwrap().sun().unwrap().into_inner();
    // the camera looks at the sun, 8 deg above the horizon in the west
    bare.cameras[0].body_from_camera.rotation =
        nalgebra::UnitQuaternion::face_towards(&sun, &-nalgebra::Vector3::z());
    let saturated = |scene: &Scene| {
        let image = Simulator::new(scene, 0).unwrap().frame(0).image;
        image.pixels().iter().filter(|grey| **grey == 255).count()
    };
    let free = saturated(&bare);
    let with_ball = |aside_rad: f64, radius_m: f64| {
        let mut scene = bare.clone();
        let side = sun.cross(&nalgebra::Vector3::z()).normalize();
        let place_m = nalgebra::Vector3::new(0.0, 0.0, 3.0) + (sun + side * aside_rad) * 20.0;
        scene.targets[0].motion = crate::motion::Motion::Flown(crate::motion::Flight {
            path: crate::motion::Path::Hover { position_m: place_m },
            wander: crate::motion::Wander::new(0.0, 1),
            heading_rad: 0.0,
            spins: Vec::new(),
        });
        let centre_m = nalgebra::Vector3::zeros();
        scene.targets[0].solids = vec![crate::occlusion::Solid::Sphere { centre_m, radius_m }];
        saturated(&scene)
    };
    assert!(free > 200, "{free}");
    assert_eq!(with_ball(0.0, 0.2), 0, "a ball of twice the sun's size");
    assert_eq!(with_ball(0.02, 0.2), free, "beside it");
    let half = with_ball(4.65e-3, 4.65e-3 * 20.0 * 1.05) as f64 / free as f64;
    assert!((0.3..0.9).contains(&half), "a ball of the sun's size, half across: {half}");
}

#[test]
fn the_own_airframe_hides_what_is_behind_it_and_its_edge_shines() {
    let arm = "[own_airframe]\nbrightness = 0.0\nsolid = [{ sphere = { centre_m = [0.5, 0.0, 0.0], radius_m = 0.05 } }]\n";
    let hidden = scene(&format!("{arm}{}", led("")));
    assert!(Simulator::new(&hidden, 0).unwrap().frame(0).truth.neighbours[0].leds.is_empty());
    assert!(light(&hidden, AXIS).0 <= 0.0);
    let day = "[daylight]\nsky = \"overcast\"\nlatitude_deg = 50.0\nlongitude_deg = 14.4\ntime = 2018-05-10T10:00:00Z\n";
    let mean = |rendered: &Rendered, above: usize| {
        let row = &rendered.image.view().row(240 - above)[370..382];
        row.iter().map(|&grey| f64::from(grey)).sum::<f64>() / 12.0
    };
    let frame = |rest: &str| Simulator::new(scene(rest), 0).unwrap().frame(0);
    let sky = "leds = { dead = [0, 1] }";
    let (free, dark) = (frame(&format!("{day}{}", led(sky))), frame(&format!("{day}{arm}{}", led(sky))));
    let half = frame(&format!("{day}{}{}", arm.replace("= 0.0\n", "= 0.5\n"), led(sky)));
    // the ball is 0.1 rad wide to either side: 26 px
    let dark_current_dn = 1000.0 * 1e-3 / 60.0;
    assert!(mean(&dark, 20) < 0.6 + dark_current_dn, "{}", mean(&dark, 20));
    assert!((mean(&dark, 30) - mean(&free, 30)).abs() < 0.5);
    assert!((mean(&half, 20) - 0.5 * mean(&free, 20)).abs() < 0.5, "{} {}", mean(&half, 20), mean(&free, 20));
    // an edge of 0.2 m across the view, a meter ahead
    let edge = "[own_airframe]\nedge = [{ from_m = [1.0, 0.1, 0.0], to_m = [1.0, -0.1, 0.0], power_per_m = 0.01 }]\n";
    let charge = Simulator::new(scene(&format!("{edge}{}", led(sky))), 0).unwrap().light_of(0);
    let (sum, lone) = (charge.total(), light(&scene(&led("")), AXIS).0);
    // 2 mm of an LED's light at 1 m against all of it at 6 m
    assert!((sum / lone / (0.002 * 36.0) - 1.0).abs() < 0.01, "{}", sum / lone);
    let row: Vec<f64> = (0..752).map(|u| (230..250).map(|v| f64::from(charge.at(u, v))).sum()).collect();
    let lit = row.iter().filter(|e| **e > 0.5 * row[375]).count() as f64;
    assert!((lit - 2.0 * 265.442 * libm::atan(0.1)).abs() < 2.0, "{lit} columns");
}

#[test]
fn a_streak_of_many_pixels_has_no_gaps_and_all_its_light() {
    let fast = led("").replace(
        "hover = { position_m = [6.0, 0.0, 3.0] }",
        "line = { from_m = [6.0, -30.0, 3.0], to_m = [6.0, 30.0, 3.0], duration_s = 1.0 }",
    );
    let mut scene = scene(&fast);
    scene.exposure_us = 49_000.0;
    scene.targets[0].lobe = Some(crate::source::Lobe::Omni);
    let charge = Simulator::new(&scene, 0).unwrap().light_of(10); // at the middle of the line from 0.5 s on
    let columns: Vec<f64> = (0..752).map(|u| (200..280).map(|v| f64::from(charge.at(u, v))).sum()).collect();
    let lit: Vec<usize> = (0..752).filter(|u| columns[*u] > 0.2 * columns[340]).collect();
    let length = lit.len();
    // the line is an arc of a sine: from its middle on 30 m times sin(49 ms pi) aside, 6 m away
    let way_px = 265.442 * libm::atan(5.0 * libm::sin(0.049 * core::f64::consts::PI));
    assert!((length as f64 - way_px).abs() < 4.0, "{length} not {way_px}");
    assert!(lit[length - 1] - lit[0] + 1 == length, "{length} columns without a gap");
    // the way is short of the LED's own pull: neighbours differ by the speed on the arc alone
    for pair in lit[8..length - 8].windows(2) {
        assert!((columns[pair[1]] / columns[pair[0]] - 1.0).abs() < 0.05, "{} {}", pair[0], columns[pair[0]]);
    }
}

#[test]
fn every_camera_renders_the_same_whatever_the_number_of_threads() {
    for world in worlds() {
        let mut scene = scene(&led(""));
        world.install(&mut scene);
        // all the effects that a camera may have, besides
        let sensor = &mut scene.preset.sensor;
        sensor.smear = ColumnSmear { share: 1e-4 };
        sensor.pattern = Pattern { offset_dn: 0.5, column_offset_dn: 0.2, gain: 0.01, well: 0.01 };
        sensor.converter = Converter::new(10).unwrap();
        let mut one = Simulator::new(&scene, 0).unwrap();
        let in_order: Vec<Rendered> = (0..2).map(|number| one.frame(number)).collect();
        let mut taken = Vec::new();
        let take = |rendered| -> Result<(), ()> {
            taken.push(rendered);
            Ok(())
        };
        Simulator::new(&scene, 0).unwrap().render(0..2, 2, take).unwrap();
        assert_eq!(taken, in_order, "{}", world.name);
        assert_eq!(in_order[0].truth.neighbours[0].leds.len(), 1, "{}", world.name);
        assert!(in_order[0].image.pixels().iter().any(|grey| *grey > 60), "{} shows its LED", world.name);
    }
}

#[test]
fn light_is_conserved_by_every_point_spread() {
    for world in worlds() {
        let mut scene = scene(&led(""));
        world.install(&mut scene);
        scene.preset.emitter.unit_spread = 0.0;
        let preset = &scene.preset;
        let irradiance = preset.emitter.irradiance_w_m2(1.0, 6.0);
        let power_w = preset.lens.gathered_w(irradiance, 0.0);
        let all_e = preset.sensor.photo_electrons(power_w, 1e-3, preset.emitter.photon_j());
        let charge: Charge = Simulator::new(&scene, 0).unwrap().light_of(0);
        assert!((charge.total() / all_e - 1.0).abs() < 4e-3, "{} {all_e}: {}", charge.total(), world.name);
    }
}
