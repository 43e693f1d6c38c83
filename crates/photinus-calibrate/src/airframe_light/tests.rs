use nalgebra::{Matrix2x3, Rotation3, Unit, Vector2, Vector3};
use photinus::airframe::{Airframe, Led, Ring};
use photinus::pose::{LogLight, Pose};
use rand_distr::{Distribution, StandardNormal, StandardUniform};
use rand_pcg::Pcg64;

use super::flight::{Flight, Frame, Sighting};
use super::model::{Kind, Model, Own, Parameters, Spread, moved};
use super::*;

/// Noise of directions, rad, and of logarithms of light.
const BEARING_RAD: f64 = 5e-5;
const LIGHT: f64 = 0.03;

/// Neighbours whose errors are compared with the claims.
const SEEDS: u64 = 12;

/// A neighbour as it was built, and random numbers.
struct World {
    random: Pcg64,
    cosine_power: f64,
    powers: Vec<f64>,
    axes: Vec<Vector3<f64>>,
    offsets_m: Vec<Vector3<f64>>,
}

fn quadrotor() -> Airframe {
    let ring = Ring { arms: 4, radius_m: 0.3, leds_per_arm: 2, splay_rad: 1.2 };
    Airframe::from_ring("quadrotor", ring).unwrap()
}

fn hexarotor() -> Airframe {
    let ring = Ring { arms: 6, radius_m: 0.4, leds_per_arm: 1, splay_rad: 0.0 };
    Airframe::from_ring("hexarotor", ring).unwrap()
}

impl World {
    fn new(airframe: &Airframe, seed: u64, offset_sigma_m: f64) -> Self {
        let mut random = Pcg64::new(u128::from(seed), 7);
        let mut normal = || -> f64 { StandardNormal.sample(&mut random) };
        let cosine_power = libm::exp(0.4 + 0.3 * normal());
        let powers = airframe.leds().iter().map(|_| libm::exp(0.2 * normal())).collect();
        let mut askew = |led: &Led| {
            let off = Vector3::from_fn(|_, _| normal()) * 1.0_f64.to_radians();
            (led.axis.into_inner() + off).normalize()
        };
        let axes = airframe.leds().iter().map(&mut askew).collect();
        let mut offset_m = |_: &_| Vector3::from_fn(|_, _| normal()) * offset_sigma_m;
        let offsets_m = airframe.markers().iter().map(&mut offset_m).collect();
        Self { random, cosine_power, powers, axes, offsets_m }
    }

    fn normal(&mut self) -> f64 {
        StandardNormal.sample(&mut self.random)
    }

    fn uniform(&mut self, low: f64, high: f64) -> f64 {
        let share: f64 = StandardUniform.sample(&mut self.random);
        low + (high - low) * share
    }

    /// What a marker sends to a place in the body frame: by the words of the law, not by the airframe's own arithmetic.
    fn light(&self, airframe: &Airframe, marker: usize, to_m: &Vector3<f64>) -> f64 {
        let of_led = |&led: &usize| {
            let ray_m = to_m - airframe.leds()[led].position_m;
            let cos = self.axes[led].dot(&ray_m) / ray_m.norm();
            self.powers[led] * if cos > 0.0 { libm::pow(cos, self.cosine_power) } else { 0.0 }
        };
        airframe.markers()[marker].leds.iter().map(of_led).sum::<f64>()
    }

