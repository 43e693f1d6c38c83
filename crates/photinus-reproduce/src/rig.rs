//! The parts of a scene, rearranged for experiments: one LED that recedes, an airframe at given poses.

use nalgebra::{Isometry3, Point3, Translation3, Unit, UnitQuaternion, Vector3};
use photinus::airframe::{Airframe, Led, Lobe, RingGeometry};
use photinus::camera::{Bearing, Camera, Ideal, IdealLaw, Model, Pixel};
use photinus::ranging::AdjacentPair;
use photinus_sim::Scene;
use photinus_sim::motion::{Motion, Recorded};
use photinus_sim::scene::{MountedCamera, Target};

use crate::ReproduceError;

/// Between poses that are held, s: as long as an exposure can be, and longer.
const POSE_S: f64 = 1.0;
/// Side of the image in which one LED recedes, px: room for a spot of 10 ms at half a metre, and for its surroundings.
const CUT_PX: usize = 96;

/// A scene's first camera and first target, with what the paper's equations need of them.
#[derive(Clone, Debug)]
pub struct Rig {
    scene: Scene,
    rad_per_px: f64,
    ring: RingGeometry,
}

impl Rig {
    /// The rig of a scene with a camera, and with a ring of markers for a target.
    ///
    /// # Errors
    /// [`ReproduceError`] for a scene of another kind.
    pub fn new(scene: Scene) -> Result<Self, ReproduceError> {
        let camera = &scene.cameras.first().ok_or(ReproduceError::Lacks("camera"))?.camera;
        let target = scene.targets.first().ok_or(ReproduceError::Lacks("target"))?;
        let ring = target.airframe.ring().ok_or(ReproduceError::NoRing)?;
        let ahead = Bearing::new(Vector3::z()).and_then(|axis| camera.pixel(&axis));
        let rad_per_px = ahead.and_then(|pixel| camera.rad_per_px(pixel)).ok_or(ReproduceError::Axis)?;
        Ok(Self { rad_per_px, ring, scene })
    }

    /// The scene as it was given.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    pub(crate) fn camera(&self) -> &Camera {
        &self.scene.cameras[0].camera
    }

    pub(crate) fn airframe(&self) -> &Airframe {
        &self.scene.targets[0].airframe
    }

    /// k of the paper's (1), rad/px: the angle per pixel at the axis.
    pub(crate) fn rad_per_px(&self) -> f64 {
        self.rad_per_px
    }

    /// Two neighbouring markers of the target.
    pub(crate) fn pair(&self) -> AdjacentPair {
        AdjacentPair::of(&self.ring)
    }

    /// The target, level, at places in the camera frame of a level camera (m) and with headings (rad, as seen from above,
    /// 0 where it faces away from the camera along its axis): a frame per pose. Without daylight where `is_indoors`.
    pub(crate) fn posed(&self, places: &[(Vector3<f64>, f64)], is_indoors: bool, seed: u64) -> Scene {
        let mut scene = self.scene.clone();
        let observer = Isometry3::translation(0.0, 0.0, 2.0);
        let world_from_camera = observer * scene.cameras[0].body_from_camera;
        let pose = |&(place_m, heading_rad): &(Vector3<f64>, f64)| {
            let world_m = world_from_camera * Point3::from(place_m);
            let rotation = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), heading_rad);
            Isometry3::from_parts(Translation3::from(world_m), rotation)
        };
        scene.targets.truncate(1);
        arrange(&mut scene, places.iter().map(pose), observer, is_indoors);
        scene.set_seed(seed);
        scene
    }

    /// One LED that faces the camera, indoors: at each distance (m), and at a place in a pixel that is `offset_px` from its
    /// centre; seen in the middle of the image alone, so that many frames take little time.
    ///
    /// # Errors
    /// [`ReproduceError::Axis`] for a camera of which there is no such part.
    pub(crate) fn receding(
        &self,
        exposure_us: f64,
        places: &[(f64, [f64; 2])],
        seed: u64,
    ) -> Result<Scene, ReproduceError> {
        let mut scene = self.scene.clone();
        scene.exposure_us = exposure_us;
        scene.cameras = vec![MountedCamera { camera: self.cut()?, ..scene.cameras[0].clone() }];
        scene.targets.truncate(1);
        scene.targets[0] =
            Target { airframe: single_led(), solids: Vec::new(), blink: None, ..scene.targets[0].clone() };
        // one LED was measured, not a batch
        scene.preset.emitter.unit_spread = 0.0;
        let world_from_camera = scene.cameras[0].body_from_camera;
        let towards = Bearing::new(-Vector3::z()).ok_or(ReproduceError::Axis)?;
        let pose = |&(distance_m, offset_px): &(f64, [f64; 2])| {
            let [x, y] = offset_px.map(|px| px * self.rad_per_px * distance_m);
            let place_m = world_from_camera * Point3::new(x, y, distance_m);
            let facing = world_from_camera * towards.vector();
            let rotation = UnitQuaternion::rotation_between(&Vector3::x(), &facing);
            let half_turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), core::f64::consts::PI);
            Isometry3::from_parts(Translation3::from(place_m), rotation.unwrap_or(half_turn))
        };
        arrange(&mut scene, places.iter().map(pose), Isometry3::identity(), true);
        scene.set_seed(seed);
        Ok(scene)
    }

    /// The middle of the image: the same angle per pixel.
    fn cut(&self) -> Result<Camera, ReproduceError> {
        let middle = 0.5 * (CUT_PX as f64 - 1.0);
        let lens = Ideal::new(
            IdealLaw::Equidistant,
            [1.0 / self.rad_per_px; 2],
            Pixel::new(middle.floor(), middle.floor()),
        );
        lens.and_then(|lens| Camera::new(Model::Ideal(lens), CUT_PX, CUT_PX, None))
            .map_err(|_| ReproduceError::Axis)
    }
}

