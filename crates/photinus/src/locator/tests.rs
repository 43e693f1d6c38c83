//! Neighbours of known pose, seen by an ideal camera without pixels: groups, bounds, estimates.

use std::f64::consts::{PI, TAU};

use nalgebra::{Matrix2, Rotation3, Unit, Vector3};
use rand_distr::{Distribution, StandardNormal, Uniform};
use rand_pcg::Pcg64;

use super::*;
use crate::airframe::Ring;
use crate::camera::Bearing;
use crate::camera::{Ideal, IdealLaw, Model, Pixel};
use crate::pose::{self, LogLight};
use crate::spots::Extent;

mod alternatives;
mod beside;
mod dark;
mod hot_pixels;
mod light;
mod lone;
mod missed;
mod most;
mod newcomers;
mod regions;
mod tilting;

const SIGMA_PX: f64 = 0.1;
/// Light of an LED straight ahead at 1 m, and the least that the detector finds with its default threshold, grey levels.
const POWER: f64 = 100_000.0;
const FAINTEST: f64 = 75.0;

fn limit(light: f64) -> Option<LogLight> {
    Some(LogLight { value: libm::log(light), sigma: 0.33 })
}

fn camera() -> Camera {
    let lens = Ideal::new(IdealLaw::Equidistant, [1.0 / 3.7673e-3; 2], Pixel::new(375.5, 239.5)).unwrap();
    Camera::new(Model::Ideal(lens), 752, 480, None).unwrap()
}

fn hexarotor() -> Airframe {
    Airframe::from_ring("hexarotor", Ring { arms: 6, radius_m: 0.4, leds_per_arm: 1, splay_rad: 0.0 })
        .unwrap()
}

fn quadrotor() -> Airframe {
    let ring = Ring { arms: 4, radius_m: 0.245, leds_per_arm: 2, splay_rad: PI / 2.0 };
    Airframe::from_ring("quadrotor", ring).unwrap()
}

/// An airframe of one LED that shines everywhere.
fn lamp(position_m: Vector3<f64>) -> Airframe {
    let lobe = crate::airframe::Lobe::Omni;
    let led = crate::airframe::Led { position_m, axis: Vector3::z_axis(), lobe, power: 1.0, signal: None };
    Airframe::new("lamp", vec![led]).unwrap()
}

/// Down in the frame of a camera that looks along the horizon.
fn level() -> Unit<Vector3<f64>> {
    Vector3::y_axis()
}

/// A neighbour at `place_m` in the camera frame, turned about the vertical and tilted.
struct Placed {
    place_m: Vector3<f64>,
    camera_from_body: Rotation3<f64>,
}

impl Placed {
    fn new(place_m: Vector3<f64>, yaw_rad: f64, tilt: Vector3<f64>) -> Self {
        // Body z up is camera -y, body x is the camera's right at yaw 0.
        let upright = Rotation3::from_basis_unchecked(&[Vector3::x(), Vector3::z(), -Vector3::y()]);
        let camera_from_body =
            Rotation3::new(tilt) * upright * Rotation3::from_axis_angle(&Vector3::z_axis(), yaw_rad);
        Self { place_m, camera_from_body }
    }

    /// The spots that show, as the camera of the paper would see them.
    fn spots(&self, airframe: &Airframe, camera: &Camera, rng: &mut Pcg64) -> Vec<Spot> {
        let camera_m = self.camera_from_body.inverse() * -self.place_m;
        let visible =
            (0..airframe.markers().len()).filter(|&marker| airframe.intensity(marker, &camera_m) > 0.05);
        let spot = |marker: usize| {
            let marker_m = self.camera_from_body * airframe.markers()[marker].position_m + self.place_m;
            let pixel = camera.pixel(&Bearing::new(marker_m)?)?;
            let distance_m = marker_m.norm();
            let intensity = airframe.intensity(marker, &camera_m);
            if spot(pixel, intensity, distance_m).flux < FAINTEST {
                return None;
            }
            let mut noise = || -> f64 { SIGMA_PX * Distribution::<f64>::sample(&StandardNormal, rng) };
            let centre = Pixel::new(pixel.u + noise(), pixel.v + noise());
            Some(spot(centre, intensity, distance_m))
        };
        visible.filter_map(spot).collect()
    }
}

