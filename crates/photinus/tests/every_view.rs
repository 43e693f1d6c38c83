//! No view without an answer, and no answer whose bounds truth leaves.
//!
//! Neighbours in pure geometry, each spot a box of pixels that its marker falls into, seen by a camera of more than 180 deg.
//! Checked: over every yaw, near and far, ahead and 85 to 95 deg off the axis, with one to six markers, with and without
//! gravity and brightness, a neighbour has a finite estimate within its bounds; and over many random frames the true distance
//! is within the bounds, whichever spots were taken for one neighbour. Not checked: how good estimates are.

mod paper;

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use nalgebra::{Matrix2, Rotation3, Unit, Vector3};
use photinus::airframe::Airframe;
use photinus::camera::{Bearing, Camera, Ideal, IdealLaw, Model, Pixel};
use photinus::locator::{Input, Locator, Neighbour, Settings};
use photinus::spots::{Extent, Spot};
use rand_distr::{Distribution, StandardNormal, Uniform};
use rand_pcg::Pcg64;

use paper::{hexarotor, lanterns, quadrotor};

/// Light of an LED straight ahead at 1 m, and the least that is found, grey levels.
const POWER: f64 = 40_000.0;
const FAINTEST: f64 = 60.0;
/// Largest tilt that the bounds allow for, rad.
const MAX_TILT_RAD: f64 = PI / 12.0;

/// A fisheye that sees 190 deg and a little more.
fn camera() -> Camera {
    let lens =
        Ideal::new(IdealLaw::Equidistant, [1.0 / 3.7673e-3; 2], Pixel::new(449.5, 449.5)).expect("a lens");
    Camera::new(Model::Ideal(lens), 900, 900, Some(100.0 * PI / 180.0)).expect("a camera")
}

fn uniform(rng: &mut Pcg64, low: f64, high: f64) -> f64 {
    Uniform::new(low, high).expect("a range").sample(rng)
}

/// A neighbour in the frame of a camera that looks along the horizon.
struct Target {
    position_m: Vector3<f64>,
    camera_from_body: Rotation3<f64>,
}

impl Target {
    /// In a direction off the camera's axis, to the side; tilted towards somewhere.
    fn new(distance_m: f64, [off_axis_rad, elevation_rad]: [f64; 2], yaw_rad: f64, tilt: [f64; 2]) -> Self {
        let ((sin, cos), (up, level)) = (libm::sincos(off_axis_rad), libm::sincos(elevation_rad));
        let upright = Rotation3::from_basis_unchecked(&[Vector3::x(), Vector3::z(), -Vector3::y()]);
        let (sin_towards, cos_towards) = libm::sincos(tilt[1]);
        let tilt = Rotation3::new(Vector3::new(cos_towards, 0.0, sin_towards) * tilt[0]);
        Self {
            position_m: Vector3::new(sin * level, -up, cos * level) * distance_m,
            camera_from_body: tilt * upright * Rotation3::from_axis_angle(&Vector3::z_axis(), yaw_rad),
        }
    }

    /// The spots of the markers that show in the image, the brightest first.
    fn spots(&self, airframe: &Airframe, camera: &Camera, rng: &mut Pcg64) -> Vec<Spot> {
        let camera_m = -(self.camera_from_body.inverse() * self.position_m);
        let mut spots = Vec::new();
        for (number, marker) in airframe.markers().iter().enumerate() {
            let place_m = self.camera_from_body * marker.position_m + self.position_m;
            let flux = POWER * airframe.intensity(number, &camera_m) / place_m.norm_squared();
            let Some(pixel) = Bearing::new(place_m).and_then(|bearing| camera.pixel(&bearing)) else {
                continue;
            };
            let inside = |at: f64| (2.0..897.0).contains(&at);
            if flux >= FAINTEST && inside(pixel.u) && inside(pixel.v) {
                spots.push(spot(pixel, flux, rng));
            }
        }
        spots.sort_by(|a, b| b.flux.total_cmp(&a.flux));
        spots
    }
}

