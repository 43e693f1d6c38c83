//! Random views of a neighbour as frames, by the simulator with the paper's camera.

use std::path::Path;

use nalgebra::{Isometry3, Rotation3, Translation3, UnitQuaternion, Vector3};
use photinus::airframe::Airframe;
use photinus_io::image::GreyImage;
use photinus_sim::motion::{Motion, Recorded};
use photinus_sim::{Scene, Simulator};
use rand_pcg::Pcg64;

use crate::view::View;

/// Frames whose LEDs are the same units.
const BATCH: usize = 50;

/// A scene with one target; `None` for its poses leaves it hovering.
pub(crate) fn scene(airframe: &str, seed: u64, poses: Option<Recorded>) -> Scene {
    let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes"));
    let text = format!(
        r#"name = "poses"
        seed = {seed}
        preset = "bluefox-dsl215-bp365"
        rate_hz = 1.0
        duration_s = {BATCH}.0
        exposure_us = 1000.0
        [observer]
        motion = {{ hover = {{ position_m = [0.0, 0.0, 0.0] }} }}
        wind_m_s = 0.0
        heading_deg = 0.0
        [[camera]]
        name = "front"
        file = "cameras/bluefox-dsl215.toml"
        position_m = [0.0, 0.0, 0.0]
        [[target]]
        id = 1
        airframe = "airframes/{airframe}.toml"
        motion = {{ hover = {{ position_m = [5.0, 0.0, 0.0] }} }}
        solid = [{{ cylinder = {{ centre_m = [0.0, 0.0, 0.0], radius_m = 0.12, half_height_m = 0.08 }} }}]
        "#
    );
    let mut scene = Scene::parse(&text, folder.join("poses.toml")).expect("a scene");
    if let Some(poses) = poses {
        scene.targets[0].motion = Motion::Recorded(poses);
    }
    scene
}

/// A batch of frames with a neighbour each, at random poses.
pub(crate) fn batch(
    airframe: &Airframe,
    distance_m: f64,
    seed: u64,
    rng: &mut Pcg64,
) -> Vec<(View, GreyImage)> {
    let world_from_camera = Rotation3::from_basis_unchecked(&[-Vector3::y(), -Vector3::z(), Vector3::x()]);
    let views: Vec<View> = (0..BATCH).map(|_| View::draw(distance_m, rng)).collect();
    let pose = |view: &View| {
        let turn = UnitQuaternion::from_rotation_matrix(&(world_from_camera * view.camera_from_body));
        Isometry3::from_parts(Translation3::from(world_from_camera * view.position_m), turn)
    };
    let poses = Recorded::held(views.iter().map(pose), 1.0);
    let scene = scene(airframe.name(), seed, poses);
    let mut simulator = Simulator::new(&scene, 0).expect("a camera");
    let frames: Vec<_> = simulator.frames().map(|frame| frame.image).collect();
    views.into_iter().zip(frames).collect()
}
