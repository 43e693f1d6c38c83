//! Markers that blink and move, seen by a camera that turns: spherical geometry and noise of its own, nothing of what follows them.

use nalgebra::{Matrix2, Rotation3, Vector3};
use photinus::camera::{Bearing, Camera, Ideal, IdealLaw, Model, Pixel};
use photinus::following::Turn;
use photinus::identity::Word;
use photinus::locator::Sighting;
use photinus::pose::LogLight;
use photinus::spots::{Extent, Spot};
use rand_distr::{Distribution, StandardNormal, StandardUniform};
use rand_pcg::Pcg64Mcg;

pub const FRAME_S: f64 = 1.0 / 60.0;
pub const EXPOSURE_S: f64 = 1e-3;
pub const FAINTEST: f64 = 200.0;
pub const DEGREE: f64 = std::f64::consts::PI / 180.0;
/// Noise of a gyro.
pub const GYRO_RAD_S: f64 = 0.3 * DEGREE;

/// What the follower is told of the faintest light.
pub fn detection_limit() -> Option<LogLight> {
    Some(LogLight { value: libm::log(FAINTEST), sigma: 0.23 })
}

const SIGMA_PX: f64 = 0.1;
const LIGHT_SIGMA: f64 = 0.05;
/// Steps of the motion in a frame.
const STEPS: usize = 4;

const BOOK: &str = include_str!("../../../../scenes/codes/l18-d3-r2.txt");

/// Words of 18 bits, 3 apart, no longer dark than 2 bits.
pub fn words() -> Vec<Word> {
    let word = |line: &str| Word::new(&line.split(',').map(|bit| bit == "1").collect::<Vec<_>>());
    BOOK.lines().filter(|line| !line.starts_with('#')).filter_map(word).collect()
}

pub fn camera() -> Camera {
    let lens = Ideal::new(IdealLaw::Equidistant, [1.0 / 3.7673e-3; 2], Pixel::new(375.5, 239.5)).unwrap();
    Camera::new(Model::Ideal(lens), 752, 480, None).unwrap()
}

/// A marker in axes that do not turn.
#[derive(Clone, Debug)]
pub struct Marker {
    pub ahead: Vector3<f64>,
    pub rate_rad_s: Vector3<f64>,
    /// Which word it blinks; `None` is a steady light.
    pub word: Option<usize>,
    /// Bits into its word at the time 0.
    pub phase: f64,
    /// Bits per second: its clock is not the camera's.
    pub bit_rate_hz: f64,
    pub light: f64,
    /// When it is there at all, s.
    pub from_to_s: [f64; 2],
}

/// How the camera turns: to and fro about its vertical axis.
#[derive(Clone, Copy, Debug)]
pub struct Swing {
    pub amplitude_rad: f64,
    pub most_rad_s: f64,
}

pub struct World {
    pub random: Pcg64Mcg,
    pub markers: Vec<Marker>,
    pub swing: Option<Swing>,
    /// Spectral density of the acceleration, rad^2/s^3.
    pub acceleration: f64,
    pub clutter: usize,
    pub dropped: f64,
    pub time_s: f64,
    pub camera: Camera,
    words: Vec<Word>,
    seen_s: f64,
    /// Camera from axes that do not turn, in the frame before and now.
    before: Rotation3<f64>,
    pub now: Rotation3<f64>,
}

impl World {
    /// Markers that are spread over the view, each with another word of the book.
    pub fn new(seed: u64, count: usize) -> Self {
        let words = words();
        let mut world = Self {
            random: Pcg64Mcg::new(u128::from(seed) * 2 + 1),
            markers: Vec::new(),
            swing: None,
            acceleration: 5e-3,
            clutter: 0,
            dropped: 0.0,
            time_s: 0.0,
            camera: camera(),
            words,
            seen_s: 0.0,
            before: Rotation3::identity(),
            now: Rotation3::identity(),
        };
        while world.markers.len() < count {
            let place = Vector3::new(world.between(-0.8, 0.8), world.between(-0.5, 0.5), 0.0);
            let ahead = Rotation3::new(Vector3::new(-place.y, place.x, 0.0)) * Vector3::z();
            if world.markers.iter().all(|other| (other.ahead - ahead).norm() > 0.08) {
                let marker = world.marker(ahead);
                world.markers.push(marker);
            }
        }
        world
    }

