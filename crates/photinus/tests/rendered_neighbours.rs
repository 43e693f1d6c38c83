//! From rendered frames to neighbours: who is there, between strict bounds, whatever yaw, tilt and distance.
//!
//! Hexarotors and quadrotors with random attitudes are drawn as saturated or unsaturated Gaussian spots, seen through the
//! linear law of the paper's camera. Checked: truth never leaves the bounds, every neighbour is found, and the normalised
//! squared error (NEES) of its position is where it was measured. It is below 3, the number of dimensions: every LED here is as
//! bright as the next and stands where it should, and the priors allow for more. Not checked: optics and sensors, which a
//! simulator draws.

mod paper;

use std::f64::consts::{PI, TAU};

use nalgebra::{Rotation3, Unit, Vector3};
use photinus::airframe::Airframe;
use photinus::camera::{Bearing, Camera};
use photinus::frame::FrameView;
use photinus::locator::{Input, Locator, Settings};
use rand_distr::{Distribution, StandardNormal, Uniform};
use rand_pcg::Pcg64;

use paper::{HEIGHT, WIDTH, camera, hexarotor, quadrotor};

const BACKGROUND: f64 = 6.0;

fn uniform(rng: &mut Pcg64, low: f64, high: f64) -> f64 {
    Uniform::new(low, high).expect("a range").sample(rng)
}

/// Where a target is and how it is turned, in the frame of a camera that looks along the horizon.
struct Target {
    place_m: Vector3<f64>,
    camera_from_body: Rotation3<f64>,
}

impl Target {
    fn random(rng: &mut Pcg64, distance_m: f64) -> Self {
        let (azimuth, elevation) = (uniform(rng, -1.2, 1.2), uniform(rng, -0.35, 0.35));
        let ahead = Vector3::new(
            libm::cos(elevation) * libm::sin(azimuth),
            -libm::sin(elevation),
            libm::cos(elevation) * libm::cos(azimuth),
        );
        let (tilt_rad, towards) = (uniform(rng, 0.0, PI / 12.0), uniform(rng, 0.0, TAU));
        let tilt = Vector3::new(libm::cos(towards), 0.0, libm::sin(towards)) * tilt_rad;
        let upright = Rotation3::from_basis_unchecked(&[Vector3::x(), Vector3::z(), -Vector3::y()]);
        let yaw = Rotation3::from_axis_angle(&Vector3::z_axis(), uniform(rng, 0.0, TAU));
        Self { place_m: ahead * distance_m, camera_from_body: Rotation3::new(tilt) * upright * yaw }
    }

    /// Adds the light of every marker that shows: a Gaussian of 0.8 px, brighter the nearer.
    fn shine(&self, airframe: &Airframe, camera: &Camera, light: &mut [f64]) {
        const WIDTH_PX: f64 = 0.8;
        let camera_m = self.camera_from_body.inverse() * -self.place_m;
        for (marker, seen) in airframe.markers().iter().enumerate() {
            let marker_m = self.camera_from_body * seen.position_m + self.place_m;
            let Some(pixel) = Bearing::new(marker_m).and_then(|bearing| camera.pixel(&bearing)) else {
                continue;
            };
            let height = 9000.0 * airframe.intensity(marker, &camera_m) / marker_m.norm_squared();
            for v in (pixel.v - 8.0).max(0.0) as usize..((pixel.v + 9.0) as usize).min(HEIGHT) {
                for u in (pixel.u - 8.0).max(0.0) as usize..((pixel.u + 9.0) as usize).min(WIDTH) {
                    let (du, dv) = (u as f64 - pixel.u, v as f64 - pixel.v);
                    light[v * WIDTH + u] +=
                        height * libm::exp(-(du * du + dv * dv) / (2.0 * WIDTH_PX * WIDTH_PX));
                }
            }
        }
    }
}

fn expose(light: &[f64], rng: &mut Pcg64) -> Vec<u8> {
    let value = |light: &f64| {
        let noise: f64 = StandardNormal.sample(rng);
        (BACKGROUND + light + noise * (0.45 * 0.45 + 0.03 * light).sqrt()).round().clamp(0.0, 255.0) as u8
    };
    light.iter().map(value).collect()
}

#[test]
fn truth_never_leaves_the_bounds_of_a_rendered_neighbour() {
    let camera = camera();
    let down: Unit<Vector3<f64>> = Vector3::y_axis();
    for (airframe, reached) in [(hexarotor(), 0.73), (quadrotor(), 0.46)] {
        let mut rng = Pcg64::new(11, 3);
        let mut settings = Settings::default();
        settings.pose.scale_sigma = 0.0;
        settings.pose.marker_sigma_m = 0.001;
        settings.pose.unit_sigma = 0.12;
        let mut locator = Locator::new(camera.clone(), &airframe, None, settings).expect("a locator");
        let (mut frames, mut alone, mut normalised) = (0, 0, 0.0);
        for round in 0..120 {
            let distance_m = libm::exp(uniform(&mut rng, libm::log(1.2), libm::log(12.0)));
            let target = Target::random(&mut rng, distance_m);
            let mut light = vec![0.0; WIDTH * HEIGHT];
            target.shine(&airframe, &camera, &mut light);
            let pixels = expose(&light, &mut rng);
            let frame = FrameView::packed(&pixels, WIDTH, HEIGHT).expect("a frame");
            let gravity = (round % 2 == 0).then_some(&down);
            let located = locator.locate(Input::frame(&frame).gravity(gravity)).expect("the camera's size");
            frames += 1;
            assert!(!located.neighbours.is_empty(), "{} at {distance_m} m is not found", airframe.name());
            let [neighbour] = &located.neighbours[..] else { continue };
            alone += 1;
            let bounds = neighbour.distance.bounds;
            assert!(bounds.contains(distance_m), "{}: {distance_m} m outside {bounds:?}", airframe.name());
            if let Some(position) = neighbour.position {
                let error = position.mean_m - target.place_m;
                let inverse = position.covariance_m2.try_inverse().expect("a covariance of full rank");
                normalised += error.dot(&(inverse * error)).min(50.0);
            }
        }
        let nees = normalised / f64::from(alone);
        println!("{}: {alone} of {frames} alone, mean NEES {nees:.2}", airframe.name());
        assert_eq!(alone, frames, "{}", airframe.name());
        // Three tenths is what the scatter of 120 such numbers allows.
        assert!((nees / reached - 1.0).abs() < 0.3, "{}: NEES {nees}, not {reached}", airframe.name());
    }
}
