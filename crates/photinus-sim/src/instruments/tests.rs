//! Instruments against what they should measure, and their errors over many samples.

use nalgebra::{Isometry3, Unit, UnitQuaternion, Vector3};

use super::*;
use crate::motion::{Flight, Motion, Path, Spin, Wander};

/// A flight in the wind around a circle, with a spin: everything turns.
fn flight() -> Motion {
    Motion::Flown(Flight {
        path: Path::Circle {
            centre_m: Vector3::new(1.0, 2.0, 5.0),
            radius_m: 4.0,
            speed_m_s: 3.0,
            phase_rad: 0.4,
        },
        wander: Wander::new(3.0, 9),
        heading_rad: 0.7,
        spins: vec![Spin { start_s: 2.0, duration_s: 3.0, turns: 1.5 }],
    })
}

fn hover() -> Motion {
    Motion::Flown(Flight {
        path: Path::Hover { position_m: Vector3::new(3.0, -2.0, 5.0) },
        wander: Wander::still(),
        heading_rad: 0.0,
        spins: Vec::new(),
    })
}

fn mean_and_sigma(values: &[f64]) -> (f64, f64) {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    (mean, (values.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / count).sqrt())
}

const QUIET_GYRO: Gyro = Gyro { rate_hz: 200.0, noise_rad_s: 0.0, bias_rad_s: 0.0, bias_walk_rad_s: 0.0 };
const QUIET_ODOMETRY: Odometry = Odometry {
    rate_hz: 50.0,
    place_walk_m: 0.0,
    heading_walk_rad: 0.0,
    tilt_noise_rad: 0.0,
    velocity_noise_m_s: 0.0,
};

#[test]
fn a_gyro_without_errors_adds_up_to_the_attitude() {
    let motion = flight();
    let mut attitude = motion.pose(-0.0025).rotation;
    let mut rows = 0;
    for row in QUIET_GYRO.measure(&motion, 6.0, 1) {
        attitude *= UnitQuaternion::from_scaled_axis(row.turn_rad_s / 200.0);
        let truth = motion.pose(row.time_s + 0.0025).rotation;
        assert!(attitude.angle_to(&truth) < 1e-9, "{} s", row.time_s);
        rows += 1;
    }
    assert_eq!(rows, 1201);
    // in the middle of the spin the nose turns at its fastest: 1.5 turns in 3 s, times 1.5
    let spin = Motion::Flown(Flight {
        spins: vec![Spin { start_s: 2.0, duration_s: 3.0, turns: 1.5 }],
        ..match hover() {
            Motion::Flown(flight) => flight,
            Motion::Recorded(_) => panic!("it is flown"),
        }
    });
    let fastest = QUIET_GYRO.measure(&spin, 6.0, 1).find(|row| row.time_s >= 3.5).unwrap().turn_rad_s;
    assert!((fastest - Vector3::z() * 1.5 * core::f64::consts::PI).norm() < 1e-3, "{fastest}");
}

#[test]
fn a_gyro_has_its_noise_and_its_bias() {
    let noisy = Gyro { noise_rad_s: 0.02, bias_rad_s: 0.1, ..QUIET_GYRO };
    let rows: Vec<_> = noisy.measure(&hover(), 500.0, 4).map(|row| row.turn_rad_s.y).collect();
    let (bias, sigma) = mean_and_sigma(&rows);
    assert_eq!(rows.len(), 100_001);
    assert!((sigma / 0.02 - 1.0).abs() < 0.01, "{sigma}");
    let biases: Vec<f64> = (0..3000)
        .map(|seed| {
            Gyro { bias_rad_s: 0.1, ..QUIET_GYRO }.measure(&hover(), 0.0, seed).next().unwrap().turn_rad_s.x
        })
        .collect();
    let (mean, spread) = mean_and_sigma(&biases);
    assert!(mean.abs() < 0.01 && (spread / 0.1 - 1.0).abs() < 0.04, "{mean} {spread}");
    let first = Gyro { bias_rad_s: 0.1, ..QUIET_GYRO }.measure(&hover(), 0.0, 4).next().unwrap();
    assert!((first.turn_rad_s.y - bias).abs() < 3e-4, "the same bias all along");
    // after 9 s a bias that walks 0.01 rad/s in a second has gone three times as far
    let walked: Vec<f64> = (0..2000)
        .map(|seed| {
            let walking = Gyro { rate_hz: 20.0, bias_walk_rad_s: 0.01, ..QUIET_GYRO };
            walking.measure(&hover(), 9.0, seed).last().unwrap().turn_rad_s.z
        })
        .collect();
    assert!((mean_and_sigma(&walked).1 / 0.03 - 1.0).abs() < 0.05, "{:?}", mean_and_sigma(&walked));
}

