//! Any observations of one neighbour, any hypotheses about it.

use std::cell::RefCell;

use nalgebra::{Matrix3, Rotation3, Vector3};
use photinus::camera::Bearing;
use photinus::pose::{self, Estimator, Hypotheses, Known, LogDistance, LogLight, Observation, Pose, Visible};
use photinus::ranging::Interval;
use proptest::prelude::*;
use proptest::sample::Index;

use crate::airframes::airframes;
use crate::any::{direction, finite, scale, signal, up, with_twins};
use crate::meaning::{FARTHEST_M, check_modes, check_told};
use crate::{MOST_SPOTS, runner};

/// What rounding may take from a covariance: variances from 1e-12 to 10 rad^2 stand side by side.
const SHARE: f64 = 1e-3;

/// Any symmetric matrix, a sensible one, or none.
fn covariance3() -> impl Strategy<Value = Matrix3<f64>> {
    let sensible = (scale(-5.0..-1.0), prop::array::uniform9(-1.0f64..1.0)).prop_map(|(sigma, n)| {
        let root = Matrix3::from_row_slice(&n) * sigma;
        root * root.transpose()
    });
    let any = prop::array::uniform6(finite())
        .prop_map(|[a, b, c, d, e, f]| Matrix3::new(a, b, c, b, d, e, c, e, f));
    prop_oneof![4 => sensible, 1 => Just(Matrix3::zeros()), 1 => any]
}

fn log_light() -> impl Strategy<Value = Option<LogLight>> {
    let ordinary = (2.0f64..9.0, 0.0f64..0.5);
    let any = (finite(), finite());
    prop::option::of(
        prop_oneof![3 => ordinary, 1 => any].prop_map(|(value, sigma)| LogLight { value, sigma }),
    )
}

fn observation() -> impl Strategy<Value = Observation> {
    let near = prop::array::uniform2(-0.3f64..0.3)
        .prop_filter_map("a direction", |[x, y]| Bearing::new(Vector3::new(x, y, 1.0)));
    let bearing = prop_oneof![3 => near, 1 => direction()];
    (bearing, covariance3(), log_light(), prop_oneof![Just(0.0), scale(-5.0..2.0)], signal()).prop_map(
        |(bearing, covariance_rad2, log_light, resolution_rad, signal)| Observation {
            bearing,
            covariance_rad2,
            log_light,
            resolution_rad,
            signal,
            clutter_log_density: 0.0,
        },
    )
}

fn interval() -> impl Strategy<Value = Interval> {
    let ends = (
        prop_oneof![Just(0.0), scale(-3.0..3.0)],
        prop_oneof![Just(0.0), scale(-9.0..4.0), Just(f64::INFINITY)],
    );
    ends.prop_filter_map("an interval", |(min_m, width_m)| Interval::new(min_m, min_m + width_m))
}

fn known() -> impl Strategy<Value = Known<'static>> {
    let size = prop::option::of(
        (-2.0f64..6.0, scale(-4.0..2.0)).prop_map(|(mean, sigma)| LogDistance { mean, sigma }),
    );
    (up(), interval(), size, log_light(), log_light()).prop_map(
        |(up, bounds, size, power, detection_limit)| {
            let visible = Visible { detection_limit, ..Visible::default() };
            Known { up, bounds, size, power, tilt_sigma_rad: None, unit_sigma: None, visible }
        },
    )
}

/// All that pass the check.
fn settings() -> impl Strategy<Value = pose::Settings> {
    let tilt = prop_oneof![Just(0.07), Just(1e-4), Just(3.2)];
    let marker = prop_oneof![Just(0.001), Just(0.0), Just(1.0)];
    let unit = prop_oneof![Just(0.12), Just(1e-3), Just(10.0)];
    let missed = prop_oneof![Just(1e-3), Just(1e-9), Just(0.5)];
    let lobe = prop_oneof![Just(0.02), Just(0.0), Just(1.0)];
    (tilt, marker, unit, lobe, missed, any::<bool>()).prop_map(
        |(tilt_sigma_rad, marker_sigma_m, unit_sigma, lobe_sigma, missed, use_brightness)| {
            let mut settings = pose::Settings::default();
            settings.tilt_sigma_rad = tilt_sigma_rad;
            settings.marker_sigma_m = marker_sigma_m;
            settings.scale_sigma = 0.01;
            settings.unit_sigma = unit_sigma;
            settings.lobe_sigma = lobe_sigma;
            settings.missed = missed;
            settings.use_brightness = use_brightness;
            settings
        },
    )
}

/// A guess of the pose, and which marker each spot may be; `None` for a guess without an assignment.
type Guess = (Pose, Option<Vec<Option<Index>>>);

fn guess() -> impl Strategy<Value = Guess> {
    let away =
        (direction(), scale(-4.0..0.0)).prop_map(|(bearing, share)| bearing.vector() * (FARTHEST_M * share));
    let pose = (away, prop::array::uniform3(-3.0f64..3.0)).prop_map(|(position_m, turn)| Pose {
        position_m,
        camera_from_body: Rotation3::new(Vector3::from(turn)),
    });
    let markers = prop::collection::vec(prop::option::weighted(0.9, any::<Index>()), MOST_SPOTS);
    (pose, prop::option::of(markers))
}

#[test]
fn an_estimator_tells_numbers_or_nothing() {
    let airframes = airframes();
    let inputs = (
        (any::<Index>(), settings(), known()),
        with_twins(observation(), MOST_SPOTS),
        prop::collection::vec((guess(), 0.0f64..20.0), 1..20),
    );
    let told = RefCell::new([0; 2]);
    let outcome = runner(1500).run(&inputs, |((airframe, settings, known), observations, guesses)| {
        let airframe = airframe.get(&airframes);
        let mut estimator = Estimator::new(airframe, settings).expect("settings that pass the check");
        let mut hypotheses = Hypotheses::with_room(observations.len());
        hypotheses.begin(observations.len());
        for ((pose, markers), nats) in guesses {
            let Some(markers) = markers else {
                hypotheses.offer_loose(pose, nats);
                continue;
            };
            let marker = |index: &Index| index.index(airframe.markers().len()) as u16;
            let markers: Vec<Option<u16>> =
                markers[..observations.len()].iter().map(|index| index.as_ref().map(marker)).collect();
            hypotheses.offer(&markers, nats, 0, || pose);
        }
        let posterior = estimator.estimate(&observations, &mut hypotheses, &known);
        prop_assert!(!posterior.log_evidence.is_nan());
        let Some(summary) = &posterior.summary else {
            prop_assert!(posterior.modes.is_empty());
            told.borrow_mut()[0] += 1;
            return Ok(());
        };
        told.borrow_mut()[1] += 1;
        prop_assert!(posterior.worst_sigma.is_finite() && posterior.worst_sigma >= 0.0);
        prop_assert_eq!(posterior.markers.len(), observations.len());
        prop_assert!(summary.distance.distance_m.is_finite() && summary.distance.sigma_m.is_finite());
        check_told(
            &summary.pose,
            &summary.position_covariance_m2,
            &summary.orientation_covariance_rad2,
            SHARE,
        )?;
        check_modes(&posterior.modes, SHARE)
    });
    let [nothing, something] = told.into_inner();
    println!("nothing told {nothing} times, a pose {something} times");
    outcome.unwrap_or_else(|error| panic!("{error}"));
    assert!(something > nothing, "{something} poses, {nothing} times none");
}
