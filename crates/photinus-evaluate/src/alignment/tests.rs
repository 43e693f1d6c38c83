//! Flights whose clock offset and lever arms are known.

use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use photinus_io::dataset::TimedPose;
use photinus_io::results::{Distance, FrameRecord, NeighbourRecord};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;

use super::*;

const OFFSET_S: f64 = 0.137;
/// What the target's log is late by, where it has a clock of its own.
const TARGET_OFFSET_S: f64 = -0.482;
const CAMERA_M: [f64; 3] = [0.12, -0.03, 0.08];
const AIRFRAME_M: [f64; 3] = [-0.05, 0.02, -0.11];

fn body_from_camera() -> UnitQuaternion<f64> {
    UnitQuaternion::from_euler_angles(-1.6, 0.05, -1.5)
}

/// Two vehicles that sway, climb and turn, as functions of time.
fn flown(time_s: f64) -> [Isometry3<f64>; 2] {
    let pose = |phase: f64, far_m: f64| {
        let t = time_s + phase;
        let place = Vector3::new(
            far_m + libm::sin(0.7 * t),
            1.5 * libm::cos(0.4 * t),
            5.0 + 0.8 * libm::sin(0.31 * t),
        );
        let turn = UnitQuaternion::from_euler_angles(
            0.2 * libm::sin(1.3 * t),
            0.2 * libm::cos(0.9 * t),
            0.8 * libm::sin(0.5 * t),
        );
        Isometry3::from_parts(place.into(), turn)
    };
    [pose(0.0, 0.0), pose(11.0, 7.0)]
}

fn log(vehicle: usize) -> Vec<TimedPose> {
    let row = |step: i32| {
        let time_s = f64::from(step) / 100.0;
        TimedPose { time_s, pose: flown(time_s)[vehicle] }
    };
    (-300..6300).map(row).collect()
}

/// Results at 20 Hz over a minute: truth with noise of `sigma_m`, each `every`th frame somewhere else.
fn results(seed: u128, sigma_m: f64, every: usize) -> Vec<FrameRecord> {
    let mut random = Pcg64::new(seed, 1);
    let camera = Isometry3::from_parts(Translation3::from(Vector3::from(CAMERA_M)), body_from_camera());
    let frame = |number: usize| {
        let time_s = number as f64 / 20.0;
        let [observer, target] = flown(time_s + OFFSET_S);
        let seen = (observer * camera).inv_mul(&(target * Translation3::from(Vector3::from(AIRFRAME_M))));
        let noise =
            Vector3::from_fn(|_, _| sigma_m * Distribution::<f64>::sample(&StandardNormal, &mut random));
        let off = if number % every == every - 1 { Vector3::new(2.0, -1.0, 3.0) } else { Vector3::zeros() };
        let place = seen.translation.vector + noise + off;
        record(number as u64, time_s, &place, sigma_m)
    };
    (0..1200).map(frame).collect()
}

fn record(number: u64, time_s: f64, place: &Vector3<f64>, sigma_m: f64) -> FrameRecord {
    let far_m = place.norm();
    let neighbour = NeighbourRecord {
        track: None,
        id: None,
        id_probability: None,
        airframe: "quad".to_owned(),
        spots: vec![],
        bearing: (place / far_m).into(),
        distance_m: Distance {
            estimate: Some(far_m),
            sigma: Some(sigma_m),
            min: 0.0,
            max: None,
            perpendicular: None,
            inline: None,
        },
        position_m: Some((*place).into()),
        position_covariance_m2: Some((Matrix3::identity() * sigma_m * sigma_m).into()),
        position_body_m: None,
        position_body_covariance_m2: None,
        velocity_m_s: None,
        velocity_covariance_m2_s2: None,
        orientation_xyzw: None,
        orientation_covariance_rad2: None,
        position_orientation_covariance_m_rad: None,
        probability: None,
        misfit: None,
        airframe_probability: None,
        runner_up: None,
        modes: vec![],
    };
    FrameRecord {
        frame: Some(number),
        camera: None,
        time_s: Some(time_s),
        latency_s: None,
        source: String::new(),
        incomplete: false,
        spots: vec![],
        rejected: vec![],
        neighbours: vec![neighbour],
        tracks: vec![],
    }
}

/// Every error of an alignment beside its claimed sigma.
fn errors(found: &Alignment) -> Vec<(f64, f64)> {
    let turn = (body_from_camera().inverse() * found.body_from_camera).scaled_axis();
    let [camera, airframe] =
        [found.camera_m - Vector3::from(CAMERA_M), found.airframe_m - Vector3::from(AIRFRAME_M)];
    let sigma = &found.sigma;
    let mut errors = vec![(found.clock_offset_s - OFFSET_S, sigma.clock_offset_s)];
    for (error, sigma) in [(turn, sigma.rotation_rad), (camera, sigma.camera_m), (airframe, sigma.airframe_m)]
    {
        errors.extend(error.iter().copied().zip(sigma.iter().copied()));
    }
    errors
}

#[test]
fn what_is_estimated_scatters_as_its_standard_errors_say() {
    scatter_is_as_claimed(TargetClock::Shared, 0.0);
}

#[test]
fn a_target_with_a_clock_of_its_own_is_aligned_as_well() {
    // A start that is off by most of what is searched.
    scatter_is_as_claimed(TargetClock::Own { near_s: TARGET_OFFSET_S + 1.7 }, TARGET_OFFSET_S);
}

