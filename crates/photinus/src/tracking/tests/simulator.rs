//! Vehicles that fly and the spots that an ideal camera sees of them: pure geometry, written apart from the tracker.
//!
//! The world's axes are the camera's at the beginning: y down.

use nalgebra::{Matrix2, Rotation3, Unit, Vector3};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;

use crate::airframe::{Airframe, Ring};
use crate::camera::{self, Bearing, Camera, Ideal, IdealLaw, Pixel, Rig};
use crate::locator::{self, Input, Locator};
use crate::pose::{self, Symmetry};
use crate::spots::{Extent, Spot};
use crate::tracking::step::Model;
use crate::tracking::{Look, Moving, Settings, Track, TrackError, Tracked, Tracker, Turned};

pub(crate) const SIGMA_PX: f64 = 0.1;
pub(crate) const RATE_HZ: f64 = 30.0;
const RAD_PER_PX: f64 = 3.7673e-3;
/// Light of an LED straight ahead at 1 m, and the least that the detector finds, grey levels.
const POWER: f64 = 100_000.0;
const FAINTEST: f64 = 75.0;
/// Nearer spots are one, px; so far the window of a centre reaches.
const ONE_SPOT_PX: f64 = 2.5;
const WINDOW_PX: f64 = 3.3;
/// A vehicle's motion is drawn in such steps, s.
const FINE_S: f64 = 1e-3;

pub(crate) fn camera() -> Camera {
    let lens = Ideal::new(IdealLaw::Equidistant, [1.0 / RAD_PER_PX; 2], Pixel::new(375.5, 239.5)).unwrap();
    Camera::new(camera::Model::Ideal(lens), 752, 480, None).unwrap()
}

pub(crate) fn hexarotor() -> Airframe {
    let ring = Ring { arms: 6, radius_m: 0.4, leds_per_arm: 1, splay_rad: 0.0 };
    Airframe::from_ring("hexarotor", ring).unwrap()
}

pub(crate) fn quadrotor() -> Airframe {
    let ring = Ring { arms: 4, radius_m: 0.245, leds_per_arm: 2, splay_rad: core::f64::consts::FRAC_PI_2 };
    Airframe::from_ring("quadrotor", ring).unwrap()
}

/// Spots as good as the airframe: nothing is off by a hand's work.
pub(crate) fn located_by() -> locator::Settings {
    let pose = pose::Settings {
        marker_sigma_m: 0.0,
        scale_sigma: 0.0,
        unit_sigma: 0.12,
        ..pose::Settings::default()
    };
    locator::Settings { pose, ..locator::Settings::default() }
}

/// What a tracker of hexarotors does not change.
pub(in crate::tracking) fn model() -> Model {
    let airframe = hexarotor();
    let (symmetry, pose) = (Symmetry::of(&airframe), located_by().pose);
    Model { rig: Rig::from(camera()), airframe, symmetry, pose, settings: Settings::default() }
}

/// An observer: camera, locator and tracker.
pub(crate) struct Observer {
    pub(crate) airframe: Airframe,
    pub(crate) locator: Locator,
    pub(crate) tracker: Tracker,
    /// How the camera was turned in the frame before.
    before: Rotation3<f64>,
    /// How well its gyro tells a turn from frame to frame, rad.
    pub(crate) gyro_sigma_rad: f64,
    /// How it moves over the ground, in its own axes, where it tells.
    pub(crate) moving: Option<Moving>,
}

impl Observer {
    pub(crate) fn new(airframe: Airframe, settings: Settings) -> Self {
        let locator = Locator::new(camera(), &airframe, None, located_by()).unwrap();
        let tracker = Tracker::new(camera(), &airframe, &located_by(), settings).unwrap();
        Self { airframe, locator, tracker, before: Rotation3::identity(), gyro_sigma_rad: 0.0, moving: None }
    }

    /// Forgets everything.
    pub(crate) fn forget(&mut self) {
        self.locator.forget();
        self.tracker.forget();
        self.before = Rotation3::identity();
    }

