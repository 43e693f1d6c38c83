use nalgebra::{Matrix3, Rotation3, Unit, Vector3, Vector6};
use proptest::prelude::*;

use super::observation::Whitened;
use super::problem::{Merging, Problem};
use super::refine::{Held, MOST_STEPS, Refined, refine};
use super::*;
use crate::airframe::{Airframe, Led, Lobe, LobeTable, Ring};
use crate::camera::Bearing;

fn hexarotor() -> Airframe {
    let ring = Ring { arms: 6, radius_m: 0.4, leds_per_arm: 1, splay_rad: 0.0 };
    Airframe::from_ring("hexarotor", ring).unwrap()
}

fn quadrotor() -> Airframe {
    let ring = Ring { arms: 4, radius_m: 0.245, leds_per_arm: 2, splay_rad: core::f64::consts::FRAC_PI_2 };
    Airframe::from_ring("quadrotor", ring).unwrap()
}

/// Upright, a camera along the horizon.
fn level() -> Rotation3<f64> {
    Rotation3::from_basis_unchecked(&[Vector3::z(), -Vector3::x(), -Vector3::y()])
}

fn observation(direction: Vector3<f64>, sigma_rad: f64, light: f64) -> Observation {
    let bearing = Bearing::new(direction).unwrap();
    let across = Matrix3::identity() - bearing.vector() * bearing.vector().transpose();
    Observation {
        bearing,
        covariance_rad2: across * (sigma_rad * sigma_rad),
        log_light: Some(LogLight { value: libm::log(light), sigma: 0.05 }),
        resolution_rad: 0.0,
        signal: None,
        clutter_log_density: 0.0,
    }
}

fn nothing() -> Known<'static> {
    let bounds = crate::ranging::Interval::new(0.0, f64::INFINITY).unwrap();
    Known {
        up: None,
        bounds,
        size: None,
        power: None,
        tilt_sigma_rad: None,
        unit_sigma: None,
        visible: Visible::default(),
    }
}

/// Laws and tables of how light falls off to the side.
fn lobes() -> impl Strategy<Value = Lobe> {
    let table = prop::collection::vec(0.1f64..1.5, 4).prop_map(|intensities| {
        let angles_rad = [0.0, 0.4, 0.8, 1.2, 1.5];
        let closed: Vec<f64> = intensities.into_iter().chain([0.0]).collect();
        Lobe::Table(LobeTable::new(&angles_rad, &closed).unwrap())
    });
    let cosine = (1.0f64..9.0).prop_map(|power| Lobe::Cosine { power });
    prop_oneof![Just(Lobe::Lambertian), Just(Lobe::Omni), cosine, table]
}