    fn frame(&mut self, airframe: &Airframe) -> Frame {
        let up = Unit::new_unchecked(-Vector3::y());
        let level = Rotation3::from_basis_unchecked(&[Vector3::z(), -Vector3::x(), -Vector3::y()]);
        let tilt = Vector3::new(self.normal(), self.normal(), 0.0) * 3.0_f64.to_radians();
        let yaw = Vector3::z() * self.uniform(-3.0, 3.0);
        let camera_from_body = level * Rotation3::new(yaw) * Rotation3::new(tilt);
        let towards = Vector3::new(self.uniform(-0.4, 0.4), self.uniform(-0.5, 0.5), 1.0).normalize();
        let position_m = towards * self.uniform(1.0, 3.0);
        let pose = Pose { position_m, camera_from_body };
        let camera_m = pose.camera_in_body_m();
        let log_light = 7.0 + 0.05 * self.normal();
        let mut sightings = Vec::new();
        for marker in 0..airframe.markers().len() {
            let light = self.light(airframe, marker, &camera_m);
            if light < 0.08 {
                continue;
            }
            let at_m = airframe.markers()[marker].position_m;
            let place_m = camera_from_body * (at_m + self.offsets_m[marker]) + position_m;
            let aside = place_m.cross(&Vector3::x()).normalize();
            let across = [aside, place_m.normalize().cross(&aside)];
            let noise = across.map(|axis| axis * (BEARING_RAD * self.normal()));
            let direction = (place_m.normalize() + noise[0] + noise[1]).normalize();
            let value =
                log_light + libm::log(light / (camera_m - at_m).norm_squared()) + LIGHT * self.normal();
            sightings.push(Sighting {
                marker,
                direction,
                map: Matrix2x3::from_rows(&across.map(|axis| axis.transpose() / BEARING_RAD)),
                log_light: Some(LogLight { value, sigma: LIGHT }),
            });
        }
        let off = Rotation3::new(Vector3::z() * (0.05 * self.normal()));
        let pose = Pose {
            position_m: position_m * (1.0 + 0.02 * self.normal()),
            camera_from_body: camera_from_body * off,
        };
        Frame { pose, up: Some(up), sightings, log_light: 7.0 }
    }

    fn flight(&mut self, airframe: &Airframe, frames: usize) -> Flight {
        let frames = (0..frames).map(|_| self.frame(airframe)).filter(|frame| frame.sightings.len() > 1);
        Flight::of_tracks(airframe, vec![frames.collect()])
    }

    /// How far powers are off, in the sigmas that are claimed.
    fn powers_off(&self, light: &Light) -> Vec<f64> {
        let logs: Vec<f64> = self.powers.iter().map(|power| libm::log(*power)).collect();
        let mean = logs.iter().sum::<f64>() / logs.len() as f64;
        let off = |(known, log): (&Option<Known>, &f64)| {
            let known = known.expect("every LED is seen");
            (libm::log(known.value) - (log - mean)) / known.sigma
        };
        light.powers.iter().zip(&logs).map(off).collect()
    }
}

#[test]
fn errors_are_as_large_as_is_claimed() {
    let airframe = hexarotor();
    let (mut powers, mut lobes, mut ratio) = (Vec::new(), Vec::new(), Vec::new());
    for seed in 0..SEEDS {
        let mut world = World::new(&airframe, seed, 0.002);
        let light = calibrate(&world.flight(&airframe, 120)).unwrap();
        powers.extend(world.powers_off(&light));
        let known = light.lobes[0].cosine_power.unwrap();
        lobes.push((known.value - world.cosine_power) / known.sigma);
        ratio.extend(light.position_sigma_m.map(|known| known.value / 0.002));
    }
    let square = |off: &[f64]| off.iter().map(|off| off * off).sum::<f64>() / off.len() as f64;
    assert!((0.75..1.35).contains(&square(&powers)), "{}", square(&powers));
    assert!((0.5..1.7).contains(&square(&lobes)), "{}", square(&lobes));
    // Few flights tell positions; those that do are right.
    assert!(!ratio.is_empty() && ratio.iter().all(|ratio| (0.6..1.6).contains(ratio)), "{ratio:?}");
}

