//! A neighbour that shows two markers, what the locator reports of it, and the model of the same.

use std::f64::consts::FRAC_PI_2;

use nalgebra::Vector3;
use photinus::airframe::{Airframe, Ring};
use photinus::camera::{Camera, Ideal, IdealLaw, Model as Lens, Pixel};
use photinus::locator::{Input, Located, Locator, Settings};
use photinus::spots::Spot;
use rand_pcg::Pcg64;

use crate::model::{Model, Seen};
use crate::neighbour::{GRAVITY_RAD, TILT_RAD, UNIT_SIGMA, View as Neighbour};

const SIGMA_PX: f64 = 0.1;

pub(crate) fn hexarotor() -> Airframe {
    let ring = Ring { arms: 6, radius_m: 0.4, leds_per_arm: 1, splay_rad: 0.0 };
    Airframe::from_ring("hexarotor", ring).expect("a ring")
}

pub(crate) fn quadrotor() -> Airframe {
    let ring = Ring { arms: 4, radius_m: 0.245, leds_per_arm: 2, splay_rad: FRAC_PI_2 };
    Airframe::from_ring("quadrotor", ring).expect("a ring")
}

/// A neighbour, and what is seen of it.
pub(crate) struct View {
    neighbour: Neighbour,
    spots: [Spot; 2],
}

impl View {
    /// The first of random neighbours at a distance that shows exactly two markers.
    pub(crate) fn draw(airframe: &Airframe, distance_m: f64, rng: &mut Pcg64) -> Self {
        let camera = camera();
        loop {
            let neighbour = Neighbour::draw(distance_m, rng);
            let spots = neighbour.spots(airframe, &camera, SIGMA_PX, rng);
            if let Ok(spots) = <[Spot; 2]>::try_from(spots) {
                return Self { neighbour, spots };
            }
        }
    }

    pub(crate) fn position_m(&self) -> Vector3<f64> {
        self.neighbour.position_m
    }

    /// What the locator reports: one neighbour of both spots.
    pub(crate) fn locate<'a>(&self, locator: &'a mut Locator) -> &'a Located {
        locator.forget();
        let located = locator
            .locate(Input::spots(&self.spots).gravity(&self.neighbour.gravity))
            .expect("spots have no size");
        assert_eq!(located.neighbours.len(), 1, "both spots are one neighbour");
        located
    }

    /// The model of what was seen, within the bounds that were reported.
    pub(crate) fn model<'a>(&self, airframe: &'a Airframe, located: &Located) -> Model<'a> {
        let seen = [0, 1].map(|spot| Seen::of(&located.sightings[spot]));
        Model {
            airframe,
            seen,
            up: -self.neighbour.gravity,
            bounds: located.neighbours[0].distance.bounds,
            tilt_sigma_rad: tilt_sigma_rad(),
            unit_sigma: UNIT_SIGMA,
            detection_limit: located.detection_limit.expect("a frame"),
        }
    }
}

/// Of a neighbour against the vertical as it is known.
fn tilt_sigma_rad() -> f64 {
    libm::hypot(TILT_RAD, GRAVITY_RAD)
}

fn camera() -> Camera {
    let lens =
        Ideal::new(IdealLaw::Equidistant, [1.0 / 3.7673e-3; 2], Pixel::new(375.5, 239.5)).expect("a lens");
    Camera::new(Lens::Ideal(lens), 752, 480, None).expect("a camera")
}

/// A locator that believes what the model does.
pub(crate) fn locator(airframe: &Airframe) -> Locator {
    let mut settings = Settings::default();
    settings.pose.tilt_sigma_rad = tilt_sigma_rad();
    settings.pose.marker_sigma_m = 0.0;
    settings.pose.scale_sigma = 0.0;
    settings.pose.unit_sigma = UNIT_SIGMA;
    settings.pose.lobe_sigma = crate::model::LOBE_SIGMA;
    settings.pose.missed = crate::model::MISSED;
    settings.pose.use_brightness = true;
    settings.min_probability = 0.0;
    Locator::new(camera(), airframe, None, settings).expect("a locator")
}
