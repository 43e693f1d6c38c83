//! Neighbours drawn from what the program believes by default: the priors of `photinus::pose::Settings`, with the tilt limit of
//! the bounds.
//!
//! Whatever a row changes, the same random numbers are drawn for a frame: rows differ by what they change alone.

use std::f64::consts::TAU;
use std::sync::Arc;

use nalgebra::{Isometry3, Rotation3, Translation3, Unit, UnitQuaternion, Vector3};
use photinus::airframe::{Airframe, Led};
use photinus::camera::{Camera, Pixel};
use photinus::locator::Settings;
use photinus_sim::clock::Clock;
use photinus_sim::occlusion::Solid;
use photinus_sim::snapshot::{LedLight, Lit, Moving, Vehicle};
use photinus_sim::source::Blink;
use rand_distr::{Distribution, StandardNormal, StandardUniform};
use rand_pcg::Pcg64;

/// Error of the known gravity per axis, rad; with the tilt it makes up the default's tilt sigma.
const GRAVITY_RAD: f64 = 0.5 * TAU / 360.0;
/// LEDs are mounted askew by this per axis, rad: what the default's spread of lobes stands for.
const ASKEW_RAD: f64 = 1.0 * TAU / 360.0;
/// Neighbours are no further above or below the camera than this, rad.
const ELEVATION_RAD: f64 = 20.0 * TAU / 360.0;
/// Share of the image in which neighbours' middles are.
const INNER: f64 = 0.9;
/// Two vehicles are no nearer to each other, m.
const APART_M: f64 = 1.0;
/// Bits per second of LEDs that blink, and the words of four arms: half of each is on.
const BIT_RATE_HZ: f64 = 60.0;
const WORDS: [u16; 4] = [0b0010_0101_0111, 0b0010_0110_1011, 0b1101_0001_0110, 0b1001_1100_1010];
const WORD_BITS: usize = 12;

/// How vehicles differ from the drawing that is told.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Build {
    /// Spread of power: sigma of its logarithm.
    pub(crate) unit_sigma: f64,
    /// How far markers are off, m per axis.
    pub(crate) marker_sigma_m: f64,
    /// How much larger or smaller a whole airframe is: sigma of the factor.
    pub(crate) scale_sigma: f64,
    /// The arm of one marker is longer by this factor.
    pub(crate) long_arm: f64,
    /// Whether one LED is dead.
    pub(crate) dead_led: bool,
    /// Whether the arms blink, each a word of its own.
    pub(crate) blinks: bool,
}

impl Default for Build {
    fn default() -> Self {
        let believed = Settings::default().pose;
        Self {
            unit_sigma: believed.unit_sigma,
            marker_sigma_m: believed.marker_sigma_m,
            scale_sigma: believed.scale_sigma,
            long_arm: 1.0,
            dead_led: false,
            blinks: false,
        }
    }
}

fn uniform(rng: &mut Pcg64) -> f64 {
    StandardUniform.sample(rng)
}

fn normals(rng: &mut Pcg64) -> Vector3<f64> {
    Vector3::from_fn(|_, _| StandardNormal.sample(rng))
}

fn one_of(count: usize, rng: &mut Pcg64) -> usize {
    (uniform(rng) * count as f64) as usize
}

impl Build {
    /// The airframe as somebody built it, and what each of its LEDs gives; a dead one gives nothing.
    fn built(&self, drawing: &Airframe, rng: &mut Pcg64) -> (Airframe, Vec<f64>) {
        let missed = Settings::default().pose.missed;
        let long = one_of(drawing.markers().len(), rng);
        let dead_led = one_of(drawing.leds().len(), rng);
        let draw: f64 = StandardNormal.sample(rng);
        let scale = 1.0 + self.scale_sigma * draw;
        let mut leds: Vec<Led> = drawing.leds().to_vec();
        let mut powers = vec![0.0; leds.len()];
        for (number, marker) in drawing.markers().iter().enumerate() {
            let off_m = normals(rng) * self.marker_sigma_m;
            let is_dead = uniform(rng) < missed;
            for &led in &marker.leds {
                let askew = Rotation3::new(normals(rng) * ASKEW_RAD);
                let draw: f64 = StandardNormal.sample(rng);
                let factor = if number == long { scale * self.long_arm } else { scale };
                leds[led].position_m = leds[led].position_m * factor + off_m;
                leds[led].axis = askew * leds[led].axis;
                let shines = !(is_dead || self.dead_led && led == dead_led);
                powers[led] = if shines { libm::exp(self.unit_sigma * draw) } else { 0.0 };
            }
        }
        (Airframe::new(drawing.name(), leds).expect("markers a little off are still apart"), powers)
    }

    /// When each LED of an airframe shines during an exposure of `length_s` from time 0.
    fn lit(&self, airframe: &Airframe, length_s: f64, rng: &mut Pcg64) -> Vec<Lit> {
        let clock = Clock { offset_s: uniform(rng) * WORD_BITS as f64 / BIT_RATE_HZ, ppm: 0.0 };
        let mut lit = vec![Lit::always(); airframe.leds().len()];
        for (arm, marker) in airframe.markers().iter().enumerate().filter(|_| self.blinks) {
            let word = (0..WORD_BITS).map(|bit| WORDS[arm % WORDS.len()] >> bit & 1 == 1).collect();
            let blink = Blink::new(word, BIT_RATE_HZ, clock).expect("a word and a rate");
            marker.leds.iter().for_each(|&led| blink.light(0.0, length_s, &mut lit[led]));
        }
        lit
    }
}