#[test]
fn what_is_not_shown_keeps_its_prior_and_is_said_to_be_unseen() {
    let airframe = quadrotor();
    let mut world = World::new(&airframe, 5, 0.0);
    let mut frames = world.flight(&airframe, 200).tracks()[0].clone();
    for frame in &mut frames {
        frame.sightings.iter_mut().filter(|seen| seen.marker == 2).for_each(|seen| seen.log_light = None);
    }
    let light = calibrate(&Flight::of_tracks(&airframe, vec![frames])).unwrap();
    let unseen: Vec<usize> = (0..8).filter(|&led| light.powers[led].is_none()).collect();
    assert_eq!(unseen, airframe.markers()[2].leds);
    assert!(unseen.iter().all(|&led| (light.airframe.leds()[led].power - 1.0).abs() <= 0.0));
}

#[test]
fn too_little_is_refused() {
    let airframe = quadrotor();
    let mut world = World::new(&airframe, 1, 0.0);
    let few = world.flight(&airframe, 20);
    let frames = few.tracks()[0].len();
    assert_eq!(calibrate(&few), Err(LightError::TooFewFrames { frames }));
    let mut dark = world.flight(&airframe, 60).tracks()[0].clone();
    dark.iter_mut().flat_map(|frame| &mut frame.sightings).for_each(|seen| seen.log_light = None);
    let dark = Flight::of_tracks(&airframe, vec![dark]);
    assert_eq!(calibrate(&dark), Err(LightError::TooFewLights { lights: 0 }));
}

#[test]
fn derivatives_agree_with_finite_differences() {
    let airframe = quadrotor();
    let mut world = World::new(&airframe, 11, 0.002);
    let shapes = shape::kinds(&airframe).into_iter().map(|shape| shape.narrowed(1.7)).collect();
    let count = airframe.leds().len();
    let parameters = Parameters {
        log_powers: (0..count).map(|led| 0.1 * led as f64 - 0.3).collect(),
        told_log_powers: vec![0.0; count],
        shapes,
        askew_rad: (0..count).map(|led| Vector2::new(0.01, -0.005 * led as f64)).collect(),
        log_light: 7.1,
        offsets_m: vec![Vector3::new(0.002, -0.001, 0.003); 4],
    };
    let spread = Spread { scatter: [1.2, 0.8], light_sigma: 0.1, offset_sigma_m: 0.002 };
    for _ in 0..20 {
        let mut frame = world.frame(&airframe);
        let residuals = |frame: &Frame, parameters: &Parameters| -> Vec<f64> {
            let model = Model::new(&airframe, parameters).unwrap();
            model.rows(frame, &spread).iter().map(|row| row.residual).collect()
        };
        // Light as it is expected: what a weight changes by is then nothing.
        let model = Model::new(&airframe, &parameters).unwrap();
        let lights: Vec<f64> = model
            .rows(&frame, &spread)
            .iter()
            .filter(|row| row.kind == Kind::Light)
            .map(|row| row.residual / row.by_own[6])
            .collect();
        for (seen, off) in frame.sightings.iter_mut().zip(lights) {
            seen.log_light.as_mut().unwrap().value += off;
        }
        let rows = model.rows(&frame, &spread);
        let step = 1e-6;
        let compare = |what: usize, above: &[f64], below: &[f64], told: &dyn Fn(usize) -> f64| {
            for (row, (above, below)) in above.iter().zip(below).enumerate() {
                let (numeric, told) = ((above - below) / (2.0 * step), told(row));
                assert!(
                    (numeric - told).abs() < 2e-3 * (1.0 + told.abs()),
                    "{what}, row {row}: {numeric} {told}"
                );
            }
        };
        for axis in 0..7 {
            let own = |by: f64| residuals(&moved(&frame, &(Own::ith(axis, 1.0) * by)), &parameters);
            compare(axis, &own(step), &own(-step), &|row| rows[row].by_own[axis]);
        }
        for number in 0..parameters.count() {
            let shared = |by: f64| {
                let mut all = vec![0.0; parameters.count()];
                all[number] = by;
                residuals(&frame, &parameters.moved(&all))
            };
            let told = |row: usize| {
                rows[row].by_shared.iter().filter(|slope| slope.0 == number).map(|slope| slope.1).sum()
            };
            compare(number, &shared(step), &shared(-step), &told);
        }
    }
}
