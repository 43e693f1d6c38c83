//! Scene -> frames with truth: drives the renderer by what a scene says.
//!
//! A frame depends on scene and number alone: frames may be asked for in any order, and threads may share them out as they
//! like (`parallel.rs`).

mod parallel;
#[cfg(test)]
mod tests;

use std::sync::Arc;

use nalgebra::Isometry3;
use photinus::airframe::Led;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;

use crate::measured::as_measured;
use crate::render::{CameraView, Rendered, Renderer};
use crate::scene::{Scene, SceneLamp, Target};
use crate::sensor::hash;
use crate::snapshot::{Exposure, Lamp, LedLight, Lit, Looks, Moving, Snapshot, Vehicle};
use crate::source::Blink;

/// Renders the frames of one camera of a scene.
#[derive(Clone, Debug)]
pub struct Simulator {
    scene: Arc<Scene>,
    camera: usize,
    exposure_us: f64,
    blinks: Arc<[Vec<Option<Blink>>]>,
    snapshot: Snapshot,
    renderer: Renderer,
}

impl Simulator {
    /// A simulator of camera number `camera` of a scene; `None` when there is no such camera. The scene is shared by its clones
    /// (an `Arc` is taken as it is).
    pub fn new(scene: impl Into<Arc<Scene>>, camera: usize) -> Option<Self> {
        let scene: Arc<Scene> = scene.into();
        let mounted = scene.cameras.get(camera)?;
        let preset = &scene.preset;
        let mut view = CameraView {
            camera: mounted.camera.clone(),
            lens: preset.lens.clone(),
            sensor: preset.sensor.clone(),
        };
        as_measured(&mounted.camera, &mut view.lens, &mut view.sensor);
        // the cameras of a scene differ in their noise; the first one has the scene's seed itself
        let renderer = Renderer::new(view, scene.seed ^ ((camera as u64) << 56))
            .with_own_airframe(&scene.own_airframe, mounted.body_from_camera);
        let mut random = Pcg64::new(u128::from(scene.seed), 0x1ed);
        let mut draw = || StandardNormal.sample(&mut random);
        let vehicles = scene.targets.iter().map(|target| vehicle(target, &scene, &mut draw)).collect();
        let exposure_us = mounted.exposure_us.unwrap_or(scene.exposure_us);
        let exposure = renderer.view().exposure(0.0, exposure_us * 1e-6);
        let snapshot = Snapshot {
            exposure,
            camera: Moving::still(mounted.body_from_camera),
            vehicles,
            emitter: preset.emitter,
            daylight: scene.daylight,
            water: scene.water,
            lamps: scene.lamps.iter().map(lamp).collect(),
        };
        let blinks = scene.targets.iter().map(|target| blinks(target, scene.seed)).collect();
        Some(Self { camera, exposure_us, blinks, snapshot, renderer, scene })
    }

    /// Frame number `number`, counted from 0; any, in any order.
    pub fn frame(&mut self, number: u64) -> Rendered {
        self.expose(self.exposure(number));
        self.renderer.render(&self.snapshot, number)
    }

    /// The light of points in a frame, without noise.
    #[cfg(test)]
    pub(crate) fn light_of(&mut self, number: u64) -> crate::sensor::Charge {
        self.expose(self.exposure(number));
        self.renderer.points(&self.snapshot)
    }

    /// All frames of the scene, one after the other.
    pub fn frames(&mut self) -> impl Iterator<Item = Rendered> + '_ {
        (0..self.scene.frames).map(|number| self.frame(number))
    }

    /// When frame number `number` is exposed.
    pub fn exposure(&self, number: u64) -> Exposure {
        let mounted = &self.scene.cameras[self.camera];
        let start_s = mounted.clock.time_s(mounted.phase_s + number as f64 / self.scene.rate_hz);
        self.renderer.view().exposure(start_s, self.exposure_us * 1e-6)
    }

    /// Exposes the frames that are asked for from now on so long, us, in place of what the scene says: a camera whose exposure is set while it runs.
    /// What is not above 0 and at most a minute changes nothing.
    pub fn set_exposure_us(&mut self, exposure_us: f64) {
        if exposure_us > 0.0 && exposure_us <= 6e7 {
            self.exposure_us = exposure_us;
        }
    }

    /// Brings the snapshot to an exposure.
    fn expose(&mut self, exposure: Exposure) {
        let instants_s = exposure.instants_s();
        self.snapshot.exposure = exposure;
        let observer = Moving::through(instants_s.map(|time_s| self.scene.observer.pose(time_s)));
        self.snapshot.camera = observer.carrying(&self.scene.cameras[self.camera].body_from_camera);
        let targets = self.scene.targets.iter().zip(self.blinks.iter());
        for (vehicle, (target, blinks)) in self.snapshot.vehicles.iter_mut().zip(targets) {
            vehicle.motion = Moving::through(instants_s.map(|time_s| target.motion.pose(time_s)));
            for (led, blink) in vehicle.leds.iter_mut().zip(blinks) {
                if let Some(blink) = blink {
                    blink.light(exposure.start_s, exposure.span_s(), &mut led.lit);
                }
            }
        }
        for (lamp, placed) in self.snapshot.lamps.iter_mut().zip(&self.scene.lamps) {
            if let Some(vehicle) = placed.beside.and_then(|index| self.snapshot.vehicles.get(index)) {
                lamp.motion = vehicle.motion.carrying(&Isometry3::from(placed.position_m));
            }
        }
    }
}

impl From<&Scene> for Arc<Scene> {
    fn from(scene: &Scene) -> Self {
        Self::new(scene.clone())
    }
}

/// A vehicle as it was built: with what is wrong with its LEDs.
fn vehicle(target: &Target, scene: &Scene, draw: &mut impl FnMut() -> f64) -> Vehicle {
    let (unit, count) = ((scene.seed, target.id), target.airframe.leds().len());
    let powers = target.faults.powers(&scene.preset.emitter, count, unit, draw);
    // a seed that was set later may move markers to where they are no airframe: they stay where they should be
    let built = target.faults.built(&target.airframe, unit.0, unit.1);
    Vehicle {
        id: target.id,
        airframe: Arc::new(built.unwrap_or_else(|_| target.airframe.clone())),
        solids: target.solids.clone().into(),
        looks: Arc::new(Looks { lobe: target.lobe.clone(), mirrors: target.mirrors.clone() }),
        motion: Moving::still(Isometry3::identity()),
        leds: powers.into_iter().map(|power| LedLight { power, lit: Lit::always() }).collect(),
    }
}

fn lamp(lamp: &SceneLamp) -> Lamp {
    let motion = Moving::still(Isometry3::from(lamp.position_m));
    Lamp { motion, power: lamp.power, radius_m: lamp.radius_m }
}

/// The signal of each LED of a target; `None` where it shines all the time. The LEDs of a target blink by one clock.
fn blinks(target: &Target, seed: u64) -> Vec<Option<Blink>> {
    let of = |led: &Led| {
        let plan = target.blink.as_ref()?;
        let word = *plan.words.get(led.signal.unwrap_or(0) as usize)?;
        let blink = Blink::new(plan.codes.words().get(word)?.bits().collect(), plan.rate_hz, plan.clock)?;
        Some(blink.with_jitter(plan.jitter_s, hash(seed ^ hash(u64::from(target.id)))))
    };
    target.airframe.leds().iter().map(of).collect()
}
