//! The parts against obviously right twins: derivatives by differences, sums over all ways one by one, moments of what is split.

use nalgebra::{Matrix6, Rotation3, Vector3};
use rand_distr::{Distribution, Uniform};
use rand_pcg::Pcg64;

use super::simulator::{hexarotor, normal, normal3};
use crate::pose::Pose;
use crate::tracking::branches::Predicted;
use crate::tracking::component::{Component, Covariance, SIZE, Step, merged};
use crate::tracking::joint::{Choice, Joint};
use crate::tracking::motion::{Faster, Motion, Turn};
use crate::tracking::power::Power;
use crate::tracking::reduction::reduce;
use crate::tracking::settings::{Association, Settings};
use crate::tracking::silent::Silent;
use crate::tracking::splitting::{split, straight_rad};

fn any_component(rng: &mut Pcg64) -> Component {
    let root = Covariance::from_fn(|_, _| 0.1 * normal(rng));
    Component {
        weight: 1.0,
        pose: Pose {
            position_m: Vector3::z() * 6.0 + normal3(rng),
            camera_from_body: Rotation3::new(normal3(rng)),
        },
        velocity_m_s: normal3(rng),
        yaw_rate_rad_s: normal(rng),
        covariance: root * root.transpose() + Covariance::identity() * 1e-3,
        silent: Silent::BEFOREHAND,
        power: Power::UNKNOWN,
    }
}

#[test]
fn the_direction_of_a_marker_changes_as_differences_say() {
    let mut rng = Pcg64::new(1, 1);
    let airframe = hexarotor();
    for _ in 0..100 {
        let component = any_component(&mut rng);
        let direction = |pose: &Pose| Predicted::of(&airframe, pose, &Matrix6::identity(), 2).direction;
        let told = Predicted::of(&airframe, &component.pose, &Matrix6::identity(), 2).by_pose;
        for axis in 0..6 {
            let mut step = Step::zeros();
            step[if axis < 3 { axis } else { axis + 3 }] = 1e-6;
            let slope = (direction(&component.stepped(&step).pose)
                - direction(&component.stepped(&-step).pose))
                / 2e-6;
            assert!((slope - told.column(axis)).norm() < 1e-8);
        }
    }
}

/// The covariance of a prediction is that of predicted draws, the camera's turn and how much faster it became among what is drawn.
#[test]
fn a_prediction_spreads_as_its_draws_do() {
    let mut rng = Pcg64::new(2, 1);
    let settings = Settings {
        acceleration: 1e-3,
        yaw_rate_sigma_rad_s: 1e-5,
        tilt_time_s: 500.0,
        ..Settings::default()
    };
    let before =
        Component { covariance: any_component(&mut rng).covariance * 1e-4, ..any_component(&mut rng) };
    let by_m_s = Vector3::new(0.5, -0.2, 0.9);
    let motion = |turn: Rotation3<f64>, by_m_s: Vector3<f64>, [sigma_rad, sigma_m_s]: [f64; 2]| Motion {
        interval_s: 0.4,
        turn: Turn { now_from_before: turn, sigma_rad, ..Turn::none(Vector3::zeros()) },
        faster: Some(Faster { by_m_s, sigma_m_s }),
        up: None,
        tilt_sigma_rad: 0.01,
    };
    let turn = Rotation3::new(Vector3::new(0.1, -0.4, 0.2));
    let told = motion(turn, by_m_s, [2e-3, 0.05]).predict(&before, &settings);
    let root = before.covariance.cholesky().unwrap().l();
    let mut square = Covariance::zeros();
    let draws = 20_000;
    for _ in 0..draws {
        let drawn = before.stepped(&(root * Step::from_fn(|_, _| normal(&mut rng))));
        let turned = Rotation3::new(normal3(&mut rng) * 2e-3) * turn;
        let faster_m_s = by_m_s + normal3(&mut rng) * 0.05;
        let off = told.step_to(&motion(turned, faster_m_s, [0.0; 2]).predict(&drawn, &settings));
        square += off * off.transpose() / f64::from(draws);
    }
    for axis in 0..SIZE {
        let ratio = square[(axis, axis)] / told.covariance[(axis, axis)];
        assert!((ratio - 1.0).abs() < 0.05, "axis {axis}: {ratio}");
    }
}