    /// Takes in a frame with these spots.
    pub(crate) fn see(
        &mut self,
        time_s: f64,
        seen: &[Seen],
        camera_from_world: &Rotation3<f64>,
        rng: &mut Pcg64,
    ) -> Result<Tracked, TrackError> {
        let spots: Vec<_> = seen.iter().map(|seen| seen.spot.clone()).collect();
        let gravity = down(camera_from_world);
        let noise = Rotation3::new(normal3(rng) * self.gyro_sigma_rad);
        let now_from_before = noise * camera_from_world * self.before.inverse();
        self.before = *camera_from_world;
        let look = Look {
            camera: 0,
            time_s,
            turned: Some(Turned { now_from_before, sigma_rad: self.gyro_sigma_rad }),
            moving: self.moving,
            gravity: Some(gravity),
            located: self.locator.locate(Input::spots(&spots).gravity(&gravity)).expect("spots have no size"),
            signals: &[],
            lit: &[],
            blinking: None,
        };
        self.tracker.track(&look).cloned()
    }
}

/// The track that is nearest to a vehicle in units of its covariance, with that distance squared.
pub(crate) fn nearest<'a>(
    tracked: &'a Tracked,
    vehicle: &Vehicle,
    camera_from_world: &Rotation3<f64>,
) -> Option<(&'a Track, f64)> {
    let truth_m = camera_from_world * vehicle.position_m;
    let off = |track: &'a Track| (track, nees(&(track.position_m - truth_m), &track.position_covariance_m2));
    tracked.tracks.iter().map(off).min_by(|a, b| a.1.total_cmp(&b.1))
}

pub(crate) fn normal(rng: &mut Pcg64) -> f64 {
    StandardNormal.sample(rng)
}

pub(crate) fn normal3(rng: &mut Pcg64) -> Vector3<f64> {
    Vector3::from_fn(|_, _| normal(rng))
}

/// Where a vehicle is, in the world's axes relative to the camera.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Vehicle {
    pub(crate) position_m: Vector3<f64>,
    pub(crate) velocity_m_s: Vector3<f64>,
    pub(crate) yaw_rad: f64,
    pub(crate) yaw_rate_rad_s: f64,
    /// About the world's horizontal axes, rad.
    pub(crate) tilt_rad: [f64; 2],
    /// Radius of what hides markers behind it, m.
    pub(crate) body_m: f64,
}

impl Vehicle {
    pub(crate) fn at(position_m: [f64; 3], velocity_m_s: [f64; 3], yaw_rad: f64) -> Self {
        let [position_m, velocity_m_s] = [position_m, velocity_m_s].map(Vector3::from);
        Self { position_m, velocity_m_s, yaw_rad, yaw_rate_rad_s: 0.0, tilt_rad: [0.0; 2], body_m: 0.0 }
    }

    /// Whether it hides a place from the camera.
    fn hides(&self, place_m: &Vector3<f64>) -> bool {
        let ahead = place_m.normalize();
        let along_m = ahead.dot(&self.position_m);
        along_m < place_m.norm() && (self.position_m - ahead * along_m).norm() < self.body_m
    }

    pub(crate) fn world_from_body(&self) -> Rotation3<f64> {
        // Body z up is -y, body x is the camera's right at yaw 0.
        let upright = Rotation3::from_basis_unchecked(&[Vector3::x(), Vector3::z(), -Vector3::y()]);
        let [about_x, about_z] = self.tilt_rad;
        Rotation3::new(Vector3::new(about_x, 0.0, about_z))
            * upright
            * Rotation3::from_axis_angle(&Vector3::z_axis(), self.yaw_rad)
    }

    /// Flies on as the tracker's priors have it, in fine steps.
    pub(crate) fn drawn(
        mut self,
        interval_s: f64,
        settings: &Settings,
        tilt_sigma_rad: f64,
        rng: &mut Pcg64,
    ) -> Self {
        let steps = (interval_s / FINE_S).round().max(1.0);
        let fine_s = interval_s / steps;
        for _ in 0..steps as usize {
            let kick_m_s = normal3(rng) * (settings.acceleration * fine_s.sqrt());
            self.position_m += (self.velocity_m_s + kick_m_s * 0.5) * fine_s;
            self.velocity_m_s += kick_m_s;
            self.yaw_rad += self.yaw_rate_rad_s * fine_s;
            let time_s = settings.yaw_rate_time_s;
            self.yaw_rate_rad_s -= self.yaw_rate_rad_s * fine_s / time_s;
            self.yaw_rate_rad_s +=
                settings.yaw_rate_sigma_rad_s * (2.0 * fine_s / time_s).sqrt() * normal(rng);
            for tilt in &mut self.tilt_rad {
                *tilt -= *tilt * fine_s / settings.tilt_time_s;
                *tilt += tilt_sigma_rad * (2.0 * fine_s / settings.tilt_time_s).sqrt() * normal(rng);
            }
        }
        self
    }

