#![allow(dead_code, reason = "each program takes what it needs")]
//! Simulated flights of one neighbour whose LEDs do not shine as its airframe file says: rendered, located, learned from.

use std::path::Path;

use nalgebra::Vector3;
use photinus::airframe::{Airframe, Led, Lobe};
use photinus::locator::{Input, Located, Locator, Settings};
use photinus_calibrate::airframe_light::{Flight, Known, Light, calibrate};
use photinus_sim::scene::Scene;
use photinus_sim::{Rendered, Simulator};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::SeedableRng;

/// How a neighbour is really built.
pub(crate) struct Built {
    /// The file of its airframe, as it is told.
    pub(crate) airframe: &'static str,
    /// Its lobes are this power of the cosine.
    pub(crate) cosine_power: f64,
    /// Spread of its powers: sigma of the logarithm.
    pub(crate) spread: f64,
    /// How far its markers are off, m per axis.
    pub(crate) misplaced_m: f64,
    pub(crate) seed: u64,
}

impl Built {
    /// Power of each LED.
    pub(crate) fn powers(&self, count: usize) -> Vec<f64> {
        let mut random = Pcg64Mcg::seed_from_u64(self.seed);
        let mut draw = || -> f64 { StandardNormal.sample(&mut random) };
        (0..count).map(|_| libm::exp(self.spread * draw())).collect()
    }

    /// The airframe as it was built.
    pub(crate) fn as_built(&self, told: &Airframe) -> Airframe {
        let leds = told.leds().iter().zip(self.powers(told.leds().len())).map(|(led, power)| Led {
            lobe: Lobe::Cosine { power: self.cosine_power },
            power,
            ..led.clone()
        });
        Airframe::new(told.name(), leds.collect()).expect("powers of LEDs")
    }

    /// A flight to learn from: away from the camera, turning about itself.
    pub(crate) fn flight(&self, frames: u64) -> Scene {
        self.scene(frames, [[1.6, 0.4, 4.8], [6.0, -0.6, 5.6]], 3.3)
    }

    /// Frames that nothing was learned from, of the same robot in another flight.
    pub(crate) fn other_frames(&self, frames: u64) -> Scene {
        let other = Built { seed: self.seed + 100_000, ..*self };
        let mut scene = other.scene(frames, [[1.5, -0.5, 5.4], [6.0, 0.8, 4.4]], 5.7);
        scene.targets[0].faults = self.flight(1).targets[0].faults.clone();
        scene
    }

    /// Frames of it, ten a second, while it goes from `from_m` to `to_m` and back and turns in place.
    pub(crate) fn scene(&self, frames: u64, [from_m, to_m]: [[f64; 3]; 2], turns: f64) -> Scene {
        let duration_s = frames as f64 / 10.0;
        let text = format!(
            "name = \"flight\"\nseed = {seed}\npreset = \"bluefox-dsl215-bp365\"\nrate_hz = 10.0\nduration_s = {duration_s}\n\
             exposure_us = 1000.0\n[observer]\nmotion = {{ hover = {{ position_m = [0.0, 0.0, 5.0] }} }}\n\
             [[camera]]\nname = \"front\"\nfile = \"cameras/bluefox-dsl215.toml\"\n\
             [[target]]\nid = 1\nairframe = \"airframes/{airframe}.toml\"\nwind_m_s = 4.0\nheading_deg = {heading}\n\
             motion = {{ line = {{ from_m = {from_m:?}, to_m = {to_m:?}, duration_s = {duration_s} }} }}\n\
             spin = [{{ start_s = 0.0, duration_s = {duration_s}, turns = {turns:?} }}]\n\
             lobe = {{ cosine = {power:?} }}\nleds = {{ misplaced_m = {misplaced_m:?} }}\n",
            seed = self.seed,
            airframe = self.airframe,
            heading = 37 * self.seed % 360,
            power = self.cosine_power,
            misplaced_m = self.misplaced_m,
        );
        let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/flight.toml"));
        let mut scene = Scene::parse(&text, path).unwrap_or_else(|error| panic!("{error}"));
        scene.preset.emitter.unit_spread = 0.0;
        let powers = self.powers(scene.targets[0].airframe.leds().len());
        scene.targets[0].faults.weak = powers.into_iter().enumerate().collect();
        scene
    }
}