    /// A marker in this direction with a speed and a word of its own.
    pub fn marker(&mut self, ahead: Vector3<f64>) -> Marker {
        let rate = Vector3::from_fn(|_, _| 0.05 * self.normal());
        Marker {
            ahead,
            rate_rad_s: rate - ahead * rate.dot(&ahead),
            word: Some(self.markers.len() % self.words.len()),
            phase: self.between(0.0, 18.0),
            bit_rate_hz: 60.0 * (1.0 + 5e-4 * self.between(-1.0, 1.0)),
            light: self.between(500.0, 1500.0),
            from_to_s: [f64::NEG_INFINITY, f64::INFINITY],
        }
    }

    pub fn uniform(&mut self) -> f64 {
        StandardUniform.sample(&mut self.random)
    }

    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.uniform()
    }

    pub fn normal(&mut self) -> f64 {
        StandardNormal.sample(&mut self.random)
    }

    /// Moves on to the next frame that is not dropped and returns its sightings, in any order.
    pub fn next(&mut self) -> Vec<Sighting> {
        self.before = self.now;
        self.seen_s = self.time_s;
        loop {
            self.step();
            if self.uniform() >= self.dropped {
                break;
            }
        }
        let mut sightings = Vec::new();
        for index in 0..self.markers.len() {
            sightings.extend(self.see(index));
        }
        merge(&self.camera, &mut sightings);
        for _ in 0..self.clutter {
            let at = Pixel::new(self.between(3.0, 748.0), self.between(3.0, 476.0));
            let light = FAINTEST * self.between(0.0, 3.0).exp();
            sightings.push(sighting(&self.camera, at, light));
        }
        // a detector gives them in the order of the image
        sightings.sort_by(|a, b| a.spot.centre.v.total_cmp(&b.spot.centre.v));
        sightings
    }

    /// Time since the frame before that was seen, s.
    pub fn passed_s(&self) -> f64 {
        self.time_s - self.seen_s
    }

    /// How a gyro with so much noise, rad/s, tells the camera's turn since the frame before.
    pub fn turned(&mut self, noise_rad_s: f64) -> Turn {
        let sigma_rad = noise_rad_s * self.passed_s();
        let error = Vector3::from_fn(|_, _| sigma_rad * self.normal());
        Turn { now_from_before: Rotation3::new(error) * self.now * self.before.inverse(), sigma_rad }
    }

    /// Direction and rate of a marker in the camera's axes.
    pub fn truth(&self, index: usize) -> (Vector3<f64>, Vector3<f64>) {
        let marker = &self.markers[index];
        (self.now * marker.ahead, self.now * marker.rate_rad_s)
    }

    /// Whether a marker is there and well inside the image.
    pub fn is_there(&self, index: usize) -> bool {
        let [from_s, to_s] = self.markers[index].from_to_s;
        let bearing = Bearing::new(self.now * self.markers[index].ahead).unwrap();
        (from_s..to_s).contains(&self.time_s) && self.is_inside(&bearing)
    }

    pub fn is_inside(&self, bearing: &Bearing) -> bool {
        let inside = |at: Pixel| (8.0..744.0).contains(&at.u) && (8.0..472.0).contains(&at.v);
        self.camera.pixel(bearing).is_some_and(inside)
    }

    fn step(&mut self) {
        let step_s = FRAME_S / STEPS as f64;
        for index in 0..self.markers.len() {
            for _ in 0..STEPS {
                let push = Vector3::from_fn(|_, _| (self.acceleration * step_s).sqrt() * self.normal());
                let Marker { ahead, rate_rad_s, .. } = &mut self.markers[index];
                *rate_rad_s += push - *ahead * push.dot(ahead);
                // along a great circle
                let turn = Rotation3::new(ahead.cross(rate_rad_s) * step_s);
                *ahead = (turn * *ahead).normalize();
                *rate_rad_s = turn * *rate_rad_s;
                *rate_rad_s -= *ahead * rate_rad_s.dot(ahead);
            }
        }
        self.time_s += FRAME_S;
        if let Some(Swing { amplitude_rad, most_rad_s }) = self.swing {
            let angle = amplitude_rad * (most_rad_s / amplitude_rad * self.time_s).sin();
            self.now = Rotation3::new(Vector3::new(0.1 * angle, angle, 0.2 * angle));
        }
    }

    /// What the camera sees of a marker.
    fn see(&mut self, index: usize) -> Option<Sighting> {
        let (marker, time_s) = (self.markers[index].clone(), self.time_s);
        if !(marker.from_to_s[0]..marker.from_to_s[1]).contains(&time_s) {
            return None;
        }
        let lit = marker.word.map_or(1.0, |word| {
            let on = |step: u32| {
                let at_s = time_s + EXPOSURE_S * (f64::from(step) + 0.5) / 20.0;
                f64::from(u8::from(self.words[word].bit((marker.phase + at_s * marker.bit_rate_hz) as usize)))
            };
            (0..20).map(on).sum::<f64>() / 20.0
        });
        let light = marker.light * lit * (1.0 + LIGHT_SIGMA * self.normal());
        if light < FAINTEST {
            return None;
        }
        let pixel = self.camera.pixel(&Bearing::new(self.now * marker.ahead)?)?;
        let at = Pixel::new(pixel.u + SIGMA_PX * self.normal(), pixel.v + SIGMA_PX * self.normal());
        self.camera.bearing(at)?;
        Some(sighting(&self.camera, at, light))
    }
}