    /// Flies on evenly.
    pub(crate) fn on(mut self, interval_s: f64) -> Self {
        self.position_m += self.velocity_m_s * interval_s;
        self
    }
}

/// A spot, and which marker it is: the brightest, and whether it is that one alone.
#[derive(Clone, Debug)]
pub(crate) struct Seen {
    pub(crate) spot: Spot,
    pub(crate) marker: usize,
    pub(crate) is_alone: bool,
}

/// What the camera sees, turned against the world.
pub(crate) fn look(
    airframe: &Airframe,
    vehicles: &[Vehicle],
    camera_from_world: &Rotation3<f64>,
    rng: &mut Pcg64,
) -> Vec<Seen> {
    let camera = camera();
    let mut points = Vec::new();
    for vehicle in vehicles {
        let place_m = camera_from_world * vehicle.position_m;
        let camera_from_body = camera_from_world * vehicle.world_from_body();
        let camera_m = camera_from_body.inverse() * -place_m;
        for (number, marker) in airframe.markers().iter().enumerate() {
            let at_m = camera_from_body * marker.position_m + place_m;
            let flux = POWER * airframe.intensity(number, &camera_m) / at_m.norm_squared();
            let within = |pixel: &Pixel| (3.0..748.0).contains(&pixel.u) && (3.0..476.0).contains(&pixel.v);
            let pixel = Bearing::new(at_m).and_then(|bearing| camera.pixel(&bearing)).filter(within);
            let at_m = camera_from_world.inverse() * at_m;
            let is_hidden = vehicles.iter().any(|other| other.hides(&at_m));
            if let Some(pixel) = pixel.filter(|_| flux >= FAINTEST && !is_hidden) {
                points.push((flux, pixel, number));
            }
        }
    }
    points.sort_by(|a, b| b.0.total_cmp(&a.0));
    let gap = |a: &Pixel, b: &Pixel| libm::hypot(a.u - b.u, a.v - b.v);
    // Those that have a spot of their own, and those that shine into the windows of others.
    let mut own: Vec<usize> = Vec::new();
    for index in 0..points.len() {
        if own.iter().all(|&brighter| gap(&points[brighter].1, &points[index].1) >= ONE_SPOT_PX) {
            own.push(index);
        }
    }
    let mut seen = Vec::new();
    for &index in &own {
        let (flux, at, marker) = points[index];
        let (mut total, mut u, mut v) = (flux, flux * at.u, flux * at.v);
        for (_, (light, other, ..)) in points.iter().enumerate().filter(|(index, _)| !own.contains(index)) {
            let off = gap(other, &at);
            if off < WINDOW_PX {
                let window = 1.0 - off * off / (WINDOW_PX * WINDOW_PX);
                let weight = light * window * window;
                (total, u, v) = (total + weight, u + weight * other.u, v + weight * other.v);
            }
        }
        let centre = Pixel::new(u / total + SIGMA_PX * normal(rng), v / total + SIGMA_PX * normal(rng));
        seen.push(Seen { spot: spot(centre, total), marker, is_alone: total <= flux });
    }
    // As a detector reports them.
    seen.sort_by(|a, b| a.spot.centre.v.total_cmp(&b.spot.centre.v));
    seen
}

pub(crate) fn spot(centre: Pixel, flux: f64) -> Spot {
    let half = 1.5;
    let within = |at: f64| at.round().max(0.0) as u32;
    Spot {
        centre,
        covariance_px2: Matrix2::from_diagonal_element(SIGMA_PX * SIGMA_PX),
        area_px: 9,
        peak: 200,
        saturated_px: 0,
        flux,
        light: None,
        background: 5.0,
        marker_log_odds: 3.0,
        middle: (within(centre.u), within(centre.v)),
        extent: Extent {
            left: within(centre.u - half),
            top: within(centre.v - half),
            right: within(centre.u + half),
            bottom: within(centre.v + half),
        },
    }
}

pub(crate) fn down(camera_from_world: &Rotation3<f64>) -> Unit<Vector3<f64>> {
    Unit::new_normalize(camera_from_world * Vector3::y())
}

/// The squared error in units of its covariance.
pub(crate) fn nees(error: &Vector3<f64>, covariance: &nalgebra::Matrix3<f64>) -> f64 {
    error.dot(&covariance.cholesky().unwrap().solve(error))
}
