//! The light at which the detector says that it finds half of the points, against how many it finds: rendered points before cameras that nothing was tuned to.

use std::sync::Arc;

use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use photinus::airframe::{Airframe, Led, Lobe};
use photinus::camera::Pixel;
use photinus::pose::LogLight;
use photinus::spots::{Detector, Settings, Spot};
use photinus_sim::snapshot::{LedLight, Lit, Moving, Snapshot, Vehicle};
use photinus_sim::{CameraView, Renderer};
use rand_distr::{Distribution, Uniform};
use rand_pcg::Pcg64;

use crate::row::Eye;
use crate::{cameras, priors};

/// Frames in which the detector learns the camera, and those that count.
const FIRST: u64 = 40;
const FRAMES: u64 = 160;
/// How far away the points are, m, and their power over that of a usual LED, as a logarithm.
const AWAY_M: f64 = 10.0;
const LOG_POWER: [f64; 2] = [-4.5, 3.0];
/// Places in the middle of the image: a lattice with so many rows, so far apart, px.
const SIDE: usize = 6;
const APART_PX: f64 = 40.0;
const GOLDEN: f64 = 0.618_033_988_749_894_9;
/// A spot is a point's that is no further away, px.
const GATE_PX: f64 = 3.0;

/// A point that was shown: the logarithm of its power, and the logarithm of its light as measured, if it was found.
type Shown = (f64, Option<f64>);

fn lamp(id: u32, place: Vector3<f64>, power: f64) -> Vehicle {
    let led = Led {
        position_m: Vector3::zeros(),
        axis: Vector3::z_axis(),
        lobe: Lobe::Omni,
        power: 1.0,
        signal: None,
    };
    let pose = Isometry3::from_parts(
        Translation3::from(priors::world_from_camera() * place),
        UnitQuaternion::identity(),
    );
    Vehicle {
        id,
        airframe: Arc::new(Airframe::new("lamp", vec![led]).unwrap()),
        solids: Arc::new([]),
        looks: Arc::default(),
        motion: Moving::still(pose),
        leds: vec![LedLight { power, lit: Lit::always() }],
    }
}

/// Shows points to a detector, and what it says at the end of its limit.
fn show(eye: &Eye) -> (Vec<Shown>, LogLight) {
    let Eye { camera, preset, exposure_us } = eye;
    let view =
        CameraView { camera: camera.clone(), lens: preset.lens.clone(), sensor: preset.sensor.clone() };
    let mut renderer = Renderer::new(view, 1);
    let mut detector = Detector::new(Settings::default()).unwrap();
    let mut rng = Pcg64::new(2026, 7);
    let jitter = Uniform::new(-1.0, 1.0).unwrap();
    // Evener than random ones: every power is shown as often as any other.
    let log_power =
        |count: u64| LOG_POWER[0] + (LOG_POWER[1] - LOG_POWER[0]) * (count as f64 * GOLDEN).fract();
    let pose = Isometry3::from_parts(Translation3::identity(), priors::world_from_camera().into());
    let mut all = Vec::new();
    for number in 0..FRAMES {
        let drawn: Vec<(Pixel, f64)> = (0..SIDE * SIDE)
            .map(|index| {
                let mut at = |index: usize, side: usize| {
                    0.5 * side as f64 + APART_PX * (index as f64 - 2.5) + jitter.sample(&mut rng)
                };
                let (u, v) = (at(index % SIDE, camera.width()), at(index / SIDE, camera.height()));
                (Pixel::new(u, v), log_power(number * (SIDE * SIDE) as u64 + index as u64))
            })
            .collect();
        let vehicles = drawn.iter().zip(1..).map(|(&(pixel, log_power), id)| {
            lamp(id, camera.bearing(pixel).unwrap().vector() * AWAY_M, libm::exp(log_power))
        });
        let snapshot = Snapshot {
            exposure: renderer.view().exposure(number as f64, exposure_us * 1e-6),
            camera: Moving::still(pose),
            vehicles: vehicles.collect(),
            emitter: preset.emitter,
            daylight: None,
            water: None,
            lamps: Vec::new(),
        };
        let rendered = renderer.render(&snapshot, number);
        let spots = &detector.detect(&rendered.image.view(), None).unwrap().spots;
        let found = |pixel: Pixel| {
            let gap = |spot: &&Spot| libm::hypot(spot.centre.u - pixel.u, spot.centre.v - pixel.v);
            let nearest =
                spots.iter().filter(|spot| gap(spot) < GATE_PX).min_by(|a, b| gap(a).total_cmp(&gap(b)));
            nearest.map(|spot| libm::log(spot.light.map_or(spot.flux, |light| light.value)))
        };
        if number >= FIRST {
            all.extend(drawn.iter().map(|&(pixel, log_power)| (log_power, found(pixel))));
        }
    }
    (all, detector.detection_limit().unwrap())
}

/// Mean and standard deviation of the logarithm of light at which points were found, by the unit of light that points of middling brightness tell: a point is found
/// from its own limit on, so how many are found at a light is the distribution of limits.
fn limit(shown: &[Shown]) -> LogLight {
    let mut units: Vec<f64> = shown
        .iter()
        .filter_map(|&(log_power, found)| {
            Some(found? - log_power).filter(|_| (0.0..2.0).contains(&log_power))
        })
        .collect();
    units.sort_unstable_by(f64::total_cmp);
    let unit = units[units.len() / 2];
    let most = LOG_POWER[1];
    let per_point = (LOG_POWER[1] - LOG_POWER[0]) / shown.len() as f64;
    let found = shown.iter().filter(|(_, found)| found.is_some());
    let (sum, moment) = found.fold((0.0, 0.0), |(sum, moment), &(log_power, _)| {
        (sum + per_point, moment + 2.0 * per_point * (most - log_power))
    });
    LogLight { value: most - sum + unit, sigma: (moment - sum * sum).max(0.0).sqrt() }
}

/// The point spread that is learnt is a core and a halo, both Gaussians: how far off that may be of lenses that are another thing, and of any other.
const OTHER_SPREAD: f64 = 0.3;
const OFF: f64 = 0.07;
/// How far a light that was measured and the number of points that were found are off themselves.
const LEAST_SIGMA: f64 = 0.07;

#[test]
fn half_of_the_points_are_found_at_the_light_that_is_told() {
    let others = ["gaussian-0.3", "gaussian-0.6", "gaussian-1.0", "gaussian-1.5", "moffat-0.8"];
    let and_others = ["core-halo", "noise-3", "ccd", "coma"];
    let eyes = others.into_iter().chain(and_others).map(|name| (name, cameras::named(name)));
    for (name, eye) in core::iter::once(("the paper's", cameras::paper())).chain(eyes) {
        let (shown, told) = show(&eye);
        let seen = limit(&shown);
        let off = (told.value - seen.value).abs();
        let allowed = if name.starts_with("moffat") { OTHER_SPREAD } else { OFF };
        assert!(off < allowed, "{name}: told {told:?}, seen {seen:?}");
        let sigma = libm::hypot(told.sigma, LEAST_SIGMA);
        assert!((0.75..1.33).contains(&(sigma / seen.sigma)), "{name}: told {told:?}, seen {seen:?}");
    }
}
