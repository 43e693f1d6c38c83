//! A set-up, rendered and located: how far neighbours are found and how far off their distances are.
//!
//! Neighbours differ from the drawing as the core believes that they do: markers a little off, the whole a little larger or smaller,
//! LEDs brighter or darker, tilted, at any heading, one in each frame.

use std::f64::consts::TAU;
use std::sync::Arc;

use nalgebra::{Isometry3, Rotation3, Translation3, Unit, UnitQuaternion, Vector3};
use photinus::airframe::{Airframe, Led};
use photinus::locator::{Input, Locator, Settings, Sighting};
use photinus_io::dataset::TruthLed;
use photinus_plan::Setup;
use photinus_sim::snapshot::{LedLight, Lit, Moving, Snapshot, Vehicle};
use photinus_sim::{CameraView, Renderer};
use rand_distr::{Distribution, StandardNormal, StandardUniform};
use rand_pcg::Pcg64;

/// A spot is of an LED that is no farther away, px; a neighbour is right within this angle, rad.
const SPOT_GATE_PX: f64 = 2.5;
const BEARING_GATE_RAD: f64 = 0.05;

/// LEDs are mounted askew by this per axis, rad: what the core's spread of lobes stands for.
const ASKEW_RAD: f64 = 0.0175;

/// What one frame gave.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Flown {
    pub(crate) distance_m: f64,
    /// Spots that are of its LEDs.
    pub(crate) spots: usize,
    /// Error of the distance of the neighbour that was located, m.
    pub(crate) error_m: Option<f64>,
}

/// Takes and locates frames of a set-up.
pub(crate) struct Flight<'a> {
    setup: &'a Setup,
    renderer: Renderer,
    locator: Locator,
    random: Pcg64,
    frame: u64,
}

impl<'a> Flight<'a> {
    pub(crate) fn new(setup: &'a Setup, seed: u64) -> Self {
        let (camera, lens, sensor) = (setup.camera.clone(), setup.lens.clone(), setup.sensor.clone());
        let mut settings = Settings::default();
        settings.spots.brightness = setup.brightness;
        // a plan says nothing of how sure it is that somebody is there
        settings.min_probability = 0.0;
        settings.pose.unit_sigma = setup.emitter.unit_spread;
        let locator = Locator::new(camera.clone(), &setup.airframe, None, settings).expect("a locator");
        let renderer = Renderer::new(CameraView { camera, lens, sensor }, seed);
        Self { setup, renderer, locator, random: Pcg64::new(u128::from(seed), 0xf1a), frame: 0 }
    }

    fn share(&mut self) -> f64 {
        StandardUniform.sample(&mut self.random)
    }

    fn normals(&mut self) -> Vector3<f64> {
        Vector3::from_fn(|_, _| StandardNormal.sample(&mut self.random))
    }

    /// A neighbour somewhere at this distance.
    pub(crate) fn look(&mut self, distance_m: f64) -> Flown {
        self.frame += 1;
        let exposure_s = self.setup.exposure_us * 1e-6;
        let vehicle = self.vehicle(distance_m);
        let snapshot = Snapshot {
            exposure: self.renderer.view().exposure(self.frame as f64, exposure_s),
            camera: Moving::still(Isometry3::from_parts(Translation3::identity(), level().into())),
            vehicles: vec![vehicle],
            emitter: self.setup.emitter,
            daylight: self.setup.daylight,
            water: None,
            lamps: Vec::new(),
        };
        let rendered = self.renderer.render(&snapshot, self.frame);
        let truth = &rendered.truth.neighbours[0];
        let down = Unit::new_unchecked(Vector3::y());
        let located = self.locator.locate(Input::frame(&rendered.image.view()).gravity(&down));
        let located = located.expect("the camera's size");
        let is_of_an_led = |spot: &&Sighting| {
            let gap_px =
                |led: &TruthLed| libm::hypot(spot.spot.centre.u - led.u_px, spot.spot.centre.v - led.v_px);
            truth.leds.iter().any(|led| gap_px(led) < SPOT_GATE_PX)
        };
        let direction = Vector3::from(truth.position_m) / truth.distance_m;
        let right = located
            .neighbours
            .iter()
            .filter(|neighbour| neighbour.bearing.vector().angle(&direction) < BEARING_GATE_RAD);
        let likeliest = right.max_by(|a, b| a.probability.total_cmp(&b.probability));
        let told = likeliest.and_then(|neighbour| neighbour.distance.estimate);
        let spots = located.sightings.iter().filter(is_of_an_led).count();
        Flown {
            distance_m,
            spots,
            // two spots of two markers: with one, another marker is made up
            error_m: told.filter(|_| spots >= 2).map(|told| told.distance_m - truth.distance_m),
        }
    }

    fn vehicle(&mut self, distance_m: f64) -> Vehicle {
        let watch = self.setup.watch;
        let (sin, cos) = libm::sincos((2.0 * self.share() - 1.0) * watch.azimuth_rad);
        let (sin_up, cos_up) = libm::sincos((2.0 * self.share() - 1.0) * watch.elevation_rad);
        let place_m = Vector3::new(cos * cos_up, -sin * cos_up, sin_up) * distance_m;
        let believed = Settings::default().pose;
        let tilt = Rotation3::new(
            self.normals().component_mul(&Vector3::new(1.0, 1.0, 0.0)) * believed.tilt_sigma_rad,
        );
        let turn = tilt * Rotation3::from_axis_angle(&Vector3::z_axis(), TAU * self.share());
        let scale = 1.0 + believed.scale_sigma * self.normals().x;
        let mut leds: Vec<Led> = self.setup.airframe.leds().to_vec();
        let mut lights = Vec::with_capacity(leds.len());
        for led in &mut leds {
            led.position_m = led.position_m * scale + self.normals() * believed.marker_sigma_m;
            led.axis = Rotation3::new(self.normals() * ASKEW_RAD) * led.axis;
            let power = self.setup.emitter.unit_factor(self.normals().x);
            lights.push(LedLight { power, lit: Lit::always() });
        }
        Vehicle {
            id: 1,
            airframe: Arc::new(Airframe::new("built", leds).expect("markers a little off")),
            solids: Arc::new([]),
            looks: Arc::default(),
            motion: Moving::still(Isometry3::from_parts(
                Translation3::from(place_m),
                UnitQuaternion::from_rotation_matrix(&turn),
            )),
            leds: lights,
        }
    }
}

/// world_from_camera of a camera that looks level along x of the world.
fn level() -> Rotation3<f64> {
    Rotation3::from_basis_unchecked(&[-Vector3::y(), -Vector3::z(), Vector3::x()])
}