/// A spot of a few pixels with the true place among them: its centre a good one or any.
fn spot(place: Pixel, flux: f64, rng: &mut Pcg64) -> Spot {
    let good = uniform(rng, 0.0, 1.0) < 0.7;
    let mut off_px = || -> f64 {
        let noise: f64 = StandardNormal.sample(rng);
        if good { (0.1 * noise).clamp(-0.5, 0.5) } else { uniform(rng, -0.7, 0.7) }
    };
    let centre = Pixel::new(place.u + off_px(), place.v + off_px());
    let sigma_px = if good { 0.1 } else { 0.4 };
    let middle = (place.u.round() as u32, place.v.round() as u32);
    Spot {
        centre,
        covariance_px2: Matrix2::from_diagonal_element(sigma_px * sigma_px),
        area_px: 5,
        peak: 200,
        saturated_px: 0,
        flux,
        light: None,
        background: 5.0,
        marker_log_odds: 3.0,
        middle,
        extent: Extent { left: middle.0 - 1, top: middle.1 - 1, right: middle.0 + 1, bottom: middle.1 + 1 },
    }
}

/// What must hold of every neighbour, whatever is seen of it.
fn assert_answers(neighbour: &Neighbour, what: &str) {
    let (bounds, estimate) = (neighbour.distance.bounds, neighbour.distance.estimate);
    let estimate = estimate.unwrap_or_else(|| panic!("{what}: no estimate"));
    assert!(estimate.distance_m.is_finite() && estimate.sigma_m > 0.0, "{what}: {estimate:?}");
    assert!(bounds.contains(estimate.distance_m), "{what}: {estimate:?} outside {bounds:?}");
    let position = neighbour.position.unwrap_or_else(|| panic!("{what}: no position"));
    let within_m = position.mean_m.norm();
    assert!(
        within_m >= bounds.min_m() * (1.0 - 1e-12) && within_m <= bounds.max_m() * (1.0 + 1e-12),
        "{what}: {within_m} m outside {bounds:?}"
    );
    let orientation = neighbour.orientation.unwrap_or_else(|| panic!("{what}: no attitude"));
    for covariance in [position.covariance_m2, orientation.covariance_rad2] {
        let positive = covariance.symmetric_eigenvalues().min() > -1e-9 * covariance.trace();
        assert!(positive && covariance.iter().all(|number| number.is_finite()), "{what}: {covariance}");
    }
    assert!(orientation.camera_from_body.matrix().iter().all(|number| number.is_finite()), "{what}");
    let weight: f64 = neighbour.modes.iter().map(|mode| mode.weight).sum();
    assert!((weight - 1.0).abs() < 1e-9, "{what}: modes weigh {weight}");
}

#[test]
fn every_view_has_an_answer() {
    let (camera, down): (Camera, Unit<Vector3<f64>>) = (camera(), Vector3::y_axis());
    let mut rng = Pcg64::new(3, 8);
    let mut seen = [0; 7];
    for airframe in [hexarotor(), quadrotor(), lanterns()] {
        for use_brightness in [true, false] {
            let mut settings = Settings::default();
            settings.pose.use_brightness = use_brightness;
            settings.min_probability = 0.0;
            let mut locator = Locator::new(camera.clone(), &airframe, None, settings).expect("a locator");
            for (number, yaw_deg) in (0..360).step_by(5).enumerate() {
                for (step, distance_m) in [0.6, 0.8, 1.2, 2.5, 5.0, 10.0, 15.0].into_iter().enumerate() {
                    let off_axis_rad =
                        [0.02, 0.6, 85.0 * PI / 180.0, FRAC_PI_2, 95.0 * PI / 180.0][(number + step) % 5];
                    let elevation_rad = uniform(&mut rng, -0.3, 0.3);
                    let tilt = [uniform(&mut rng, 0.0, 0.2), uniform(&mut rng, 0.0, TAU)];
                    let target = Target::new(
                        distance_m,
                        [off_axis_rad, elevation_rad],
                        f64::from(yaw_deg).to_radians(),
                        tilt,
                    );
                    let all = target.spots(&airframe, &camera, &mut rng);
                    let gravity = (number % 2 == 0).then_some(&down);
                    for shown in 1..=all.len() {
                        locator.forget();
                        let located = locator
                            .locate(Input::spots(&all[..shown]).gravity(gravity))
                            .expect("spots have no size");
                        let what = format!(
                            "{} at {distance_m} m, yaw {yaw_deg} deg, {off_axis_rad:.2} rad off the axis, {shown} of {} markers",
                            airframe.name(),
                            all.len()
                        );
                        assert!(!located.neighbours.is_empty(), "{what}: nobody");
                        for neighbour in &located.neighbours {
                            assert_answers(neighbour, &what);
                            let bounds = neighbour.distance.bounds;
                            assert!(bounds.contains(distance_m), "{what}: outside {bounds:?}");
                        }
                        seen[shown] += 1;
                    }
                }
            }
        }
    }
    println!("views by number of markers: {:?}", &seen[1..]);
    assert!(seen[1..].iter().all(|&count| count > 500), "{seen:?}");
}

