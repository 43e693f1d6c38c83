//! A neighbour that shows two markers, what the locator reports of it, and the model of the same.

use std::f64::consts::{FRAC_PI_2, TAU};

use nalgebra::{Matrix2, Rotation3, Unit, Vector3};
use photinus::airframe::{Airframe, Ring};
use photinus::camera::{Bearing, Camera, Ideal, IdealLaw, Model as Lens, Pixel};
use photinus::locator::{Located, Locator, Settings};
use photinus::pose;
use photinus::spots::{Extent, Spot};
use rand_distr::{Distribution, StandardNormal, Uniform};
use rand_pcg::Pcg64;

use crate::model::{Model, Seen};

const SIGMA_PX: f64 = 0.1;
const UNIT_SIGMA: f64 = 0.1;
const TILT_RAD: f64 = 4.0 * TAU / 360.0;
/// Light of an LED straight ahead at 1 m, and the least that is found, grey levels.
const POWER: f64 = 40_000.0;
const FAINTEST: f64 = 84.0;

pub(crate) fn hexarotor() -> Airframe {
    let ring = Ring { arms: 6, radius_m: 0.4, leds_per_arm: 1, splay_rad: 0.0 };
    Airframe::from_ring("hexarotor", ring).expect("a ring")
}

pub(crate) fn quadrotor() -> Airframe {
    let ring = Ring { arms: 4, radius_m: 0.245, leds_per_arm: 2, splay_rad: FRAC_PI_2 };
    Airframe::from_ring("quadrotor", ring).expect("a ring")
}

/// Where a neighbour is, and what is seen of it.
pub(crate) struct View {
    pub(crate) position_m: Vector3<f64>,
    spots: [Spot; 2],
}

impl View {
    /// The first of random poses at a distance that shows exactly two markers.
    pub(crate) fn draw(airframe: &Airframe, distance_m: f64, rng: &mut Pcg64) -> Self {
        loop {
            let mut between = |low, high| -> f64 { Uniform::new(low, high).expect("a range").sample(rng) };
            let (azimuth, elevation, yaw) = (between(-0.5, 0.5), between(-0.3, 0.3), between(0.0, TAU));
            let ((sin, cos), (up, level)) = (libm::sincos(azimuth), libm::sincos(elevation));
            let position_m = Vector3::new(sin * level, -up, cos * level) * distance_m;
            let mut normal = || -> f64 { StandardNormal.sample(rng) };
            let upright = Rotation3::from_basis_unchecked(&[Vector3::x(), Vector3::z(), -Vector3::y()]);
            let tilt = Rotation3::new(Vector3::new(normal(), 0.0, normal()) * TILT_RAD);
            let turn = tilt * upright * Rotation3::from_axis_angle(&Vector3::z_axis(), yaw);
            let spots = spots(airframe, &position_m, &turn, &mut normal);
            if let Ok(spots) = <[Spot; 2]>::try_from(spots) {
                return Self { position_m, spots };
            }
        }
    }

    /// What the locator reports: one neighbour of both spots.
    pub(crate) fn locate<'a>(&self, locator: &'a mut Locator) -> &'a Located {
        let located = locator.locate_spots(&self.spots, Some(&down()), &mut |_| ());
        assert_eq!(located.neighbours.len(), 1, "both spots are one neighbour");
        located
    }

    /// The model of what was seen, within the bounds that were reported.
    pub(crate) fn model<'a>(&self, airframe: &'a Airframe, located: &Located) -> Model<'a> {
        let seen = [0, 1].map(|spot| Seen::of(&located.sightings[spot]));
        Model {
            airframe,
            seen,
            up: -down(),
            bounds: located.neighbours[0].distance.bounds,
            tilt_sigma_rad: TILT_RAD,
            unit_sigma: UNIT_SIGMA,
            faintest: FAINTEST,
        }
    }
}

fn down() -> Unit<Vector3<f64>> {
    Vector3::y_axis()
}

fn camera() -> Camera {
    let lens =
        Ideal::new(IdealLaw::Equidistant, [1.0 / 3.7673e-3; 2], Pixel::new(375.5, 239.5)).expect("a lens");
    Camera::new(Lens::Ideal(lens), 752, 480, None).expect("a camera")
}

/// A locator that believes what the model does.
pub(crate) fn locator(airframe: &Airframe) -> Locator {
    let pose = pose::Settings {
        tilt_sigma_rad: TILT_RAD,
        marker_sigma_m: 0.0,
        unit_sigma: UNIT_SIGMA,
        missed: crate::model::MISSED,
        use_brightness: true,
    };
    Locator::new(camera(), airframe, None, Settings { pose, ..Settings::default() }).expect("a locator")
}

/// The spots of the markers that are bright enough to be found.
fn spots(
    airframe: &Airframe,
    position_m: &Vector3<f64>,
    turn: &Rotation3<f64>,
    normal: &mut impl FnMut() -> f64,
) -> Vec<Spot> {
    let camera_m = -(turn.inverse() * position_m);
    let mut spots = Vec::new();
    for (number, marker) in airframe.markers().iter().enumerate() {
        let place_m = turn * marker.position_m + position_m;
        let flux = POWER * airframe.intensity(number, &camera_m) / place_m.norm_squared()
            * libm::exp(UNIT_SIGMA * normal());
        let Some(pixel) = Bearing::new(place_m).and_then(|bearing| camera().pixel(&bearing)) else {
            continue;
        };
        if flux >= FAINTEST {
            spots.push(spot(Pixel::new(pixel.u + SIGMA_PX * normal(), pixel.v + SIGMA_PX * normal()), flux));
        }
    }
    spots
}

fn spot(centre: Pixel, flux: f64) -> Spot {
    let middle = (centre.u.round() as u32, centre.v.round() as u32);
    Spot {
        centre,
        covariance_px2: Matrix2::from_diagonal_element(SIGMA_PX * SIGMA_PX),
        area_px: 4,
        peak: 200,
        saturated_px: 0,
        flux,
        background: 5.0,
        middle,
        extent: Extent { left: middle.0 - 1, top: middle.1 - 1, right: middle.0 + 1, bottom: middle.1 + 1 },
    }
}
