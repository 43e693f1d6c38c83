//! Signals of spots tell a symmetric airframe's yaw, prune its modes, and do no harm where they are wrong.
//!
//! Single neighbours in pure geometry with a tenth of a pixel. Checked: the weight of the poses that are turned as the truth
//! is, and that truth is where it is said to be. Not checked: how signals are decoded, and which spots they bring together.

mod paper;

use std::f64::consts::TAU;

use nalgebra::{Matrix2, Matrix3, Rotation3, SMatrix, Unit, UnitQuaternion, Vector3};
use photinus::airframe::{Airframe, Led};
use photinus::camera::{Bearing, Camera, Pixel};
use photinus::locator::{Input, Located, Locator, Settings};
use photinus::spots::{Extent, Spot};
use rand_distr::{Distribution, StandardNormal, Uniform};
use rand_pcg::Pcg64;

use paper::camera;

const SIGMA_PX: f64 = 0.1;
/// Spread of the logarithm of the LEDs' power.
const UNIT_SIGMA: f64 = 0.12;
/// Light of an LED straight ahead at 1 m, and the least that is found, grey levels.
const POWER: f64 = 40_000.0;
const FAINTEST: f64 = 60.0;
/// A signal that no LED carries.
const FOREIGN: u32 = 77;

/// A ring whose LEDs carry the signals that `signal` gives them.
fn signalled(anonymous: &Airframe, signal: impl Fn(u32) -> u32) -> Airframe {
    let leds =
        (0..).zip(anonymous.leds()).map(|(number, led)| Led { signal: Some(signal(number)), ..led.clone() });
    Airframe::new("signalled", leds.collect()).expect("an airframe")
}

fn hexarotor(signal: impl Fn(u32) -> u32) -> Airframe {
    signalled(&paper::hexarotor(), signal)
}

fn quadrotor(signal: impl Fn(u32) -> u32) -> Airframe {
    signalled(&paper::quadrotor(), signal)
}

/// A hexarotor without one of its LEDs.
fn asymmetric() -> Airframe {
    Airframe::new("asymmetric", hexarotor(|led| led).leds()[..5].to_vec()).expect("an airframe")
}

struct View {
    position_m: Vector3<f64>,
    camera_from_body: Rotation3<f64>,
}

impl View {
    fn draw(rng: &mut Pcg64) -> Self {
        let mut between = |low, high| -> f64 { Uniform::new(low, high).expect("a range").sample(rng) };
        let (azimuth, elevation, yaw_rad, distance_m) =
            (between(-0.8, 0.8), between(-0.3, 0.3), between(0.0, TAU), between(2.0, 8.0));
        let (sin, cos) = libm::sincos(elevation);
        let tilt = Vector3::new(between(-0.1, 0.1), 0.0, between(-0.1, 0.1));
        let upright = Rotation3::from_basis_unchecked(&[Vector3::x(), Vector3::z(), -Vector3::y()]);
        let ahead = Vector3::new(cos * libm::sin(azimuth), -sin, cos * libm::cos(azimuth));
        Self {
            position_m: ahead * distance_m,
            camera_from_body: Rotation3::new(tilt)
                * upright
                * Rotation3::from_axis_angle(&Vector3::z_axis(), yaw_rad),
        }
    }

    /// The spots of the markers that show, each with its signal.
    fn spots(&self, airframe: &Airframe, camera: &Camera, rng: &mut Pcg64) -> Vec<(Spot, Option<u32>)> {
        let camera_m = -(self.camera_from_body.inverse() * self.position_m);
        let mut spots = Vec::new();
        for (number, marker) in airframe.markers().iter().enumerate() {
            let intensity = airframe.intensity(number, &camera_m);
            let place_m = self.camera_from_body * marker.position_m + self.position_m;
            let flux = POWER * intensity / place_m.norm_squared();
            if flux < FAINTEST {
                continue;
            }
            let Some(pixel) = Bearing::new(place_m).and_then(|bearing| camera.pixel(&bearing)) else {
                continue;
            };
            let mut noise = || -> f64 { StandardNormal.sample(rng) };
            let centre = Pixel::new(pixel.u + SIGMA_PX * noise(), pixel.v + SIGMA_PX * noise());
            let flux = flux * libm::exp(UNIT_SIGMA * noise());
            spots.push((spot(centre, flux), airframe.leds()[marker.leds[0]].signal));
        }
        spots
    }