fn scatter_is_as_claimed(target_clock: TargetClock, target_offset_s: f64) {
    let (observer, mut target) = (log(0), log(1));
    for row in &mut target {
        row.time_s += target_offset_s;
    }
    let logs = Logs { observer: &observer, target: &target, target_clock };
    let (runs, mut squares) = (24, [0.0; 11]);
    for seed in 0..runs {
        let found = logs.align(&results(seed, 0.05, usize::MAX), 0.0).unwrap();
        assert_eq!(found.frames, 1200);
        let error_s = found.target_clock_offset_s - target_offset_s;
        let target_clock = match target_clock {
            TargetClock::Shared => None,
            TargetClock::Own { .. } => Some((error_s, found.sigma.target_clock_offset_s)),
        };
        if target_clock.is_none() {
            assert_eq!((error_s, found.sigma.target_clock_offset_s), (0.0, 0.0));
        }
        let all = errors(&found).into_iter().chain(target_clock);
        for (sum, (error, sigma)) in squares.iter_mut().zip(all) {
            assert!(error.abs() < 5.0 * sigma, "{error} with sigma {sigma}");
            *sum += (error / sigma).powi(2);
        }
    }
    let estimated = if target_clock == TargetClock::Shared { 10 } else { 11 };
    // The root of a mean of 24 squares is known to a seventh; three of them either way.
    for (number, sum) in squares.iter().take(estimated).enumerate() {
        let ratio = (sum / f64::from(runs as u32)).sqrt();
        assert!((0.57..1.45).contains(&ratio), "number {number}: scatter is {ratio} of what is claimed");
    }
}

#[test]
fn frames_that_are_wrong_pull_little() {
    let (observer, target) = (log(0), log(1));
    let found = Logs { observer: &observer, target: &target, target_clock: TargetClock::Shared }
        .align(&results(7, 0.02, 20), 0.0)
        .unwrap();
    assert!((found.clock_offset_s - OFFSET_S).abs() < 0.005, "{}", found.clock_offset_s);
    assert!((found.camera_m - Vector3::from(CAMERA_M)).norm() < 0.03, "{}", found.camera_m);
    assert!((found.airframe_m - Vector3::from(AIRFRAME_M)).norm() < 0.03, "{}", found.airframe_m);
}

#[test]
fn truth_is_where_it_was() {
    let (observer, target) = (log(0), log(1));
    let logs = Logs { observer: &observer, target: &target, target_clock: TargetClock::Shared };
    let results = results(3, 0.02, usize::MAX);
    let truth = logs.truth(&logs.align(&results, 0.0).unwrap(), &results);
    assert_eq!(truth.len(), results.len());
    let camera = Isometry3::from_parts(Translation3::from(Vector3::from(CAMERA_M)), body_from_camera());
    for frame in &truth {
        let [observer, target] = flown(frame.time_s + OFFSET_S);
        let seen = (observer * camera).inv_mul(&(target * Translation3::from(Vector3::from(AIRFRAME_M))));
        let neighbour = &frame.neighbours[0];
        assert!((Vector3::from(neighbour.position_m) - seen.translation.vector).norm() < 0.02);
        let turn = UnitQuaternion::new_unchecked(nalgebra::Quaternion::from(neighbour.orientation_xyzw));
        assert!(turn.angle_to(&seen.rotation) < 0.01);
    }
}

#[test]
fn a_clock_that_is_far_off_is_told_and_found_with_a_hint() {
    let (observer, target) = (log(0), log(1));
    let logs = Logs { observer: &observer, target: &target, target_clock: TargetClock::Shared };
    let mut late = results(5, 0.02, usize::MAX);
    for record in &mut late {
        record.time_s = record.time_s.map(|time_s| time_s + 1e6);
    }
    let error = logs.align(&late, 0.0).unwrap_err();
    assert!(matches!(error, AlignError::Times { .. }), "{error}");
    let found = logs.align(&late, -1e6 + 0.8).unwrap();
    assert!((found.clock_offset_s - (OFFSET_S - 1e6)).abs() < 0.01, "{}", found.clock_offset_s);
    assert!(matches!(logs.align(&late[..20], -1e6), Err(AlignError::Few(20))));
}

#[test]
fn clocks_that_nothing_tells_are_no_alignment() {
    let (observer, mut target) = (log(0), log(1));
    // An observer that hangs still looks the same at any time of its clock.
    let still: Vec<TimedPose> =
        observer.iter().map(|row| TimedPose { time_s: row.time_s, pose: observer[0].pose }).collect();
    let mut seen = results(9, 0.02, usize::MAX);
    let camera = Isometry3::from_parts(Translation3::from(Vector3::from(CAMERA_M)), body_from_camera());
    for record in &mut seen {
        let airframe = flown(record.time_s.unwrap() + OFFSET_S)[1] * nalgebra::Point3::from(AIRFRAME_M);
        let place = (still[0].pose * camera).inverse_transform_point(&airframe);
        record.neighbours[0].position_m = Some(place.coords.into());
    }
    let own = TargetClock::Own { near_s: 0.0 };
    let logs = Logs { observer: &still, target: &target, target_clock: own };
    assert_eq!(logs.align(&seen, 0.0).unwrap_err(), AlignError::Still);
    assert!(Logs { target_clock: TargetClock::Shared, ..logs }.align(&seen, 0.0).is_ok());

    // A clock that is farther off than is looked for.
    for row in &mut target {
        row.time_s += 6.0;
    }
    let logs = Logs { observer: &observer, target: &target, target_clock: own };
    let error = logs.align(&results(10, 0.02, usize::MAX), 0.0).unwrap_err();
    assert!(matches!(error, AlignError::Clocks | AlignError::Still | AlignError::NoTurn), "{error}");
}
