//! What a swarm does: its own states, its own snapshots, no scene.

use std::path::Path;
use std::sync::Arc;

use nalgebra::{Isometry3, UnitQuaternion, Vector3};
use photinus_sim::snapshot::{Kinematics, LedLight, Lit, Moving, Vehicle};
use photinus_sim::{CameraView, Rendered, Renderer, Scene, Simulator, Snapshot};

const SCENE: &str = "name = \"test\"\nseed = 5\npreset = \"bluefox-dsl215-bp365\"\nrate_hz = 20.0\nduration_s = 2.0\n\
     exposure_us = 20000.0\n[observer]\nmotion = { hover = { position_m = [0.0, 0.0, 3.0] } }\n\
     [[camera]]\nname = \"front\"\nfile = \"cameras/bluefox-dsl215.toml\"\n[[target]]\nid = 1\n\
     airframe = \"airframes/single-led.toml\"\nheading_deg = 180.0\n\
     motion = { line = { from_m = [8.0, 1.9099, 3.0], to_m = [8.0, -1.9099, 3.0], duration_s = 2.0 } }\n";

/// A scene whose LEDs are all mean ones.
fn scene() -> Scene {
    let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/test.toml"));
    let mut scene = Scene::parse(SCENE, path).unwrap_or_else(|error| panic!("{error}"));
    scene.preset.emitter.unit_spread = 0.0;
    scene
}

fn renderer(scene: &Scene) -> Renderer {
    let view = CameraView {
        camera: scene.cameras[0].camera.clone(),
        lens: scene.preset.lens.clone(),
        sensor: scene.preset.sensor.clone(),
    };
    Renderer::new(view, scene.seed)
}

fn snapshot(scene: &Scene, renderer: &Renderer, start_s: f64, motion: Moving) -> Snapshot {
    Snapshot {
        exposure: renderer.view().exposure(start_s, 0.02),
        camera: Moving::still(scene.observer.pose(0.0) * scene.cameras[0].body_from_camera),
        vehicles: vec![Vehicle {
            id: 1,
            airframe: Arc::new(scene.targets[0].airframe.clone()),
            solids: Arc::new([]),
            looks: Arc::default(),
            motion,
            leds: vec![LedLight::steady()],
        }],
        emitter: scene.preset.emitter,
        daylight: None,
        water: None,
        lamps: Vec::new(),
    }
}

#[test]
fn a_snapshot_made_by_hand_gives_the_frame_of_the_scene() {
    let scene = scene();
    let mut renderer = renderer(&scene);
    // the line is an arc of a cosine: its place, speed and acceleration by hand, integrated to 0.96 s from before
    let (omega, half_m) = (core::f64::consts::FRAC_PI_2, 1.9099);
    let (sin, cos) = libm::sincos(omega * 0.96);
    let state = Kinematics {
        pose: scene.targets[0].motion.pose(0.96),
        velocity_m_s: Vector3::y() * (-half_m * omega * sin),
        acceleration_m_s2: Vector3::y() * (-half_m * omega * omega * cos),
        turn_rad_s: Vector3::zeros(),
    };
    let snapshot = snapshot(&scene, &renderer, 0.95, state.during(-0.01, 0.02));
    // a driver may well live in a thread of its own
    let by_hand = std::thread::spawn(move || renderer.render(&snapshot, 19)).join().unwrap();
    let by_scene = Simulator::new(&scene, 0).unwrap().frame(19);
    let (hand, scene) = (&by_hand.truth.neighbours[0], &by_scene.truth.neighbours[0]);
    assert!((Vector3::from(hand.position_m) - Vector3::from(scene.position_m)).norm() < 1e-9);
    assert!((hand.leds[0].u_px - scene.leds[0].u_px).abs() < 1e-6);
    let pixels = |rendered: &Rendered| rendered.image.pixels().to_vec();
    let differ = pixels(&by_hand).iter().zip(pixels(&by_scene)).filter(|(a, b)| a.abs_diff(*b) > 1).count();
    assert_eq!(differ, 0, "pixels of a streak that differ by more than a level");
    let bright = pixels(&by_hand).iter().filter(|level| **level > 60).count();
    assert!(bright > 5, "there is a streak: {bright} px");
}

#[test]
fn a_state_that_is_stepped_leaves_one_streak_over_its_frames() {
    let scene = scene();
    let mut renderer = renderer(&scene);
    let turned = UnitQuaternion::from_scaled_axis(Vector3::z() * core::f64::consts::PI);
    let mut state = Kinematics {
        pose: Isometry3::from_parts(Vector3::new(8.0, 0.5, 3.0).into(), turned),
        velocity_m_s: Vector3::new(0.0, -2.0, 0.5),
        acceleration_m_s2: Vector3::new(0.0, 4.0, 0.0),
        turn_rad_s: Vector3::zeros(),
    };
    let mut snapshot = snapshot(&scene, &renderer, 0.0, Moving::still(state.pose));
    let mut seen: Vec<f64> = Vec::new();
    for step in 0..10_u32 {
        let start_s = f64::from(step) * 0.02;
        snapshot.exposure.start_s = start_s;
        snapshot.vehicles[0].motion = state.during(0.0, 0.02);
        let truth = renderer.render(&snapshot, u64::from(step)).truth;
        let is_m = truth.neighbours[0].position_m;
        // at the middle of the exposure, from the start in one step: 0.5 - 2 t + 2 t^2 to the left
        let time_s = start_s + 0.01;
        assert!((is_m[0] + (0.5 - 2.0 * time_s + 2.0 * time_s * time_s)).abs() < 1e-12, "{is_m:?}");
        assert!((is_m[1] + 0.5 * time_s).abs() < 1e-12 && (truth.time_s - time_s).abs() < 1e-12);
        seen.push(truth.neighbours[0].leds[0].u_px);
        state.pose = state.after(0.02);
        state.velocity_m_s += state.acceleration_m_s2 * 0.02;
    }
    assert!(seen.windows(2).all(|pair| pair[0] < pair[1]), "{seen:?}");
}

#[test]
fn power_and_light_of_each_led_are_those_of_the_snapshot() {
    let scene = scene();
    let mut renderer = renderer(&scene);
    let mut snapshot = snapshot(&scene, &renderer, 0.0, Moving::still(scene.targets[0].motion.pose(1.0)));
    let sum = |rendered: Rendered| {
        let row =
            |v: usize| rendered.image.view().row(v)[360..392].iter().map(|g| f64::from(*g)).sum::<f64>();
        (224..256).map(row).sum::<f64>()
    };
    let mut light = |leds: Vec<LedLight>| {
        snapshot.vehicles[0].leds = leds;
        sum(renderer.render(&snapshot, 3))
    };
    let with = |power: f64, lit: Lit| vec![LedLight { power, lit }];
    let dark = light(with(1.0, Lit::never()));
    // a weak one, so that nothing saturates
    let weak = light(with(0.02, Lit::always())) - dark;
    let mut half = Lit::never();
    half.switch(0.01);
    assert!(weak > 100.0, "{weak}");
    assert!(((light(with(0.02, half)) - dark) / weak - 0.5).abs() < 0.1);
    assert!(((light(with(0.04, Lit::always())) - dark) / weak - 2.0).abs() < 0.1);
    assert!(((light(with(0.0, Lit::always())) - dark) / weak).abs() < 0.05, "a dead LED");
    assert!(((light(Vec::new()) - dark) / weak).abs() < 0.05, "one that is not told of is dark");
}
