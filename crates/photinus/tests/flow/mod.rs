//! A fixed set of frames through the whole flow, drawn here without anything that differs between machines: nothing enters, a hash of all
//! that was told leaves. Linked into the tests and into what runs without an operating system.

use nalgebra::{Rotation3, Unit, Vector3};
use photinus::airframe::Airframe;
use photinus::camera::{Bearing, Camera};
use photinus::frame::FrameView;
use photinus::locator::{Input, Located, Locator, Settings};

use crate::hash::Hash;
use crate::paper::{HEIGHT, WIDTH, camera, hexarotor, quadrotor};

/// Whole-number noise and attitudes: no crate's random numbers, which may come by sines of the machine.
struct Dice(u64);

impl Dice {
    /// 0 to 1, in steps of 2^-31.
    fn share(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as f64 / f64::from(1_u32 << 31)
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.share()
    }
}

/// Adds a neighbour's markers as Gaussians of 0.8 px.
fn shine(airframe: &Airframe, camera: &Camera, dice: &mut Dice, light: &mut [f64]) {
    let (azimuth, elevation) = (dice.between(-1.0, 1.0), dice.between(-0.3, 0.3));
    let (sin_az, cos_az) = libm::sincos(azimuth);
    let (sin_el, cos_el) = libm::sincos(elevation);
    let place_m = Vector3::new(cos_el * sin_az, -sin_el, cos_el * cos_az) * dice.between(1.5, 10.0);
    let upright = Rotation3::from_basis_unchecked(&[Vector3::x(), Vector3::z(), -Vector3::y()]);
    let tilt = Rotation3::new(Vector3::new(dice.between(-0.15, 0.15), 0.0, dice.between(-0.15, 0.15)));
    let yaw = Rotation3::from_axis_angle(&Vector3::z_axis(), dice.between(-3.0, 3.0));
    let camera_from_body = tilt * upright * yaw;
    let camera_m = camera_from_body.inverse() * -place_m;
    for (marker, seen) in airframe.markers().iter().enumerate() {
        let marker_m = camera_from_body * seen.position_m + place_m;
        let Some(pixel) = Bearing::new(marker_m).and_then(|bearing| camera.pixel(&bearing)) else { continue };
        let height = 9000.0 * airframe.intensity(marker, &camera_m) / marker_m.norm_squared();
        for v in (pixel.v - 8.0).max(0.0) as usize..((pixel.v + 9.0) as usize).min(HEIGHT) {
            for u in (pixel.u - 8.0).max(0.0) as usize..((pixel.u + 9.0) as usize).min(WIDTH) {
                let (du, dv) = (u as f64 - pixel.u, v as f64 - pixel.v);
                light[v * WIDTH + u] += height * libm::exp(-(du * du + dv * dv) / (2.0 * 0.8 * 0.8));
            }
        }
    }
}

/// Everything that a frame told, in the order in which it stands.
fn add(hash: &mut Hash, located: &Located) {
    for sighting in &located.sightings {
        hash.numbers(&[sighting.spot.centre.u, sighting.spot.centre.v, sighting.bound_rad]);
        hash.numbers(sighting.bearing.vector().iter().chain(&sighting.covariance_rad2));
    }
    hash.word(located.rejected.len() as u64);
    for neighbour in &located.neighbours {
        neighbour.sightings.iter().for_each(|&member| hash.word(member as u64));
        hash.numbers(neighbour.bearing.vector().iter());
        hash.numbers(&[neighbour.probability, neighbour.misfit.chi_square]);
        let distance = &neighbour.distance;
        hash.numbers(&[distance.bounds.min_m(), distance.bounds.max_m()]);
        for length_m in [distance.perpendicular_m, distance.inline_m].into_iter().flatten() {
            hash.number(length_m);
        }
        if let Some(estimate) = &distance.estimate {
            hash.numbers(&[estimate.distance_m, estimate.sigma_m]);
        }
        if let Some(position) = &neighbour.position {
            hash.numbers(position.mean_m.iter().chain(&position.covariance_m2));
        }
        if let Some(orientation) = &neighbour.orientation {
            hash.numbers(orientation.camera_from_body.matrix().iter().chain(&orientation.covariance_rad2));
        }
        for mode in &neighbour.modes {
            hash.number(mode.weight);
            hash.numbers(mode.pose.position_m.iter().chain(mode.pose.camera_from_body.matrix()));
            hash.numbers(mode.position_covariance_m2.iter().chain(&mode.orientation_covariance_rad2));
        }
    }
}

/// What came out.
pub(crate) struct Told {
    pub(crate) neighbours: usize,
    pub(crate) modes: usize,
    /// Neighbours with an attitude.
    pub(crate) posed: usize,
    pub(crate) hash: u64,
}

/// The hash, as it was written down.
pub(crate) const PINNED: u64 = 0x3018_7ad5_ddab_3abd;

/// Renders and locates the frames.
pub(crate) fn locate() -> Told {
    let (camera, down): (Camera, Unit<Vector3<f64>>) = (camera(), Vector3::y_axis());
    let mut total = Hash::new();
    let (mut neighbours, mut modes, mut posed) = (0, 0, 0);
    for (airframe, seed) in [(hexarotor(), 1), (quadrotor(), 2)] {
        let mut locator =
            Locator::new(camera.clone(), &airframe, None, Settings::default()).expect("a locator");
        let mut dice = Dice(seed);
        for frame in 0..8 {
            let mut light = vec![6.0; WIDTH * HEIGHT];
            (0..1 + frame % 3).for_each(|_| shine(&airframe, &camera, &mut dice, &mut light));
            let pixels: Vec<u8> = light.iter().map(|light| (light + 2.0 * dice.share()) as u8).collect();
            let view = FrameView::packed(&pixels, WIDTH, HEIGHT).expect("a frame");
            let gravity = (frame % 2 == 0).then_some(&down);
            let located = locator.locate(Input::frame(&view).gravity(gravity)).expect("the camera's size");
            neighbours += located.neighbours.len();
            posed += located.neighbours.iter().filter(|neighbour| neighbour.orientation.is_some()).count();
            modes += located.neighbours.iter().map(|neighbour| neighbour.modes.len()).sum::<usize>();
            add(&mut total, located);
        }
    }
    Told { neighbours, modes, posed, hash: total.value() }
}
