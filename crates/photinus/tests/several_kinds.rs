//! Hexarotors and quadrotors in one frame: each is found, and how likely it is which is as likely as said.
//!
//! Neighbours in pure geometry, drawn from the default priors: tilt, places of markers, power of LEDs. Checked over every number of spots: whether the
//! kind is the likelier one as often as claimed, NEES of the position over both kinds, strict bounds, who is missed and who is not there.

mod paper;

use std::f64::consts::TAU;

use nalgebra::{Matrix2, Rotation3, Unit, Vector3};
use photinus::airframe::Airframe;
use photinus::camera::{Bearing, Camera, Pixel};
use photinus::locator::{Input, Kind, Locator, LocatorError, Settings};
use photinus::pose;
use photinus::spots::{Extent, Spot};
use rand_distr::{Distribution, StandardNormal, Uniform};
use rand_pcg::Pcg64;

use paper::{HEIGHT, WIDTH, camera, hexarotor, quadrotor};

/// Light of an LED straight ahead at 1 m, and the least that is found, grey levels.
const POWER: f64 = 25_000.0;
const FAINTEST: f64 = 60.0;
const SIGMA_PX: f64 = 0.1;
/// Neighbours of a frame are so far apart at least, rad.
const APART_RAD: f64 = 0.35;

fn uniform(rng: &mut Pcg64, low: f64, high: f64) -> f64 {
    Uniform::new(low, high).expect("a range").sample(rng)
}

fn normal(rng: &mut Pcg64) -> f64 {
    StandardNormal.sample(rng)
}

/// Who is there: which kind, and where.
struct Truth {
    kind: usize,
    position_m: Vector3<f64>,
}

/// The spots of a neighbour, built and turned as the priors allow.
fn spots_of(airframe: &Airframe, position_m: &Vector3<f64>, camera: &Camera, rng: &mut Pcg64) -> Vec<Spot> {
    let believed = pose::Settings::default();
    let scale = 1.0 + believed.scale_sigma * normal(rng);
    let upright = Rotation3::from_basis_unchecked(&[Vector3::x(), Vector3::z(), -Vector3::y()]);
    let tilt = Rotation3::new(Vector3::new(normal(rng), 0.0, normal(rng)) * believed.tilt_sigma_rad);
    let yaw = Rotation3::from_axis_angle(&Vector3::z_axis(), uniform(rng, 0.0, TAU));
    let camera_from_body = tilt * upright * yaw;
    let camera_m = -(camera_from_body.inverse() * position_m);
    let mut spots = Vec::new();
    for (number, marker) in airframe.markers().iter().enumerate() {
        let off_m = Vector3::from_fn(|_, _| believed.marker_sigma_m * normal(rng));
        let place_m = camera_from_body * (marker.position_m * scale + off_m) + position_m;
        let unit = libm::exp(believed.unit_sigma * normal(rng));
        let flux = POWER * unit * airframe.intensity(number, &camera_m) / place_m.norm_squared();
        let pixel = Bearing::new(place_m).and_then(|bearing| camera.pixel(&bearing));
        if let Some(pixel) = pixel.filter(|_| flux > FAINTEST) {
            spots.push(spot(pixel, flux, rng));
        }
    }
    spots
}