/// Sets the first target on poses, one per frame, and the observer on one.
fn arrange(
    scene: &mut Scene,
    poses: impl Iterator<Item = Isometry3<f64>>,
    observer: Isometry3<f64>,
    is_indoors: bool,
) {
    let held = |poses| Recorded::held(poses, POSE_S).map(Motion::Recorded);
    let poses: Vec<_> = poses.collect();
    scene.frames = poses.len() as u64;
    scene.rate_hz = 1.0 / POSE_S;
    if let (Some(observer), Some(target)) = (held(vec![observer]), held(poses)) {
        scene.observer = observer;
        scene.targets[0].motion = target;
    }
    if is_indoors {
        (scene.daylight, scene.water) = (None, None);
    }
}

/// One LED that faces forward. An airframe has two markers or more, so a second one faces backward, where no camera is.
fn single_led() -> Airframe {
    let led = |x_m: f64, axis: Unit<Vector3<f64>>| Led {
        position_m: Vector3::new(x_m, 0.0, 0.0),
        axis,
        lobe: Lobe::Lambertian,
        power: 1.0,
        signal: None,
    };
    Airframe::new("one LED", vec![led(0.0, Vector3::x_axis()), led(-0.05, -Vector3::x_axis())])
        .expect("two markers, 5 cm apart")
}

#[cfg(test)]
pub(crate) mod tests {
    use photinus_sim::Simulator;

    use super::*;

    pub(crate) fn rig() -> Rig {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/outdoor-flight.toml");
        Rig::new(Scene::read(path).unwrap()).unwrap()
    }

    #[test]
    fn places_are_those_in_the_camera_frame() {
        let rig = rig();
        let place_m = Vector3::new(1.0, -0.3, 5.0);
        let scene = rig.posed(&[(Vector3::z() * 3.0, 0.0), (place_m, 0.4)], true, 7);
        let truth = Simulator::new(&scene, 0).unwrap().frame(1).truth;
        assert!((Vector3::from(truth.neighbours[0].position_m) - place_m).norm() < 1e-9);
        let scene = rig.receding(1000.0, &[(2.0, [0.25, -0.5])], 1).unwrap();
        let led = &Simulator::new(&scene, 0).unwrap().frame(0).truth.neighbours[0].leds[0];
        assert!((led.u_px - 47.25).abs() < 1e-5 && (led.v_px - 46.5).abs() < 1e-5, "{led:?}");
        assert!((rig.rad_per_px() - 3.7673e-3).abs() < 1e-7);
    }

    #[test]
    fn a_scene_of_another_kind_is_refused() {
        let mut scene = rig().scene().clone();
        scene.targets[0].airframe = single_led();
        assert_eq!(Rig::new(scene.clone()).unwrap_err(), ReproduceError::NoRing);
        scene.targets.clear();
        assert_eq!(Rig::new(scene.clone()).unwrap_err(), ReproduceError::Lacks("target"));
        scene.cameras.clear();
        assert_eq!(Rig::new(scene).unwrap_err(), ReproduceError::Lacks("camera"));
    }
}