proptest! {
    #[test]
    fn derivatives_agree_with_finite_differences(
        place in prop::array::uniform3(-3.0f64..3.0), turn in prop::array::uniform3(-0.6f64..0.6),
        yaw in -3.0f64..3.0, noise in prop::array::uniform6(-0.003f64..0.003), with_up in any::<bool>(), quad in any::<bool>(),
    ) {
        let airframe = if quad { quadrotor() } else { hexarotor() };
        let pose = Pose {
            position_m: Vector3::from(place) + Vector3::z() * 4.0,
            camera_from_body: Rotation3::new(Vector3::from(turn)) * level() * Rotation3::new(Vector3::z() * yaw),
        };
        prop_assume!(pose.position_m.norm() > 1.0);
        let camera = pose.camera_in_body_m();
        let seen: Vec<u16> = airframe.visible(camera).filter(|&m| airframe.intensity(m, &camera) > 0.1).map(|m| m as u16).collect();
        prop_assume!(seen.len() >= 2);
        let observations: Vec<Observation> = seen.iter().enumerate().map(|(index, &marker)| {
            let off = Vector3::new(noise[index % 6], noise[(index + 1) % 6], noise[(index + 2) % 6]);
            let place = pose.camera_from_body * airframe.markers()[usize::from(marker)].position_m + pose.position_m;
            observation(place.normalize() + off, 2e-3, 1.0 + 300.0 * noise[index % 6].abs())
        }).collect();
        let whitened: Vec<Whitened> = observations.iter().map(|seen| Whitened::of(seen, 0.0)).collect();
        let markers: Vec<Option<u16>> = seen.into_iter().map(Some).collect();
        let settings = Settings::default();
        let known = Known {
            up: with_up.then(|| Unit::new_normalize(Vector3::new(0.05, -1.0, 0.02))),
            size: Some(LogDistance { mean: 1.0, sigma: 0.5 }),
            ..nothing()
        };
        let problem = Problem {
            airframe: &airframe, settings: &settings, observations: &observations, whitened: &whitened, markers: &markers,
            known: &known, merging: Merging::Far, repeats: 1.0,
        };
        let normal = problem.normal(&pose);
        prop_assert!((normal.information - normal.information.transpose()).norm() == 0.0);
        // The light's variance moves with the pose and is held in a step, so that it is left out of the comparison.
        let held = Settings { use_brightness: false, ..settings };
        let problem = Problem { settings: &held, ..problem };
        let normal = problem.normal(&pose);
        for axis in 0..6 {
            let mut step = Vector6::zeros();
            step[axis] = 1e-6;
            let ahead = problem.normal(&pose.stepped(&step));
            let behind = problem.normal(&pose.stepped(&-step));
            let numeric = (ahead.nats - behind.nats) / 2e-6;
            let scale = 1.0 + normal.information[(axis, axis)].sqrt();
            prop_assert!((numeric - normal.gradient[axis]).abs() < 2e-4 * scale, "axis {axis}: {numeric} {}", normal.gradient[axis]);
        }
    }

    #[test]
    fn slopes_of_light_agree_with_finite_differences(
        place in prop::array::uniform3(-3.0f64..3.0), yaw in -3.0f64..3.0, quad in any::<bool>(), lobe in lobes(),
    ) {
        let uniform = if quad { quadrotor() } else { hexarotor() };
        let leds = (1..).zip(uniform.leds()).map(|(number, led)| {
            Led { lobe: lobe.clone(), power: 0.3 * f64::from(number), ..led.clone() }
        });
        let airframe = Airframe::new("various", leds.collect()).unwrap();
        let camera = Vector3::from(place) + Rotation3::new(Vector3::z() * yaw) * Vector3::x() * 3.0;
        for marker in 0..airframe.markers().len() {
            let (intensity, gradient) = airframe.intensity_with_gradient(marker, &camera);
            prop_assert_eq!(intensity.to_bits(), airframe.intensity(marker, &camera).to_bits());
            let step = 1e-7;
            let numeric = Vector3::from_fn(|axis, _| {
                let mut off = Vector3::zeros();
                off[axis] = step;
                (airframe.intensity(marker, &(camera + off)) - airframe.intensity(marker, &(camera - off))) / (2.0 * step)
            });
            prop_assert!(intensity < 1e-5 || (numeric - gradient).norm() < 1e-5, "{numeric} {gradient}");
        }
    }

    #[test]
    fn slopes_of_merged_light_agree_with_finite_differences(
        camera in prop::array::uniform3(-1.0f64..1.0), yaw in -3.0f64..3.0, resolution_rad in 0.02f64..0.3, quad in any::<bool>(),
    ) {
        let airframe = if quad { quadrotor() } else { hexarotor() };
        let camera_m = Vector3::from(camera) + Rotation3::new(Vector3::z() * yaw) * Vector3::x() * 4.0;
        let brightest = (0..airframe.markers().len())
            .max_by(|&a, &b| airframe.intensity(a, &camera_m).total_cmp(&airframe.intensity(b, &camera_m))).unwrap();
        let observations = [Observation { resolution_rad, ..observation(Vector3::z(), 1e-3, 1.0) }];
        let whitened = observations.map(|seen| Whitened::of(&seen, 0.0));
        let (settings, markers) = (Settings::default(), [Some(brightest as u16)]);
        let problem = Problem {
            airframe: &airframe, settings: &settings, observations: &observations, whitened: &whitened, markers: &markers,
            known: &nothing(), merging: Merging::Near, repeats: 1.0,
        };
        let shining = |at: &Vector3<f64>| problem.shining(0, brightest, at);
        let centre = |at: &Vector3<f64>| shining(at).centre;
                let step = 1e-6;
        for axis in 0..3 {
            let mut off = Vector3::zeros();
            off[axis] = step;
            let (ahead, behind) = (camera_m + off, camera_m - off);
            let numeric = (centre(&ahead).at_m - centre(&behind).at_m) / (2.0 * step);
            let analytic = centre(&camera_m).by_camera.column(axis).into_owned();
            // Where a marker comes into sight there is no slope.
            let kink = airframe.markers().len() != (0..airframe.markers().len())
                .filter(|&marker| !(1e-9..1e-4).contains(&airframe.intensity(marker, &camera_m))).count();
            prop_assert!(kink || (numeric - analytic).norm() < 1e-5, "axis {axis}: {numeric} {analytic}");
            let numeric = (shining(&ahead).intensity - shining(&behind).intensity) / (2.0 * step);
            prop_assert!(kink || (numeric - shining(&camera_m).intensity_gradient[axis]).abs() < 1e-5, "axis {axis}: {numeric}");
        }
    }

    #[test]
    fn markers_that_merge_are_seen_between_them(gap in 0.0f64..2.5) {
        // Two markers of one light 0.1 m apart, side by side, the first seen: as one spot they are in their middle, as rendered pairs are; far apart it is alone.
        let airframe = pair();
        let camera_m = Vector3::new(5.0, 0.0, 0.0);
        let resolution_rad = 0.02 / gap.max(1e-3);
        let observations = [Observation { resolution_rad, ..observation(Vector3::z(), 1e-3, 1.0) }];
        let whitened = observations.map(|seen| Whitened::of(&seen, 0.0));
        let (settings, markers) = (Settings::default(), [Some(0)]);
        let problem = Problem {
            airframe: &airframe, settings: &settings, observations: &observations, whitened: &whitened, markers: &markers,
            known: &nothing(), merging: Merging::Near, repeats: 1.0,
        };
        let centre = problem.shining(0, 0, &camera_m).centre;
        let merged = problem.merged(0, 0, 1, &camera_m);
        let expected = if gap < 1.99 { 0.0 } else { -0.05 };
        prop_assert!((1.99..2.01).contains(&gap) || (centre.at_m.y - expected).abs() < 2e-3, "{} {expected}", centre.at_m.y);
        prop_assert!((0.0..=1.0).contains(&merged) && (gap < 2.01 || merged == 0.0) && (gap > 0.2 || merged > 0.99), "{merged}");
        prop_assert!(centre.factor <= 1.0 && (gap < 2.01 || centre.factor > 1.0 - 1e-12));
    }
}