/// The camera looks level along x of the world.
pub(crate) fn world_from_camera() -> Rotation3<f64> {
    Rotation3::from_basis_unchecked(&[-Vector3::y(), -Vector3::z(), Vector3::x()])
}

/// Gravity as it is known, in the camera frame.
pub(crate) fn known_gravity(rng: &mut Pcg64) -> Unit<Vector3<f64>> {
    let off = normals(rng).component_mul(&Vector3::new(1.0, 0.0, 1.0)) * GRAVITY_RAD;
    Unit::new_normalize(Rotation3::new(off) * Vector3::y())
}

/// What is drawn of vehicles.
pub(crate) struct Drawing<'a> {
    pub(crate) airframe: &'a Airframe,
    pub(crate) build: Build,
    pub(crate) camera: &'a Camera,
    pub(crate) ranges_m: [f64; 2],
    pub(crate) exposure_s: f64,
    /// How far the image of a vehicle moves to the right during the exposure, px.
    pub(crate) smear_px: f64,
}

impl Drawing<'_> {
    /// So many vehicles, apart from each other.
    pub(crate) fn vehicles(&self, count: usize, gravity: &Vector3<f64>, rng: &mut Pcg64) -> Vec<Vehicle> {
        let mut places: Vec<Vector3<f64>> = Vec::new();
        (1..=count as u32)
            .map(|id| {
                let place = self.place(&places, rng);
                places.push(place);
                self.vehicle(id, place, gravity, rng)
            })
            .collect()
    }

    fn vehicle(&self, id: u32, place: Vector3<f64>, gravity: &Vector3<f64>, rng: &mut Pcg64) -> Vehicle {
        let (airframe, powers) = self.build.built(self.airframe, rng);
        let lit = self.build.lit(self.airframe, self.exposure_s, rng);
        let turn = world_from_camera() * attitude(gravity, rng);
        let pose = |place: Vector3<f64>| {
            let turn = UnitQuaternion::from_rotation_matrix(&turn);
            Isometry3::from_parts(Translation3::from(world_from_camera() * place), turn)
        };
        let way = self.to_the_right(&place) * self.smear_px;
        let poses = [-0.5, 0.0, 0.5].map(|share| pose(place + way * share));
        let light = |(power, lit)| LedLight { power, lit };
        let middle = Solid::Cylinder { centre_m: Vector3::zeros(), radius_m: 0.12, half_height_m: 0.08 };
        Vehicle {
            id,
            airframe: Arc::new(airframe),
            solids: Arc::new([middle]),
            looks: Arc::default(),
            motion: Moving::through(poses),
            leds: powers.into_iter().zip(lit).map(light).collect(),
        }
    }

    /// A place in the field, in the camera frame: any direction, the logarithm of distance even.
    fn place(&self, others: &[Vector3<f64>], rng: &mut Pcg64) -> Vector3<f64> {
        let [near_m, far_m] = self.ranges_m;
        loop {
            let mut along = |side: usize| (0.5 + INNER * (uniform(rng) - 0.5)) * side as f64 - 0.5;
            let pixel = Pixel::new(along(self.camera.width()), along(self.camera.height()));
            let distance_m = near_m * libm::pow(far_m / near_m, uniform(rng));
            let Some(bearing) = self.camera.bearing(pixel) else { continue };
            let place = bearing.vector() * distance_m;
            let is_clear = others.iter().all(|other| (other - place).norm() >= APART_M);
            if libm::asin(bearing.vector().y).abs() <= ELEVATION_RAD && is_clear {
                return place;
            }
        }
    }

    /// How far a place goes when its image goes a pixel to the right, m.
    fn to_the_right(&self, place: &Vector3<f64>) -> Vector3<f64> {
        let pixel = photinus::camera::Bearing::new(*place).and_then(|bearing| self.camera.pixel(&bearing));
        let jacobian = pixel.and_then(|pixel| self.camera.bearing_with_jacobian(pixel));
        jacobian.map_or(Vector3::zeros(), |(_, jacobian)| jacobian.column(0) * place.norm())
    }
}

/// Any yaw, tilted as the default believes, within the limit of the bounds against the gravity that is known.
fn attitude(gravity: &Vector3<f64>, rng: &mut Pcg64) -> Rotation3<f64> {
    let settings = Settings::default();
    let sigma_rad = settings.pose.tilt_sigma_rad;
    let tilt_rad = (sigma_rad * sigma_rad - GRAVITY_RAD * GRAVITY_RAD).sqrt();
    let upright = Rotation3::from_basis_unchecked(&[Vector3::x(), Vector3::z(), -Vector3::y()]);
    let yaw = Rotation3::from_axis_angle(&Vector3::z_axis(), TAU * uniform(rng));
    loop {
        let tilt = Rotation3::new(normals(rng).component_mul(&Vector3::new(1.0, 0.0, 1.0)) * tilt_rad);
        let turn = tilt * upright * yaw;
        let down = turn * -Vector3::z();
        if libm::atan2(down.cross(gravity).norm(), down.dot(gravity)) < settings.max_tilt_rad {
            return turn;
        }
    }
}