/// What the bounds of many random neighbours did.
#[derive(Default)]
struct Coverage {
    /// Truth was within.
    held: usize,
    /// Spots of several neighbours were taken for one, whose distance no truth tells.
    mixed: usize,
}

/// Locates random frames of one to six neighbours until so many were told; panics where truth is outside the bounds.
fn coverage(airframe: &Airframe, neighbours: usize, seed: u64) -> Coverage {
    let camera = camera();
    let down: Unit<Vector3<f64>> = Vector3::y_axis();
    let mut rng = Pcg64::new(seed.into(), 8);
    let mut locator = Locator::new(camera.clone(), airframe, None, Settings::default()).expect("a locator");
    let mut coverage = Coverage::default();
    for frame in 0.. {
        if coverage.held >= neighbours {
            break;
        }
        let gravity = (frame % 2 == 0).then_some(&down);
        let (mut spots, mut owners, mut truth_m) = (Vec::new(), Vec::new(), Vec::new());
        for owner in 0..1 + frame % 6 {
            let distance_m = libm::exp(uniform(&mut rng, libm::log(0.6), libm::log(15.0)));
            let direction = [uniform(&mut rng, -1.7, 1.7), uniform(&mut rng, -0.8, 0.8)];
            let tilt = [uniform(&mut rng, 0.0, MAX_TILT_RAD), uniform(&mut rng, 0.0, TAU)];
            let mut target = Target::new(distance_m, direction, uniform(&mut rng, 0.0, TAU), tilt);
            if gravity.is_none() {
                let turn = Vector3::from_fn(|_, _| uniform(&mut rng, -2.0, 2.0));
                target.camera_from_body = Rotation3::new(turn) * target.camera_from_body;
            }
            let own = target.spots(airframe, &camera, &mut rng);
            owners.extend(std::iter::repeat_n(owner, own.len()));
            spots.extend(own);
            truth_m.push(distance_m);
        }
        locator.forget();
        let located = locator.locate(Input::spots(&spots).gravity(gravity)).expect("spots have no size");
        for neighbour in &located.neighbours {
            let members = &neighbour.sightings;
            let owner = owners[members[0]];
            if members.iter().any(|&member| owners[member] != owner) {
                coverage.mixed += 1;
                continue;
            }
            let (what, bounds) = (format!("{} in frame {frame}", airframe.name()), neighbour.distance.bounds);
            assert!(bounds.contains(truth_m[owner]), "{what}: {} m outside {bounds:?}", truth_m[owner]);
            assert_answers(neighbour, &what);
            coverage.held += 1;
        }
    }
    coverage
}

#[test]
fn truth_never_leaves_the_bounds_of_a_neighbour() {
    for airframe in [hexarotor(), quadrotor(), lanterns()] {
        let Coverage { held, mixed } = coverage(&airframe, 1200, 1);
        println!("{}: {held} held, {mixed} mixed", airframe.name());
        assert!(mixed * 5 < held, "{mixed} of {held} are mixed");
    }
}

/// `cargo test --release -p photinus --test every_view -- --ignored --nocapture`, a minute or two.
#[test]
#[ignore = "the full count, for release builds"]
fn truth_never_leaves_the_bounds_of_a_hundred_thousand_neighbours() {
    for airframe in [hexarotor(), quadrotor(), lanterns()] {
        let Coverage { held, mixed } = coverage(&airframe, 50_000, 2);
        println!("{}: {held} held, {mixed} mixed", airframe.name());
    }
}
