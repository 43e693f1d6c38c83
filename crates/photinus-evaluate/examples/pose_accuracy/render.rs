//! Random views of a neighbour as frames, by the simulator with the paper's camera.

use std::path::Path;

use nalgebra::{Isometry3, Rotation3, Translation3, UnitQuaternion, Vector3};
use photinus::airframe::Airframe;
use photinus::spots::Noise;
use photinus_sim::motion::{Motion, Recorded};
use photinus_sim::optics::{Gaussian, PointSpread};
use photinus_sim::preset::Preset;
use photinus_sim::{Rendered, Scene, Simulator};
use rand_pcg::Pcg64;

use crate::view::View;

/// Frames whose LEDs are the same units.
pub(crate) const BATCH: usize = 50;

/// What frames are taken with.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Setup {
    pub(crate) name: &'static str,
    preset: &'static str,
    camera: &'static str,
    exposure_us: f64,
    pub(crate) ranges_m: &'static [f64],
    change: fn(&mut Preset),
}

/// The paper's camera.
pub(crate) const PAPER: Setup = Setup {
    name: "paper",
    preset: "bluefox-dsl215-bp365",
    camera: "bluefox-dsl215",
    exposure_us: 1000.0,
    ranges_m: &[2.0, 5.0, 10.0, 15.0],
    change: |_| (),
};

/// Cameras that differ from it in one thing or in many.
pub(crate) const OTHERS: [Setup; 6] = [
    Setup { name: "three times the exposure", exposure_us: 3000.0, ..PAPER },
    Setup {
        name: "core of 0.5 px",
        change: |preset| preset.lens.spread = spread([(0.5085, 0.5), (0.4915, 2.239)]),
        ..PAPER
    },
    Setup {
        name: "a fifth in a skirt of 3 px",
        change: |preset| preset.lens.spread = spread([(0.8, 0.35), (0.2, 3.0)]),
        ..PAPER
    },
    Setup {
        name: "five times the gain, a fifth of the light",
        exposure_us: 200.0,
        change: |preset| {
            preset.sensor.electrons_per_dn /= 5.0;
            preset.sensor.full_well_e /= 5.0;
        },
        ..PAPER
    },
    Setup { name: "read noise of 2 levels", change: |preset| preset.sensor.read_noise_e *= 4.0, ..PAPER },
    Setup {
        name: "small fisheye",
        preset: "small-fisheye-960x600",
        camera: "small-fisheye-960x600",
        exposure_us: 5000.0,
        ranges_m: &[2.0, 5.0, 10.0],
        change: |_| (),
    },
];

fn spread(parts: [(f64, f64); 2]) -> PointSpread {
    let part = |(share, sigma_px)| Gaussian { share, sigma_px };
    PointSpread::new(parts.map(part).to_vec(), 0.1).expect("shares that sum to 1")
}

/// A scene with one target; `None` for its poses leaves it hovering.
pub(crate) fn scene(setup: &Setup, airframe: &str, seed: u64, poses: Option<Recorded>) -> Scene {
    let Setup { preset, camera, exposure_us, .. } = setup;
    let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes"));
    let text = format!(
        r#"name = "poses"
        seed = {seed}
        preset = "{preset}"
        rate_hz = 1.0
        duration_s = {BATCH}.0
        exposure_us = {exposure_us:.1}
        [observer]
        motion = {{ hover = {{ position_m = [0.0, 0.0, 0.0] }} }}
        wind_m_s = 0.0
        heading_deg = 0.0
        [[camera]]
        name = "front"
        file = "cameras/{camera}.toml"
        position_m = [0.0, 0.0, 0.0]
        [[target]]
        id = 1
        airframe = "airframes/{airframe}.toml"
        motion = {{ hover = {{ position_m = [5.0, 0.0, 0.0] }} }}
        solid = [{{ cylinder = {{ centre_m = [0.0, 0.0, 0.0], radius_m = 0.12, half_height_m = 0.08 }} }}]
        "#
    );
    let mut scene = Scene::parse(&text, folder.join("poses.toml")).expect("a scene");
    (setup.change)(&mut scene.preset);
    if let Some(poses) = poses {
        scene.targets[0].motion = Motion::Recorded(poses);
    }
    scene
}

/// The noise of the pixels, as the sensor's data would tell it.
pub(crate) fn noise(setup: &Setup) -> Noise {
    let sensor = scene(setup, "hexarotor-0.4", 0, None).preset.sensor;
    let mut noise = Noise::default();
    noise.read_dn = sensor.read_noise_e / sensor.electrons_per_dn;
    noise.shot = 1.0 / sensor.electrons_per_dn;
    noise
}

/// A batch of frames with a neighbour each, at random poses.
pub(crate) fn batch(
    setup: &Setup,
    airframe: &Airframe,
    distance_m: f64,
    seed: u64,
    rng: &mut Pcg64,
) -> Vec<(View, Rendered)> {
    let world_from_camera = Rotation3::from_basis_unchecked(&[-Vector3::y(), -Vector3::z(), Vector3::x()]);
    let views: Vec<View> = (0..BATCH).map(|_| View::draw(distance_m, rng)).collect();
    let pose = |view: &View| {
        let turn = UnitQuaternion::from_rotation_matrix(&(world_from_camera * view.camera_from_body));
        Isometry3::from_parts(Translation3::from(world_from_camera * view.position_m), turn)
    };
    let poses = Recorded::held(views.iter().map(pose), 1.0);
    let scene = scene(setup, airframe.name(), seed, poses);
    let mut simulator = Simulator::new(&scene, 0).expect("a camera");
    views.into_iter().zip(simulator.frames()).collect()
}