fn spot(centre: Pixel, intensity: f64, distance_m: f64) -> Spot {
    let area_px = (intensity * SpotCurve::paper_1000_us().max_area_px(distance_m) as f64).max(1.0);
    let half = (area_px / PI).sqrt();
    let within = |at: f64| at.round().max(0.0) as u32;
    Spot {
        centre,
        covariance_px2: Matrix2::from_diagonal_element(SIGMA_PX * SIGMA_PX),
        area_px: area_px as u32,
        peak: 200,
        saturated_px: 0,
        flux: POWER * intensity / (distance_m * distance_m),
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

fn ahead(distance_m: f64, azimuth_rad: f64, elevation_rad: f64) -> Vector3<f64> {
    let (sin_az, cos_az) = libm::sincos(azimuth_rad);
    let (sin_el, cos_el) = libm::sincos(elevation_rad);
    Vector3::new(cos_el * sin_az, -sin_el, cos_el * cos_az) * distance_m
}

/// Locates `placed` and returns, for each, whether its spots and no others are a neighbour, with that neighbour.
fn locate(
    locator: &mut Locator,
    airframe: &Airframe,
    placed: &[Placed],
    gravity: Option<&Unit<Vector3<f64>>>,
    rng: &mut Pcg64,
) -> Vec<Option<Neighbour>> {
    let mut all = Vec::new();
    let mut owners = Vec::new();
    for (owner, placed) in placed.iter().enumerate() {
        let spots = placed.spots(airframe, &camera(), rng);
        owners.extend(std::iter::repeat_n(owner, spots.len()));
        all.extend(spots);
    }
    locator.forget();
    let located = locator.locate(Input::spots(&all).gravity(gravity)).expect("spots have no size");
    let whole = |owner: usize| {
        let own: Vec<usize> = (0..owners.len()).filter(|&spot| owners[spot] == owner).collect();
        let mut found = located.neighbours.iter().filter(|neighbour| neighbour.sightings == own);
        found.next().cloned()
    };
    (0..placed.len()).map(whole).collect()
}

/// The mean of what a locator says of hexarotors, built so, 2 to 6 m away, each frame another one that tilts as drawn, over the frames after the first hundred.
fn mean_told(
    built: &Airframe,
    down: &Unit<Vector3<f64>>,
    mut rng: Pcg64,
    tilt: impl Fn(&mut Pcg64) -> Vector3<f64>,
    is_seen: impl Fn(&mut Pcg64) -> bool,
    told: impl Fn(&Located) -> f64,
) -> f64 {
    let mut locator = locator(&hexarotor());
    let (mut sum, mut count) = (0.0, 0.0);
    for frame in 0..400 {
        let mut uniform = |low: f64, high: f64| Uniform::new(low, high).unwrap().sample(&mut rng);
        let place_m = ahead(uniform(2.0, 6.0), uniform(-0.8, 0.8), uniform(-0.3, 0.3));
        let yaw_rad = uniform(0.0, TAU);
        let placed = Placed::new(place_m, yaw_rad, tilt(&mut rng));
        let mut spots = placed.spots(built, &camera(), &mut rng);
        spots.retain(|_| is_seen(&mut rng));
        let located = locator.locate(Input::spots(&spots).gravity(Some(down))).unwrap();
        if frame >= 100 {
            sum += told(located);
            count += 1.0;
        }
    }
    sum / count
}

fn locator(airframe: &Airframe) -> Locator {
    // Such spots are as good as the airframe: nothing is off by a hand's work.
    let pose = pose::Settings {
        marker_sigma_m: 0.001,
        scale_sigma: 0.0,
        unit_sigma: 0.12,
        ..pose::Settings::default()
    };
    Locator::new(camera(), airframe, None, Settings { pose, ..Settings::default() }).unwrap()
}

#[test]
fn one_neighbour_is_one_whatever_its_yaw_and_its_bounds_hold() {
    let mut rng = Pcg64::new(1, 1);
    // None is dark here. Who believes that one in fifty is counts to 1 % on a hexarotor that is half as far again and whose front is dark.
    for (airframe, reached) in [(hexarotor(), [0.0119, 0.0132]), (quadrotor(), [0.0104, 0.0121])] {
        let mut locator = locator(&airframe);
        let (yaw, tilt) = (Uniform::new(0.0, TAU).unwrap(), Uniform::new(-0.15, 0.15).unwrap());
        for (gravity, reached) in [None, Some(level())].into_iter().zip(reached) {
            let (mut count, mut whole, mut relative) = (0, 0, Vec::new());
            for distance_m in [1.5, 3.0, 6.0, 10.0, 15.0] {
                for _ in 0..40 {
                    let tilt = Vector3::new(tilt.sample(&mut rng), 0.0, tilt.sample(&mut rng));
                    let (azimuth, elevation) = (tilt.x * 6.0, tilt.z * 2.0);
                    let placed =
                        Placed::new(ahead(distance_m, azimuth, elevation), yaw.sample(&mut rng), tilt);
                    let found = locate(&mut locator, &airframe, &[placed], gravity.as_ref(), &mut rng);
                    count += 1;
                    let Some(neighbour) = &found[0] else { continue };
                    whole += 1;
                    let bounds = neighbour.distance.bounds;
                    assert!(bounds.contains(distance_m), "{distance_m} m outside {bounds:?}");
                    let estimate = neighbour.distance.estimate.unwrap();
                    assert!(bounds.contains(estimate.distance_m));
                    relative.push((estimate.distance_m - distance_m) / distance_m);
                }
            }
            let rms =
                (relative.iter().map(|error| error * error).sum::<f64>() / relative.len() as f64).sqrt();
            println!(
                "{}, gravity {}: {whole} of {count} whole, distance rms {rms:.3}",
                airframe.name(),
                gravity.is_some()
            );
            assert_eq!(whole, count, "{}", airframe.name());
            assert!((rms / reached - 1.0).abs() < 0.1, "{}: relative distance error {rms}", airframe.name());
        }
    }
}

#[test]
fn neighbours_apart_side_by_side_and_behind_each_other() {
    let mut rng = Pcg64::new(2, 1);
    let airframe = hexarotor();
    let mut locator = locator(&airframe);
    let yaw = Uniform::new(0.0, TAU).unwrap();
    let place = |distance_m, azimuth_rad, elevation_rad, rng: &mut Pcg64| {
        Placed::new(ahead(distance_m, azimuth_rad, elevation_rad), yaw.sample(rng), Vector3::zeros())
    };
    let mut scenes = Vec::new();
    for _ in 0..40 {
        scenes.push((
            "apart",
            (-2..4).map(|i| place(5.0 + f64::from(i), 0.4 * f64::from(i), 0.0, &mut rng)).collect(),
        ));
        scenes
            .push(("side by side", vec![place(5.0, -0.11, 0.0, &mut rng), place(5.2, 0.11, 0.02, &mut rng)]));
        scenes.push(("behind", vec![place(3.0, 0.0, 0.0, &mut rng), place(9.0, 0.02, 0.03, &mut rng)]));
    }
    for gravity in [None, Some(level())] {
        for kind in ["apart", "side by side", "behind"] {
            let (mut right, mut total) = (0, 0);
            for (_, scene) in scenes.iter().filter(|(name, _): &&(_, Vec<Placed>)| *name == kind) {
                let found = locate(&mut locator, &airframe, scene, gravity.as_ref(), &mut rng);
                right += found.iter().flatten().count();
                total += found.len();
            }
            assert_eq!(right, total, "{kind}, gravity {}", gravity.is_some());
        }
    }
}

#[test]
fn a_lone_spot_is_a_neighbour_with_a_bearing_and_the_range_of_its_size() {
    let airframe = hexarotor();
    let all = Settings { min_probability: 0.0, ..Settings::default() };
    let faint = [spot(Pixel::new(300.0, 200.0), 1.0, 34.0)];
    let mut without = Locator::new(camera(), &airframe, None, all).unwrap();
    let located = without.locate(Input::spots(&faint)).expect("spots have no size");
    assert_eq!(located.neighbours.len(), 1);
    let (neighbour, sighting) = (&located.neighbours[0], &located.sightings[0]);
    assert!(neighbour.probability > 0.5, "its other markers are too faint to show: {neighbour:?}");
    let off = (neighbour.position.unwrap().mean_m.normalize() - sighting.bearing.vector()).norm();
    assert!(off < 0.01, "as likely to the left as to the right of its spot: {off}");
    let estimate = neighbour.distance.estimate.unwrap();
    assert!(estimate.sigma_m > 0.4 * estimate.distance_m, "a weak prior is no measurement: {estimate:?}");
    assert!(neighbour.distance.bounds.max_m().is_infinite());

    let bright = [spot(Pixel::new(300.0, 200.0), 1.0, 2.0)];
    let mut with = Locator::new(camera(), &airframe, Some(SpotCurve::paper_1000_us()), all).unwrap();
    let neighbour = &with.locate(Input::spots(&bright)).expect("spots have no size").neighbours[0];
    assert!(neighbour.probability < 0.5, "the markers beside it must show: {neighbour:?}");
    let distance = neighbour.distance;
    assert!(distance.bounds.contains(2.0) && distance.bounds.max_m() < 3.0, "{distance:?}");
    assert!(distance.bounds.contains(distance.estimate.unwrap().distance_m));
}

#[test]
fn the_papers_estimates_enclose_a_level_target_from_the_side() {
    let mut rng = Pcg64::new(3, 1);
    let airframe = hexarotor();
    let mut locator = locator(&airframe);
    let yaw = Uniform::new(0.0, TAU).unwrap();
    for _ in 0..200 {
        let placed = Placed::new(ahead(6.0, 0.1, 0.0), yaw.sample(&mut rng), Vector3::zeros());
        let spots = placed.spots(&airframe, &camera(), &mut rng);
        let found = locate(&mut locator, &airframe, &[placed], Some(&level()), &mut rng);
        let distance = found[0].as_ref().unwrap().distance;
        let perpendicular_m = distance.perpendicular_m.expect("a ring has the paper's estimates");
        // The slack is that of bearings off by a tenth of a pixel.
        assert!(perpendicular_m > 6.0 * 0.97, "{distance:?}");
        if spots.len() == 3 {
            assert!(distance.inline_m.unwrap() < 6.0 * 1.03, "{distance:?}");
        }
    }
}

#[test]
fn spots_outside_the_field_are_rejected_with_that_reason() {
    let airframe = hexarotor();
    let lens = Ideal::new(IdealLaw::Equidistant, [1.0 / 3.7673e-3; 2], Pixel::new(375.5, 239.5)).unwrap();
    let narrow = Camera::new(Model::Ideal(lens), 752, 480, Some(0.5)).unwrap();
    let mut locator = Locator::new(narrow, &airframe, None, Settings::default()).unwrap();
    let spots = [spot(Pixel::new(20.0, 20.0), 1.0, 3.0), spot(Pixel::new(380.0, 240.0), 1.0, 3.0)];
    let located = locator.locate(Input::spots(&spots)).expect("spots have no size");
    assert_eq!(located.sightings.len(), 1);
    assert_eq!(
        located.rejected.iter().map(|rejected| rejected.reason).collect::<Vec<_>>(),
        [Reason::Outside]
    );
}

/// Exposures that alternate, one of them unknown at times: who compares light from frame to frame sees no difference.
#[test]
fn light_is_told_as_at_the_exposure_of_the_first_frame() {
    let mut locator = locator(&hexarotor());
    let places = [(300.0, 200.0), (320.0, 205.0), (340.0, 200.0)].map(|(u, v)| Pixel::new(u, v));
    let mut told = |exposure_s: Option<f64>, brightness: f64| {
        let spots = places.map(|place| Spot { flux: 500.0 * brightness, ..spot(place, 1.0, 3.0) });
        let located = locator.locate(Input::spots(&spots).exposure(exposure_s)).expect("spots have no size");
        (located.sightings[0].log_light.unwrap().value, located.detection_limit.unwrap().value)
    };
    let (first, faintest) = told(Some(1e-3), 1.0);
    let (longer, lower) = told(Some(4e-3), 4.0);
    assert!(
        (longer - first).abs() < 1e-12 && (lower - (faintest - libm::log(4.0))).abs() < 1e-12,
        "{longer} {first}"
    );
    for unknown in [None, Some(0.0), Some(-1.0), Some(f64::NAN), Some(f64::INFINITY)] {
        assert_eq!(told(unknown, 1.0), (first, faintest), "{unknown:?}");
    }
    let (shorter, higher) = told(Some(5e-4), 0.5);
    assert!(
        (shorter - first).abs() < 1e-12 && (higher - (faintest + libm::log(2.0))).abs() < 1e-12,
        "{shorter} {first}"
    );
    locator.forget();
    let spots = places.map(|place| spot(place, 1.0, 3.0));
    let located = locator.locate(Input::spots(&spots).exposure(5e-4)).expect("spots have no size");
    assert_eq!(located.detection_limit.unwrap().value.to_bits(), faintest.to_bits(), "it is the first again");
}

#[test]
fn any_number_of_spots_anywhere_gives_finite_answers() {
    let mut rng = Pcg64::new(4, 1);
    let (u, v) = (Uniform::new(0.0, 751.0).unwrap(), Uniform::new(0.0, 479.0).unwrap());
    for airframe in [hexarotor(), quadrotor()] {
        let mut locator = locator(&airframe);
        for count in [0, 1, 2, 3, 5, 9, 20, 60] {
            let mut spots: Vec<Spot> = (0..count)
                .map(|_| spot(Pixel::new(u.sample(&mut rng), v.sample(&mut rng)), 1.0, 4.0))
                .collect();
            spots.extend_from_within(..count / 3);
            let located = locator.locate(Input::spots(&spots)).expect("spots have no size");
            let mut members: Vec<usize> =
                located.neighbours.iter().flat_map(|neighbour| &neighbour.sightings).copied().collect();
            members.sort_unstable();
            let shared = members.windows(2).any(|pair| pair[0] == pair[1]);
            assert!(!shared && members.iter().all(|&spot| spot < spots.len()), "{members:?}");
            for neighbour in &located.neighbours {
                let Some(Position { mean_m, covariance_m2 }) = neighbour.position else { continue };
                assert!(mean_m.iter().chain(covariance_m2.iter()).all(|number| number.is_finite()));
                let distance_m = neighbour.distance.estimate.unwrap().distance_m;
                assert!((mean_m.norm() - distance_m).abs() <= 1e-9 * distance_m, "{mean_m} {distance_m}");
                assert!(neighbour.distance.bounds.contains(neighbour.distance.estimate.unwrap().distance_m));
            }
        }
    }
}

#[test]
fn of_more_spots_than_there_is_work_for_the_brightest_are_explained_and_that_is_said() {
    let mut rng = Pcg64::new(5, 1);
    let airframe = hexarotor();
    let placed = Placed::new(ahead(4.0, 0.2, 0.0), 0.3, Vector3::zeros());
    let mut spots = placed.spots(&airframe, &camera(), &mut rng);
    let (markers, u, v) = (spots.len(), Uniform::new(5.0, 745.0).unwrap(), Uniform::new(5.0, 475.0).unwrap());
    let faint = |rng: &mut Pcg64| spot(Pixel::new(u.sample(rng), v.sample(rng)), 1.0, 30.0);
    spots.splice(0..0, (0..300).map(|_| faint(&mut rng)));
    for (budget, complete) in [(200, false), (1_000_000, true)] {
        let settings = Settings { budget, ..Settings::default() };
        let mut locator = Locator::new(camera(), &airframe, None, settings).unwrap();
        let located = locator.locate(Input::spots(&spots).gravity(&level())).expect("spots have no size");
        assert_eq!(located.is_complete, complete, "budget {budget}");
        assert_eq!(located.sightings.len(), spots.len(), "every spot is told");
        let bright: Vec<usize> =
            (0..spots.len()).filter(|&spot| located.sightings[spot].spot.flux > 1000.0).collect();
        let found: Vec<&[usize]> =
            located.neighbours.iter().map(|neighbour| neighbour.sightings.as_slice()).collect();
        assert_eq!((found, bright.len()), (vec![&bright[..]], markers), "budget {budget}");
    }
}

#[test]
fn an_airframe_of_one_led_is_told_by_the_size_of_its_spot() {
    for position_m in [Vector3::zeros(), Vector3::new(0.1, 0.05, 0.08)] {
        let lamp = lamp(position_m);
        for curve in [None, Some(SpotCurve::paper_1000_us())] {
            let sized = curve.is_some();
            let mut locator = Locator::new(camera(), &lamp, curve, Settings::default()).unwrap();
            let spots = [(200.0, 200.0, 3.0), (500.0, 260.0, 6.0)]
                .map(|(u, v, distance_m)| (spot(Pixel::new(u, v), 1.0, distance_m), distance_m));
            let seen = spots.clone().map(|(spot, _)| spot);
            for gravity in [None, Some(level())] {
                locator.forget();
                let located = locator
                    .locate(Input::spots(&seen).gravity(gravity.as_ref()))
                    .expect("spots have no size");
                assert_eq!(located.neighbours.len(), 2, "each is a neighbour: {:?}", located.neighbours);
                for (neighbour, (_, distance_m)) in located.neighbours.iter().zip(&spots) {
                    let Distance { estimate, bounds, .. } = neighbour.distance;
                    let estimate = estimate.unwrap();
                    assert!(bounds.contains(*distance_m), "{distance_m} m outside {bounds:?}");
                    assert_eq!(bounds.max_m().is_finite(), sized);
                    let off_m = estimate.distance_m - distance_m;
                    assert!(off_m.abs() < 3.0 * estimate.sigma_m, "{estimate:?} for {distance_m} m");
                    assert!(neighbour.probability > 0.5 && !neighbour.misfit.chi_square.is_nan());
                }
            }
        }
    }
}

#[test]
fn a_lone_spot_where_the_sun_stands_is_the_sun_and_a_neighbour_before_it_stays_one() {
    let lamp = lamp(Vector3::zeros());
    let spots = [(200.0, 160.0), (500.0, 260.0)].map(|(u, v)| spot(Pixel::new(u, v), 1.0, 4.0));
    let towards = |pixel: Pixel| Unit::new_normalize(*camera().bearing(pixel).unwrap().vector());
    let sun = |towards| Sun::new(towards, -level(), 0.02, 0.05);
    let probabilities = |sun: Option<Sun>| {
        let settings = Settings { min_probability: 0.0, ..Settings::default() };
        let mut locator = Locator::new(camera(), &lamp, None, settings).unwrap();
        let located = locator.locate(Input::spots(&spots).gravity(&level()).sun(sun)).unwrap();
        let of = |spot: usize| {
            located
                .neighbours
                .iter()
                .find(|seen| seen.sightings == [spot])
                .map_or(0.0, |seen| seen.probability)
        };
        [of(0), of(1)]
    };
    let without = probabilities(None);
    let there = probabilities(Some(sun(towards(spots[0].centre))));
    assert!(without[0] > 0.5 && there[0] < 0.2 && there[1] > 0.5, "{without:?} {there:?}");
    let elsewhere = probabilities(Some(sun(towards(Pixel::new(350.0, 50.0)))));
    assert!((elsewhere[0] - without[0]).abs() < 1e-3, "{without:?} {elsewhere:?}");
    let mut rng = Pcg64::new(6, 1);
    let (airframe, place) = (hexarotor(), ahead(5.0, 0.2, 0.1));
    let spots = Placed::new(place, 0.3, Vector3::zeros()).spots(&airframe, &camera(), &mut rng);
    let mut locator = locator(&airframe);
    let behind = sun(towards(spots[0].centre));
    let located = locator.locate(Input::spots(&spots).gravity(&level()).sun(behind)).unwrap();
    assert!(located.neighbours.len() == 1 && located.neighbours[0].probability > 0.99);
    assert_eq!(
        located.neighbours[0].sightings.len(),
        spots.len(),
        "a marker before the sun is still its own"
    );
}