/// Two markers of one light 0.1 m apart, side by side.
fn pair() -> Airframe {
    side_by_side([-0.05, 0.05])
}

/// Markers of one light at these places across the view, m.
fn side_by_side(places_m: impl IntoIterator<Item = f64>) -> Airframe {
    let led = |y| Led {
        position_m: Vector3::new(0.0, y, 0.0),
        axis: Vector3::x_axis(),
        lobe: Lobe::Omni,
        power: 1.0,
        signal: None,
    };
    Airframe::new("side by side", places_m.into_iter().map(led).collect()).unwrap()
}

#[test]
fn all_markers_of_a_strip_are_in_its_middle_and_shine() {
    for count in [2_u32, 7, 8, 9, 20] {
        let airframe = side_by_side((0..count).map(|place| 0.1 * f64::from(place)));
        assert_eq!(airframe.markers().len(), count as usize);
        let observations = [Observation { resolution_rad: 0.1, ..observation(Vector3::z(), 1e-3, 1.0) }];
        let whitened = observations.map(|seen| Whitened::of(&seen, 0.0));
        let problem = Problem {
            airframe: &airframe,
            settings: &Settings::default(),
            observations: &observations,
            whitened: &whitened,
            markers: &[Some(0)],
            known: &nothing(),
            merging: Merging::Near,
            repeats: 1.0,
        };
        let shining = problem.shining(0, 0, &Vector3::new(100.0, 0.0, 0.0));
        let middle_m = 0.05 * f64::from(count - 1);
        assert!((shining.centre.at_m.y - middle_m).abs() < 1e-2, "{count}: {}", shining.centre.at_m.y);
        assert!((shining.intensity - f64::from(count)).abs() < 0.05, "{count}: {}", shining.intensity);
    }
}