    /// The weight of all modes that are turned as this view is, to a quarter of a hexarotor's sector.
    fn weight_of_truth(&self, located: &Located) -> f64 {
        let modes = located.neighbours[0].modes.iter();
        let off_rad = |turned: &Rotation3<f64>| (turned.inverse() * self.camera_from_body).angle();
        modes.filter(|mode| off_rad(&mode.pose.camera_from_body) < 0.5).map(|mode| mode.weight).sum()
    }
}

/// What is true of these neighbours.
fn settings() -> Settings {
    let mut settings = Settings::default();
    settings.pose.scale_sigma = 0.0;
    settings.pose.marker_sigma_m = 0.001;
    settings.pose.unit_sigma = UNIT_SIGMA;
    settings.min_probability = 0.0;
    settings
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
        light: None,
        background: 5.0,
        marker_log_odds: 3.0,
        middle,
        extent: Extent { left: middle.0 - 1, top: middle.1 - 1, right: middle.0 + 1, bottom: middle.1 + 1 },
    }
}

/// Locates neighbours whose spots have their signals changed by `change`; of all, tells the share whose true turn has a
/// weight above 0.95, and the mean NEES of position.
fn scores(airframe: &Airframe, least_spots: usize, change: impl Fn(&mut [(Spot, Option<u32>)])) -> [f64; 2] {
    let (camera, down): (Camera, Unit<Vector3<f64>>) = (camera(), Vector3::y_axis());
    let mut locator = Locator::new(camera.clone(), airframe, None, settings()).expect("a locator");
    let mut rng = Pcg64::new(5, 9);
    let (mut count, mut apart, mut sure, mut nees) = (0.0, 0.0, 0.0, 0.0);
    for _ in 0..400 {
        let view = View::draw(&mut rng);
        let mut spots = view.spots(airframe, &camera, &mut rng);
        if spots.len() < least_spots {
            continue;
        }
        change(&mut spots);
        locator.forget();
        let located = locator.locate(Input::signalled(&spots).gravity(&down)).expect("spots have no size");
        let [neighbour] = located.neighbours.as_slice() else {
            apart += 1.0;
            continue;
        };
        let position = neighbour.position.expect("a position");
        let off_m = position.mean_m - view.position_m;
        count += 1.0;
        nees += off_m.dot(&position.covariance_m2.cholesky().expect("a covariance").solve(&off_m));
        sure += f64::from(u8::from(view.weight_of_truth(located) > 0.95));
    }
    assert!(count > 30.0, "{count} views");
    assert!(apart <= 0.01 * count, "{apart} of {count} were taken for more neighbours than one");
    [sure / count, nees / count]
}

#[test]
fn right_signals_tell_the_turn_of_a_symmetric_airframe() {
    for airframe in [hexarotor(|led| led), quadrotor(|led| led), asymmetric()] {
        let [sure, nees] = scores(&airframe, 2, |_| ());
        println!("{}: truth is sure in {sure:.3}, NEES {nees:.2}", airframe.name());
        assert!(sure > 0.99 && (1.5..4.2).contains(&nees), "{sure} {nees}");
    }
}

#[test]
fn one_wrong_signal_of_three_is_outvoted() {
    for airframe in [hexarotor(|led| led), asymmetric()] {
        for wrong in [FOREIGN, 0] {
            let [sure, nees] = scores(&airframe, 3, |spots| spots[1].1 = Some(wrong));
            println!("{} {wrong}: truth is sure in {sure:.3}, NEES {nees:.2}", airframe.name());
            assert!(sure > 0.95 && (1.5..4.2).contains(&nees), "{wrong}: {sure} {nees}");
        }
    }
}