/// Lights less than 2.5 px apart are one, between them.
fn merge(camera: &Camera, sightings: &mut Vec<Sighting>) {
    let mut first = 0;
    while first < sightings.len() {
        let near = |other: &usize| {
            let [a, b] = [first, *other].map(|index| sightings[index].spot.centre);
            (a.u - b.u).hypot(a.v - b.v) < 2.5
        };
        if let Some(other) = (first + 1..sightings.len()).find(near) {
            let b = sightings.remove(other);
            let a = &sightings[first];
            let (own, its) = (light(a), light(&b));
            let mean = |a: f64, b: f64| (a * own + b * its) / (own + its);
            let at =
                Pixel::new(mean(a.spot.centre.u, b.spot.centre.u), mean(a.spot.centre.v, b.spot.centre.v));
            sightings[first] = sighting(camera, at, own + its);
        } else {
            first += 1;
        }
    }
}

fn light(sighting: &Sighting) -> f64 {
    sighting.log_light.unwrap().value.exp()
}

/// A sighting straight ahead, to be changed.
pub fn any_sighting() -> Sighting {
    sighting(&camera(), Pixel::new(375.0, 239.0), 1000.0)
}

fn sighting(camera: &Camera, centre: Pixel, light: f64) -> Sighting {
    let (bearing, jacobian) = camera.bearing_with_jacobian(centre).unwrap();
    let covariance_px2 = Matrix2::identity() * (SIGMA_PX * SIGMA_PX);
    let covariance_rad2 = jacobian * covariance_px2 * jacobian.transpose();
    let spot = Spot {
        centre,
        covariance_px2,
        area_px: 6,
        peak: 200,
        saturated_px: 0,
        flux: light,
        light: None,
        background: 5.0,
        marker_log_odds: 0.0,
        middle: (centre.u as u32, centre.v as u32),
        extent: Extent { left: 0, top: 0, right: 1, bottom: 1 },
    };
    Sighting {
        spot,
        signal: None,
        log_light: Some(LogLight { value: light.ln(), sigma: LIGHT_SIGMA }),
        bearing,
        covariance_rad2,
        spot_covariance_rad2: covariance_rad2,
        rad_per_px: camera.rad_per_px(centre).unwrap(),
        resolution_rad: 2.5 * camera.rad_per_px(centre).unwrap(),
        bound_rad: 0.01,
        range: None,
    }
}