/// The pair, side by side to a camera 5 m away that makes one spot of it.
fn with_merged_pair<T>(
    (sigma_rad, extra_rad2): (f64, f64),
    repeats: f64,
    tell: impl FnOnce(&Problem<'_>, &Pose) -> T,
) -> T {
    let (airframe, settings, known) = (pair(), Settings::default(), nothing());
    let observations = [Observation { resolution_rad: 0.03, ..observation(Vector3::z(), sigma_rad, 1.0) }];
    let whitened = observations.map(|seen| Whitened::of(&seen, extra_rad2));
    let problem = Problem {
        airframe: &airframe,
        settings: &settings,
        observations: &observations,
        whitened: &whitened,
        markers: &[Some(0)],
        known: &known,
        merging: Merging::Near,
        repeats,
    };
    let camera_from_body = Rotation3::from_basis_unchecked(&[Vector3::x(), -Vector3::z(), Vector3::y()])
        * Rotation3::from_axis_angle(&Vector3::z_axis(), core::f64::consts::FRAC_PI_2);
    tell(&problem, &Pose { position_m: Vector3::z() * 5.0, camera_from_body })
}

#[test]
fn what_is_unsure_of_a_merged_centre_adds_to_what_is_unsure_of_its_marker() {
    let unsure_rad2 = |sigma_rad: f64, extra_rad2: f64| {
        let told_rad2 = sigma_rad * sigma_rad + extra_rad2;
        let factor = with_merged_pair((sigma_rad, extra_rad2), 1.0, |problem, pose| {
            problem.shining(0, 0, &pose.camera_in_body_m()).centre.factor
        });
        told_rad2 / factor.powi(2) - told_rad2
    };
    // The other LED's share of the light, a half, is sure to the spread of two powers: so much of their gap.
    let share = 0.25 * Settings::default().unit_sigma * core::f64::consts::SQRT_2 * 0.1 / 5.0;
    let alone = unsure_rad2(1e-3, 0.0);
    assert!((0.5..8.0).contains(&(alone.sqrt() / share)), "{} {share}", alone.sqrt());
    for (sigma_rad, extra_rad2) in [(1e-5, 0.0), (1e-5, 1e-6), (1e-5, 1.6e-5), (1e-3, 1.6e-5)] {
        let unsure = unsure_rad2(sigma_rad, extra_rad2);
        assert!((unsure / alone - 1.0).abs() < 1e-2, "{sigma_rad} {extra_rad2}: {unsure} {alone}");
    }
}

#[test]
fn what_errs_alike_from_frame_to_frame_is_told_once() {
    let nats = |repeats: f64| {
        with_merged_pair((1e-5, 0.0), repeats, |problem, pose| problem.normal_of_spots(pose).nats)
    };
    let [one, two, four] = [1.0, 2.0, 4.0].map(nats);
    assert!(one - two > 1.0 && (one - two - 2.0 * (two - four)).abs() < 1e-9, "{one} {two} {four}");
}

/// On the sphere's other side a spot's tangent plane is the same.
#[test]
fn nobody_is_behind_the_camera_that_sees_them() {
    let airframe = hexarotor();
    let pose = Pose { position_m: Vector3::z() * 4.0, camera_from_body: level() };
    let camera_m = pose.camera_in_body_m();
    let shown: Vec<usize> =
        (0..airframe.markers().len()).filter(|&own| airframe.intensity(own, &camera_m) > 0.3).collect();
    let direction =
        |own: &usize| pose.camera_from_body * airframe.markers()[*own].position_m + pose.position_m;
    let observations: Vec<_> = shown.iter().map(|own| observation(direction(own), 1e-3, 1.0)).collect();
    let whitened: Vec<_> = observations.iter().map(|seen| Whitened::of(seen, 0.0)).collect();
    let markers: Vec<_> = shown.iter().map(|&own| Some(own as u16)).collect();
    let (settings, known) = (Settings::default(), nothing());
    let problem = Problem {
        airframe: &airframe,
        settings: &settings,
        observations: &observations,
        whitened: &whitened,
        markers: &markers,
        known: &known,
        merging: Merging::Far,
        repeats: 1.0,
    };
    // Mirrored at the camera every direction is the opposite, and every map gives nothing.
    let mirrored = Pose {
        position_m: -pose.position_m,
        camera_from_body: pose.camera_from_body
            * Rotation3::from_axis_angle(&Vector3::z_axis(), core::f64::consts::PI),
    };
    assert!(problem.normal_of_spots(&pose).nats.is_finite());
    assert!(problem.normal_of_spots(&mirrored).nats.is_infinite());
}

/// How much lower, nats, a pose with its yaw held may still come, by slope and bend there.
fn height_over_valley(problem: &Problem<'_>, pose: &Pose) -> Option<f64> {
    let held = Held::of(Refined::at(problem, *pose))?;
    let slope = held.at.normal.gradient.fixed_rows::<5>(0).into_owned();
    Some(0.5 * slope.dot(&held.rest.solve(&slope)))
}

#[test]
fn slices_lie_at_the_bottom_of_their_valley() {
    let (settings, airframe) = (Settings::default(), hexarotor());
    let (mut slices, mut off) = (0, 0);
    for (number, spots) in (0..120).zip([1, 1, 2, 2, 3].into_iter().cycle()) {
        let yaw_rad = 0.37 * f64::from(number);
        let pose = Pose {
            position_m: Vector3::new(0.3, -0.2 + 0.01 * f64::from(number), 2.0 + 0.05 * f64::from(number)),
            camera_from_body: level() * Rotation3::new(Vector3::z() * yaw_rad),
        };
        let camera_m = pose.camera_in_body_m();
        let mut seen: Vec<usize> = airframe.visible(camera_m).collect();
        seen.sort_by(|&a, &b| airframe.intensity(b, &camera_m).total_cmp(&airframe.intensity(a, &camera_m)));
        seen.truncate(spots);
        let observations: Vec<Observation> = seen
            .iter()
            .map(|&marker| {
                let place = pose.camera_from_body * airframe.markers()[marker].position_m + pose.position_m;
                let light = airframe.intensity(marker, &camera_m) / place.norm_squared();
                observation(place.normalize(), 2e-3, light)
            })
            .collect();
        let whitened: Vec<Whitened> = observations.iter().map(|seen| Whitened::of(seen, 0.0)).collect();
        let markers: Vec<Option<u16>> = seen.iter().map(|&marker| Some(marker as u16)).collect();
        let size = LogDistance { mean: libm::log(pose.position_m.norm()), sigma: 0.3 };
        let up = (number % 2 == 0).then(|| Unit::new_unchecked(-Vector3::y()));
        let power = LogLight { value: 0.0, sigma: 0.35 };
        let known = Known {
            up,
            size: (spots == 1).then_some(size),
            power: (spots == 1).then_some(power),
            ..nothing()
        };
        let problem = Problem {
            airframe: &airframe,
            settings: &settings,
            observations: &observations,
            whitened: &whitened,
            markers: &markers,
            known: &known,
            merging: Merging::Far,
            repeats: 1.0,
        };
        let mode = refine(&problem, pose, MOST_STEPS);
        let mut components = Vec::new();
        along_yaw::spread(&problem, &mode, 0, &mut components);
        let best = components.iter().map(|component| component.log_weight).fold(f64::NEG_INFINITY, f64::max);
        for component in components.iter().filter(|component| component.log_weight > best - 5.0) {
            slices += 1;
            let height = height_over_valley(&problem, &component.pose).unwrap_or(f64::INFINITY);
            off += usize::from(height > 0.02);
        }
    }
    // Those beside a marker that turns away may have no bottom.
    assert!(slices > 1000 && off * 50 < slices, "{off} of {slices}");
}