/// Locates every frame of a scene as this airframe.
pub(crate) fn locate(
    scene: &Scene,
    airframe: &Airframe,
    settings: Settings,
    mut each: impl FnMut(&Located, &Rendered),
) {
    let camera = scene.cameras[0].camera.clone();
    let mut locator = Locator::new(camera, airframe, None, settings).expect("settings with a meaning");
    let mut simulator = Simulator::new(scene.clone(), 0).expect("a scene with a camera");
    for rendered in simulator.frames() {
        let located = locator
            .locate(Input::frame(&rendered.image.view()).gravity(&rendered.gravity))
            .expect("frames of the camera's size");
        each(located, &rendered);
    }
}

/// What the flight of a scene says of light, located by the airframe as it is told.
pub(crate) fn learn(scene: &Scene) -> Light {
    let told = &scene.targets[0].airframe;
    let mut flight = Flight::new(told);
    locate(scene, told, Flight::settings(Settings::default()), |located, rendered| {
        let time_s = rendered.truth.frame as f64 / scene.rate_hz;
        flight.add(located, Some(&rendered.gravity), time_s);
    });
    calibrate(&flight).unwrap_or_else(|error| panic!("{error}"))
}

/// Settings for an airframe that was learned.
pub(crate) fn known(light: &Light) -> Settings {
    let mut settings = Settings::default();
    settings.pose.unit_sigma = light.power_sigma().unwrap_or(settings.pose.unit_sigma);
    settings
}

/// Root mean squares of how far learned powers are off, as logarithms, and of what is claimed; in the turn of the airframe that
/// fits best, since nothing tells which LED of a symmetric one is the first.
pub(crate) fn powers_off(light: &Light, built: &Built) -> (f64, f64) {
    let logs: Vec<f64> = built.powers(light.powers.len()).iter().map(|power| libm::log(*power)).collect();
    let (count, mean) = (logs.len(), logs.iter().sum::<f64>() / logs.len() as f64);
    let of_marker = light.airframe.markers()[0].leds.len();
    let off = |turn: usize| {
        let square = |(led, known): (usize, &Option<Known>)| {
            let learned = known.map_or(0.0, |known| libm::log(known.value));
            let off = learned + mean - logs[(led + turn * of_marker) % count];
            off * off
        };
        (light.powers.iter().enumerate().map(square).sum::<f64>() / count as f64).sqrt()
    };
    let claimed = light.powers.iter().flatten().map(|known| known.sigma * known.sigma).sum::<f64>();
    let least = (0..count / of_marker).map(off).fold(f64::INFINITY, f64::min);
    (least, (claimed / count as f64).sqrt())
}

/// How distances are off.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Distances {
    /// Frames with one neighbour.
    pub(crate) frames: usize,
    /// Mean of the relative errors, and its standard error.
    pub(crate) bias: f64,
    pub(crate) bias_sigma: f64,
    /// Root mean square of the relative errors.
    pub(crate) rms: f64,
    /// Mean squared error of position in units of the claimed covariance; 3 is honest.
    pub(crate) nees: f64,
}

/// Locates the frames of a scene as this airframe and compares with the truth.
pub(crate) fn distances(scene: &Scene, airframe: &Airframe, settings: Settings) -> Distances {
    distances_after(0, scene, airframe, settings)
}

/// The same of the frames after the first so many.
pub(crate) fn distances_after(
    first: u64,
    scene: &Scene,
    airframe: &Airframe,
    settings: Settings,
) -> Distances {
    let (mut errors, mut nees) = (Vec::new(), 0.0);
    locate(scene, airframe, settings, |located, rendered| {
        let [neighbour] = located.neighbours.as_slice() else { return };
        if rendered.truth.frame < first {
            return;
        }
        let (Some(estimate), Some(position)) = (neighbour.distance.estimate, neighbour.position) else {
            return;
        };
        let there = &rendered.truth.neighbours[0];
        errors.push(estimate.distance_m / there.distance_m - 1.0);
        let off_m = position.mean_m - Vector3::from(there.position_m);
        nees += position.covariance_m2.cholesky().map_or(0.0, |factors| off_m.dot(&factors.solve(&off_m)));
    });
    let frames = errors.len();
    let count = frames as f64;
    let bias = errors.iter().sum::<f64>() / count;
    let squares = errors.iter().map(|error| error * error).sum::<f64>() / count;
    let bias_sigma = ((squares - bias * bias) / count).sqrt();
    Distances { frames, bias, bias_sigma, rms: squares.sqrt(), nees: nees / count }
}