fn spot(pixel: Pixel, flux: f64, rng: &mut Pcg64) -> Spot {
    let middle = (pixel.u.round() as u32, pixel.v.round() as u32);
    Spot {
        centre: Pixel::new(pixel.u + SIGMA_PX * normal(rng), pixel.v + SIGMA_PX * normal(rng)),
        covariance_px2: Matrix2::from_diagonal_element(SIGMA_PX * SIGMA_PX),
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

/// One to three neighbours of either kind in places apart from each other, inside the image.
fn frame(airframes: &[Airframe], camera: &Camera, rng: &mut Pcg64) -> (Vec<Spot>, Vec<Truth>) {
    let (mut spots, mut truth): (Vec<Spot>, Vec<Truth>) = (Vec::new(), Vec::new());
    let count = 1 + uniform(rng, 0.0, 3.0) as usize;
    while truth.len() < count {
        let (width, height) = (WIDTH as f64, HEIGHT as f64);
        let place = Pixel::new(uniform(rng, 0.2, 0.8) * width, uniform(rng, 0.3, 0.7) * height);
        let distance_m = libm::exp(uniform(rng, libm::log(2.0), libm::log(12.0)));
        let position_m = camera.bearing(place).expect("inside").vector() * distance_m;
        let is_near = |other: &Truth| other.position_m.angle(&position_m) < APART_RAD;
        if truth.iter().any(is_near) {
            continue;
        }
        let kind = usize::from(uniform(rng, 0.0, 1.0) < 0.5);
        let own = spots_of(&airframes[kind], &position_m, camera, rng);
        if !own.is_empty() {
            spots.extend(own);
            truth.push(Truth { kind, position_m });
        }
    }
    (spots, truth)
}

/// What came of neighbours with one number of spots.
#[derive(Clone, Copy, Default)]
struct Tally {
    told: f64,
    right: f64,
    claimed: f64,
    variance: f64,
    squared_errors: f64,
}

#[test]
fn kinds_are_told_apart_as_surely_as_said() {
    let (camera, down): (Camera, Unit<Vector3<f64>>) = (camera(), Vector3::y_axis());
    let airframes = [hexarotor(), quadrotor()];
    let settings = Settings::default();
    let kinds = airframes.clone().map(|airframe| Kind::new(airframe, &settings.pose));
    let mut locator = Locator::of_kinds(camera.clone(), &kinds, None, settings).expect("a locator");
    let mut rng = Pcg64::new(77, 12);
    let mut tallies = [Tally::default(); 7];
    let (mut there, mut missed, mut phantoms) = (0, 0, 0);
    for _ in 0..600 {
        let (spots, truth) = frame(&airframes, &camera, &mut rng);
        locator.forget();
        let located = locator.locate(Input::spots(&spots).gravity(&down)).expect("spots have no size");
        there += truth.len();
        let mut found = vec![false; truth.len()];
        for neighbour in &located.neighbours {
            let position = neighbour.position.expect("a position");
            let near =
                truth.iter().position(|truth| truth.position_m.angle(&position.mean_m) < APART_RAD / 2.0);
            let Some(who) = near.filter(|&who| !found[who]) else {
                phantoms += 1;
                continue;
            };
            found[who] = true;
            let Truth { kind, position_m } = &truth[who];
            let (bounds, distance_m) = (neighbour.distance.bounds, position_m.norm());
            assert!(bounds.contains(distance_m), "{distance_m} m outside {bounds:?}");
            let factor = position.covariance_m2.cholesky().expect("a covariance");
            let off_m = position.mean_m - position_m;
            let sure = neighbour.kind_probability;
            let tally = &mut tallies[neighbour.sightings.len().min(6)];
            tally.told += 1.0;
            tally.right += f64::from(u8::from(neighbour.kind == *kind));
            tally.claimed += sure;
            tally.variance += sure * (1.0 - sure);
            tally.squared_errors += off_m.dot(&factor.solve(&off_m)).min(100.0);
        }
        missed += found.iter().filter(|found| !**found).count();
    }
    println!("{there} there, {missed} missed, {phantoms} phantoms");
    for (spots, tally) in tallies.iter().enumerate().filter(|(_, tally)| tally.told > 0.0) {
        let Tally { told, right, claimed, variance, squared_errors } = *tally;
        println!(
            "{spots} spots: {told} told, {:.3} right, {:.3} claimed, NEES/3 {:.2}",
            right / told,
            claimed / told,
            squared_errors / told / 3.0
        );
        let off = (right - claimed).abs();
        assert!(off < 3.5 * variance.sqrt() + 0.02 * told, "{spots} spots: {off} of {told} off");
        if told > 100.0 {
            assert!((0.75..1.25).contains(&(squared_errors / told / 3.0)), "{spots} spots");
        }
    }
    assert!(missed * 50 < there && phantoms * 50 < there, "{missed} missed, {phantoms} phantoms");
    let Tally { told, right, .. } = tallies[3];
    assert!(right > 0.9 * told, "three spots tell the kind: {right} of {told} right");
}

#[test]
fn one_kind_of_a_list_is_as_one_alone() {
    let (camera, down): (Camera, Unit<Vector3<f64>>) = (camera(), Vector3::y_axis());
    let settings = Settings::default();
    let kind = Kind::new(hexarotor(), &settings.pose);
    let mut alone = Locator::new(camera.clone(), &kind.airframe, None, settings).expect("a locator");
    let mut listed = Locator::of_kinds(camera.clone(), &[kind], None, settings).expect("a locator");
    let mut rng = Pcg64::new(5, 12);
    for _ in 0..20 {
        let (spots, _) = frame(&[hexarotor(), hexarotor()], &camera, &mut rng);
        let located = alone.locate(Input::spots(&spots).gravity(&down)).expect("spots have no size");
        assert_eq!(located, listed.locate(Input::spots(&spots).gravity(&down)).expect("spots have no size"));
        assert!(located.neighbours.iter().all(|one| one.kind == 0 && one.kind_probability >= 1.0));
    }
    let nobody = Locator::of_kinds(camera, &[], None, settings);
    assert_eq!(nobody.err(), Some(LocatorError::NoKind));
}