#[test]
fn joint_probabilities_are_those_of_all_ways_listed() {
    let mut rng = Pcg64::new(3, 1);
    let mut joint = Joint::default();
    let bits = Uniform::new(1u128, 64).unwrap();
    for _ in 0..200 {
        let vehicles = 3;
        let choices: Vec<Choice> = (0..9)
            .map(|index| Choice {
                vehicle: index / 3,
                spots: bits.sample(&mut rng) & bits.sample(&mut rng),
                log_weight: 2.0 * normal(&mut rng),
                way: index,
            })
            .filter(|choice| choice.spots != 0)
            .collect();
        let log_unseen: Vec<f64> = (0..vehicles).map(|_| normal(&mut rng)).collect();
        joint.explain(&choices, &log_unseen, Association::Joint);
        let (mut total, mut sums) = (0.0, vec![0.0; choices.len()]);
        let of = |vehicle: usize| {
            let own = choices.iter().enumerate().filter(move |(_, choice)| choice.vehicle == vehicle);
            own.map(|(index, _)| Some(index)).chain([None])
        };
        for way in of(0).flat_map(|a| of(1).flat_map(move |b| of(2).map(move |c| [a, b, c]))) {
            let spots: Vec<u128> = way.iter().flatten().map(|&index| choices[index].spots).collect();
            let shares = (0..spots.len()).any(|a| (0..a).any(|b| spots[a] & spots[b] != 0));
            if shares {
                continue;
            }
            let log_weight = |(vehicle, index): (usize, &Option<usize>)| {
                index.map_or(log_unseen[vehicle], |index| choices[index].log_weight)
            };
            let weight = libm::exp(way.iter().enumerate().map(log_weight).sum());
            total += weight;
            way.iter().flatten().for_each(|&index| sums[index] += weight);
        }
        for (told, sum) in joint.probability.iter().zip(&sums) {
            assert!((told - sum / total).abs() < 1e-12, "{told} {}", sum / total);
        }
    }
}

#[test]
fn over_a_straight_yaw_a_marker_leaves_its_tangent_by_a_third_of_its_sigma() {
    for (radius_m, sigma_m) in [(0.245, 0.01), (0.4, 0.02), (1.0, 0.05)] {
        let yaw_rad = straight_rad(radius_m, sigma_m);
        let off_m = radius_m * (1.0 - libm::cos(yaw_rad));
        assert!((off_m - sigma_m / 3.0).abs() < 0.01 * sigma_m, "{yaw_rad}: {off_m} of {sigma_m}");
    }
    // Exact places, none at all, and LEDs that all sit on the axis.
    for (radius_m, sigma_m, expected) in [(0.4, 0.0, 0.06), (0.4, 1.0, 0.25), (0.0, 0.01, 0.25)] {
        assert!((straight_rad(radius_m, sigma_m) - expected).abs() < 1e-12);
    }
}

/// Over so wide a yaw valleys are straight here, rad.
const STRAIGHT_RAD: f64 = 0.06;

#[test]
fn what_is_split_and_reduced_has_the_moments_of_the_whole() {
    let mut rng = Pcg64::new(4, 1);
    for spread in [0.01, 0.1, 0.4] {
        let mut whole = any_component(&mut rng);
        whole.covariance *= spread * spread / whole.covariance[(8, 8)];
        let mut parts = Vec::new();
        split(&whole, STRAIGHT_RAD, &mut parts);
        assert_eq!(parts.len() > 1, spread > STRAIGHT_RAD);
        assert!(parts.iter().all(|part| part.covariance.cholesky().is_some()));
        let one = merged(parts.iter()).unwrap();
        assert!((one.weight - 1.0).abs() < 1e-12 && whole.step_to(&one).norm() < 1e-9);
        assert!((one.covariance - whole.covariance).norm() < 0.02 * whole.covariance.norm());
        reduce(&mut parts, STRAIGHT_RAD);
        let reduced = merged(parts.iter()).unwrap();
        assert!((reduced.covariance - whole.covariance).norm() < 0.1 * whole.covariance.norm());
    }
}