#[test]
fn signals_that_tell_no_turn_leave_the_pose_as_it_is() {
    let camera = camera();
    let mut rng = Pcg64::new(6, 9);
    for (airframe, turns) in [(hexarotor(|_| 4), 6.0), (hexarotor(|led| led % 2), 3.0)] {
        let mut locator = Locator::new(camera.clone(), &airframe, None, settings()).expect("a locator");
        for _ in 0..30 {
            let view = View::draw(&mut rng);
            let mut spots = view.spots(&airframe, &camera, &mut rng);
            let down: Unit<Vector3<f64>> = Vector3::y_axis();
            let told = locator
                .locate(Input::signalled(&spots).gravity(&down))
                .expect("spots have no size")
                .neighbours[0]
                .clone();
            let yaw_sigma_rad = told.orientation.expect("an attitude").covariance_rad2[(2, 2)].sqrt();
            assert!(yaw_sigma_rad < TAU / turns / 2.0, "yaw modulo {turns} turns: {yaw_sigma_rad}");
            for spot in &mut spots {
                spot.1 = None;
            }
            let anonymous = &locator
                .locate(Input::signalled(&spots).gravity(&down))
                .expect("spots have no size")
                .neighbours[0];
            let [told_m, anonymous_m] = [told.distance, anonymous.distance]
                .map(|distance| distance.estimate.expect("an estimate").distance_m);
            assert!((told_m / anonymous_m - 1.0).abs() < 0.02, "{told_m} {anonymous_m}");
        }
    }
}

/// How errors of position and attitude go together, each over its own claimed spread, is how they are said to: the slope of what is seen
/// over what is claimed is that of the spreads themselves. A claim of nothing, or of the wrong frame or sign, has none.
#[test]
fn position_and_attitude_covary_as_is_claimed() {
    for airframe in [asymmetric(), hexarotor(|led| led), quadrotor(|led| led)] {
        let [slope, claimed, nees] = covary(&airframe);
        println!("{}: slope {slope:.2}, claimed {claimed:.2}, NEES {nees:.2}", airframe.name());
        assert!(claimed > 0.2 && (0.85..1.15).contains(&slope) && (3.5..7.5).contains(&nees));
    }
}

/// The slope, how much was claimed, and the joint NEES.
fn covary(airframe: &Airframe) -> [f64; 3] {
    let camera = camera();
    let mut locator = Locator::new(camera.clone(), airframe, None, settings()).expect("a locator");
    let mut rng = Pcg64::new(8, 9);
    let (mut count, mut seen, mut claimed, mut alone, mut nees) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for _ in 0..600 {
        let view = View::draw(&mut rng);
        let spots = view.spots(airframe, &camera, &mut rng);
        if spots.len() < 3 {
            continue;
        }
        locator.forget();
        let located =
            locator.locate(Input::signalled(&spots).gravity(&Vector3::y_axis())).expect("spots have no size");
        let [neighbour] = located.neighbours.as_slice() else { continue };
        let (position, turned) = (neighbour.position.expect("known"), neighbour.orientation.expect("known"));
        let off_m = view.position_m - position.mean_m;
        let between = turned.camera_from_body.inverse() * view.camera_from_body;
        let off_rad = UnitQuaternion::from_rotation_matrix(&between).scaled_axis();
        let of_position = position.covariance_m2.cholesky().expect("a covariance").l();
        let of_turn = turned.covariance_rad2.cholesky().expect("a covariance").l();
        let over = |root: &Matrix3<f64>, what: Vector3<f64>| {
            root.solve_lower_triangular(&what).expect("it is regular")
        };
        let half = of_position.solve_lower_triangular(&turned.position_covariance_m_rad).expect("regular");
        let told = of_turn.solve_lower_triangular(&half.transpose()).expect("regular").transpose();
        let (off_m, off_rad) = (over(&of_position, off_m), over(&of_turn, off_rad));
        count += 1.0;
        seen += (off_m * off_rad.transpose()).component_mul(&told).sum();
        claimed += told.norm_squared();
        alone += (off_m.norm_squared() + off_rad.norm_squared()) / 6.0;
        let mut whole = SMatrix::<f64, 6, 6>::identity();
        whole.fixed_view_mut::<3, 3>(0, 3).copy_from(&told);
        whole.fixed_view_mut::<3, 3>(3, 0).copy_from(&told.transpose());
        let off = SMatrix::<f64, 6, 1>::from_iterator(off_m.iter().chain(&off_rad).copied());
        let whole = whole.cholesky().expect("position and attitude together have a covariance");
        nees += off.dot(&whole.solve(&off));
    }
    assert!(count > 100.0, "{count} views");
    [seen / claimed * count / alone, claimed / count, nees / count]
}