#[test]
fn gravity_is_wrong_by_its_sigmas_and_its_bias_is_that_of_the_vehicle() {
    let level = UnitQuaternion::from_scaled_axis(Vector3::new(0.2, -0.1, 0.4));
    let cameras = [0.0, 2.0].map(|yaw| {
        Isometry3::from_parts(
            Vector3::zeros().into(),
            UnitQuaternion::from_scaled_axis(Vector3::new(0.3, yaw, 1.0)),
        )
    });
    let down = level * -Vector3::z_axis();
    let seen = |camera: usize| Unit::new_normalize(cameras[camera].rotation.inverse() * down.into_inner());
    let told = |gravity: &Gravity, camera: usize, number: u64, seed: u64| {
        gravity.measure(&seen(camera), &cameras[camera], (camera as u64, number), seed)
    };
    let noise = Gravity { noise_rad: 0.01, bias_rad: 0.0 };
    let angles: Vec<f64> = (0..20_000).map(|n| libm::acos(told(&noise, 1, n, 3).dot(&seen(1)))).collect();
    // two axes across: mean square 2 sigma^2
    let rms = (angles.iter().map(|a| a * a).sum::<f64>() / 2e4).sqrt();
    assert!((rms / (0.01 * 2.0_f64.sqrt()) - 1.0).abs() < 0.02, "{rms}");
    let bias = Gravity { noise_rad: 0.0, bias_rad: 0.01 };
    let in_body = |camera: usize, n: u64| cameras[camera].rotation * told(&bias, camera, n, 3).into_inner();
    assert!((in_body(0, 1) - in_body(1, 7)).norm() < 1e-12, "all cameras, all frames");
    assert!((in_body(0, 1) - down.into_inner()).norm() > 1e-3);
}

#[test]
fn odometry_without_errors_is_the_motion_in_its_own_frame() {
    let motion = flight();
    let start = motion.pose(0.0);
    let nose = start * Vector3::x();
    let heading = UnitQuaternion::from_scaled_axis(Vector3::z() * -libm::atan2(nose.y, nose.x));
    for row in QUIET_ODOMETRY.measure(&motion, 6.0, 1) {
        let truth = motion.pose(row.time_s);
        let moved_m = heading * (truth.translation.vector - start.translation.vector);
        assert!((row.pose.translation.vector - moved_m).norm() < 1e-9);
        assert!(row.pose.rotation.angle_to(&(heading * truth.rotation)) < 1e-9);
        let [after, before] = [1e-4, -1e-4].map(|step_s| motion.pose(row.time_s + step_s).translation.vector);
        assert!((row.velocity_m_s - heading * (after - before) / 2e-4).norm() < 1e-4);
    }
}

#[test]
fn odometry_drifts_with_the_square_root_of_time() {
    let drifting = Odometry {
        rate_hz: 10.0,
        place_walk_m: 0.05,
        heading_walk_rad: 0.02,
        tilt_noise_rad: 0.003,
        velocity_noise_m_s: 0.1,
    };
    let last = |seed| drifting.measure(&hover(), 16.0, seed).last().unwrap();
    let rows: Vec<_> = (0..2000).map(last).collect();
    let sigma = |f: &dyn Fn(&photinus_io::dataset::OdometryRow) -> f64| {
        let values: Vec<f64> = rows.iter().map(f).collect();
        mean_and_sigma(&values).1
    };
    // 16 s: four times what a second does
    assert!((sigma(&|row| row.pose.translation.y) / 0.2 - 1.0).abs() < 0.05);
    let heading = |row: &photinus_io::dataset::OdometryRow| {
        let nose = row.pose * Vector3::x();
        libm::atan2(nose.y, nose.x)
    };
    assert!((sigma(&heading) / 0.08 - 1.0).abs() < 0.05);
    assert!((sigma(&|row| (row.pose.rotation * Vector3::z()).x) / 0.003 - 1.0).abs() < 0.05);
    assert!((sigma(&|row| row.velocity_m_s.x) / 0.1 - 1.0).abs() < 0.05);
    assert_eq!(last(3), last(3), "a function of the seed");
}
