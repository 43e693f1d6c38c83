//! Many views of one neighbour at one distance -> errors by the number of spots used, beside what is possible.

use std::f64::consts::{FRAC_PI_2, TAU};

use nalgebra::Matrix3;
use photinus::airframe::{Airframe, Ring};
use photinus::camera::{Camera, Ideal, IdealLaw, Model, Pixel};
use photinus::locator::{Input, Located, Locator, Neighbour, Settings};
use rand_pcg::Pcg64;

use crate::render;
use crate::view::{GRAVITY_RAD, TILT_RAD, UNIT_SIGMA, View};

/// Most spots that one of the airframes shows.
pub(crate) const MOST_SPOTS: usize = 6;
/// 95 % of the squared lengths of three normal numbers are below this.
const INSIDE_95: f64 = 7.815;
/// Spread of power of the LEDs of rendered frames, of its logarithm.
const RENDERED_UNIT_SIGMA: f64 = 0.06;
/// A squared error larger than this counts as this: one wrong mode must not hide the rest.
const CAP: f64 = 1000.0;

/// The paper's two airframes, by the names of their files in scenes/.
pub(crate) fn airframes() -> [Airframe; 2] {
    let hexarotor = Ring { arms: 6, radius_m: 0.4, leds_per_arm: 1, splay_rad: 0.0 };
    let quadrotor = Ring { arms: 4, radius_m: 0.245, leds_per_arm: 2, splay_rad: FRAC_PI_2 };
    [("hexarotor-0.4", hexarotor), ("quadrotor-0.245", quadrotor)]
        .map(|(name, ring)| Airframe::from_ring(name, ring).expect("a ring"))
}

/// Sums over neighbours with one number of spots.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Tally {
    pub(crate) count: f64,
    squares_m2: f64,
    off_m: f64,
    bounds_m2: f64,
    squared_errors: f64,
    inside: f64,
    squared_yaws: f64,
    pub(crate) outside_bounds: f64,
}

impl Tally {
    pub(crate) fn rmse_m(&self) -> f64 {
        (self.squares_m2 / self.count).sqrt()
    }

    pub(crate) fn bound_m(&self) -> f64 {
        (self.bounds_m2 / self.count).sqrt()
    }

    pub(crate) fn bias_m(&self) -> f64 {
        self.off_m / self.count
    }

    /// Normalised squared error of the position: 3 when the covariance tells the truth.
    pub(crate) fn nees(&self) -> f64 {
        self.squared_errors / self.count
    }

    pub(crate) fn inside_95(&self) -> f64 {
        self.inside / self.count
    }

    pub(crate) fn yaw_nees(&self) -> f64 {
        self.squared_yaws / self.count
    }

    fn add(&mut self, view: &View, neighbour: &Neighbour, turns: f64, bound_m2: f64) {
        let estimate = neighbour.distance.estimate.expect("no view without an answer");
        let position = neighbour.position.expect("no view without an answer");
        let orientation = neighbour.orientation.expect("no view without an answer");
        let off_m = position.mean_m - view.position_m;
        let squared = squared_error(&position.covariance_m2, &off_m);
        let distance_m = view.position_m.norm();
        let distance_off_m = estimate.distance_m - distance_m;
        let turn = (orientation.camera_from_body.inverse() * view.camera_from_body).scaled_axis().z;
        let sector = TAU / turns;
        let yaw_off = turn - (turn / sector).round() * sector;
        self.count += 1.0;
        self.squares_m2 += distance_off_m * distance_off_m;
        self.off_m += distance_off_m;
        self.bounds_m2 += bound_m2;
        self.squared_errors += squared.min(CAP);
        self.inside += f64::from(u8::from(squared < INSIDE_95));
        self.squared_yaws += (yaw_off * yaw_off / orientation.covariance_rad2[(2, 2)]).min(CAP);
        self.outside_bounds += f64::from(u8::from(!neighbour.distance.bounds.contains(distance_m)));
    }
}

fn squared_error(covariance: &Matrix3<f64>, off: &nalgebra::Vector3<f64>) -> f64 {
    covariance.cholesky().map_or(f64::INFINITY, |factor| off.dot(&factor.solve(off)))
}

/// Where spots come from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Source {
    /// Pure geometry with a known error of each spot, px.
    Geometry { sigma_px: f64 },
    /// Rendered frames and the detector.
    Rendered,
}

impl Source {
    fn camera(self) -> Camera {
        match self {
            Self::Rendered => {
                render::scene(&render::PAPER, "hexarotor-0.4", 0, None).cameras[0].camera.clone()
            }
            Self::Geometry { .. } => {
                let centre = Pixel::new(375.5, 239.5);
                let lens = Ideal::new(IdealLaw::Equidistant, [1.0 / 3.7673e-3; 2], centre).expect("a lens");
                Camera::new(Model::Ideal(lens), 752, 480, None).expect("a camera")
            }
        }
    }
}

/// Errors by the number of spots used, and how often nothing was found.
pub(crate) fn run(
    airframe: &Airframe,
    distance_m: f64,
    source: Source,
    count: usize,
) -> ([Tally; MOST_SPOTS + 1], usize) {
    let mut rng = Pcg64::new(7, 11);
    let camera = source.camera();
    let unit_sigma = if source == Source::Rendered { RENDERED_UNIT_SIGMA } else { UNIT_SIGMA };
    let tilt_sigma_rad = libm::hypot(TILT_RAD, GRAVITY_RAD);
    // The airframe is exact, no LED is dead, and how it tilts is known, and so is the noise of the sensor.
    let mut settings = Settings::default();
    settings.pose.tilt_sigma_rad = tilt_sigma_rad;
    settings.pose.marker_sigma_m = 0.0;
    settings.pose.unit_sigma = unit_sigma;
    settings.pose.missed = 1e-5;
    settings.pose.lobe_sigma = 0.002;
    settings.pose.scale_sigma = 0.0;
    settings.spots.noise = render::noise(&render::PAPER);
    settings.min_probability = 0.0;
    let mut locator = Locator::new(camera.clone(), airframe, None, settings).expect("a locator");
    let mut tallies = [Tally::default(); MOST_SPOTS + 1];
    let mut nothing = 0;
    let mut add = |view: &View, located: &Located| {
        let spots = |neighbour: &Neighbour| neighbour.sightings.len();
        let Some(neighbour) = located.neighbours.iter().max_by_key(|neighbour| spots(neighbour)) else {
            nothing += 1;
            return;
        };
        let turns = airframe.markers().len() as f64;
        let bound_m2 = view.bound_m2(airframe, &view.matched(airframe, located), unit_sigma);
        tallies[spots(neighbour)].add(view, neighbour, turns, bound_m2);
    };
    let mut done = 0;
    while done < count {
        match source {
            Source::Rendered => {
                for (view, frame) in
                    render::batch(&render::PAPER, airframe, distance_m, done as u64, &mut rng)
                {
                    locator.forget();
                    let located = locator.locate(Input::frame(&frame.image.view()).gravity(&view.gravity));
                    let located = located.expect("the camera's size");
                    add(&view, located);
                    done += 1;
                }
            }
            Source::Geometry { sigma_px } => {
                let view = View::draw(distance_m, &mut rng);
                let spots = view.spots(airframe, &camera, sigma_px, &mut rng);
                locator.forget();
                add(
                    &view,
                    locator.locate(Input::spots(&spots).gravity(&view.gravity)).expect("spots have no size"),
                );
                done += 1;
            }
        }
    }
    (tallies, nothing)
}
