//! What must hold for any truth: perfect results score perfectly, order says nothing, less is never better.

use nalgebra::{Matrix3, Vector3};
use photinus_io::dataset::TruthFrame;
use photinus_io::results::{Distance, FrameRecord, NeighbourRecord};
use proptest::prelude::*;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;

use crate::hand_made::{found_at, record, shining, spot, there, truth};
use crate::{EvaluateError, Scores, Settings, Side, evaluate};

/// Up to four neighbours in a frame, in directions that stay apart, each with two LEDs.
fn any_truth() -> impl Strategy<Value = Vec<TruthFrame>> {
    let neighbour = (0.5..30.0f64, -0.1..0.1f64);
    let frame = proptest::collection::vec(neighbour, 1..5);
    proptest::collection::vec(frame, 2..6).prop_map(|frames| {
        let neighbours = |frame: Vec<(f64, f64)>| {
            let apart = frame.into_iter().zip(0u32..).map(|((distance_m, aside), id)| {
                let (sin, cos) = libm::sincos(1.5 * f64::from(id) + aside);
                let u_px = 100.0 * f64::from(id) + 20.0;
                shining(id, [distance_m * sin, 0.0, distance_m * cos], &[[u_px, 50.0], [u_px + 9.0, 50.5]])
            });
            apart.collect()
        };
        frames.into_iter().zip(0..).map(|(frame, number)| truth(number, neighbours(frame))).collect()
    })
}

/// What a perfect program would report.
fn perfect(truth: &[TruthFrame]) -> Vec<FrameRecord> {
    let of_frame = |frame: &TruthFrame| {
        let (mut spots, mut neighbours) = (Vec::new(), Vec::new());
        for there in &frame.neighbours {
            let first = spots.len();
            spots.extend(there.leds.iter().map(|led| spot(led.u_px, led.v_px, 4)));
            let distance_m = Distance {
                estimate: Some(there.distance_m),
                sigma: Some(0.1),
                min: there.distance_m,
                max: Some(there.distance_m),
                perpendicular: Some(there.distance_m),
                inline: Some(there.distance_m),
            };
            neighbours.push(NeighbourRecord {
                track: Some(u64::from(there.id)),
                id: Some(there.id),
                spots: (first..spots.len()).collect(),
                distance_m,
                ..found_at(there.position_m)
            });
        }
        record(frame.frame, spots, neighbours)
    };
    truth.iter().map(of_frame).collect()
}

fn scores(truth: &[TruthFrame], results: &[FrameRecord]) -> Scores {
    evaluate(truth, results, &Settings::default()).unwrap().scores
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn perfect_results_score_perfectly(truth in any_truth()) {
        let scores = scores(&truth, &perfect(&truth));
        let spots = scores.spots.unwrap().by_range.overall;
        prop_assert_eq!((spots.recall, spots.precision, spots.merged), (Some(1.0), Some(1.0), 0));
        prop_assert_eq!((spots.centroid_error_px.max, spots.centroid_nees), (Some(0.0), Some(0.0)));
        let neighbours = scores.neighbours;
        let all = neighbours.by_range.overall;
        prop_assert_eq!((all.recall, all.precision), (Some(1.0), Some(1.0)));
        prop_assert_eq!((neighbours.merged, neighbours.split), (0, 0));
        prop_assert!(scores.bearing_error_rad.overall.max.unwrap() < 1e-15);
        prop_assert_eq!(scores.distance.overall.error_m.max, Some(0.0));
        prop_assert_eq!(scores.bounds.by_range.overall.coverage, Some(1.0));
        prop_assert!(scores.bounds.violations.is_empty());
        let consistency = scores.position.overall.consistency;
        prop_assert_eq!((consistency.nees, consistency.inside_95), (Some(0.0), Some(1.0)));
        prop_assert_eq!(scores.paper.overall.between, Some(1.0));
        prop_assert_eq!(scores.identity.unwrap().accuracy, Some(1.0));
        let tracks = scores.tracks.unwrap();
        prop_assert_eq!((tracks.switches, tracks.false_tracks), (0, 0));
    }

    #[test]
    fn the_order_of_neighbours_and_frames_says_nothing(truth in any_truth(), shift_m in 0.01..0.3f64) {
        let mut results = perfect(&truth);
        for neighbour in results.iter_mut().flat_map(|frame| &mut frame.neighbours) {
            neighbour.distance_m.estimate = neighbour.distance_m.estimate.map(|distance_m| distance_m + shift_m);
        }
        let before = scores(&truth, &results);
        for frame in &mut results {
            frame.neighbours.reverse();
        }
        results.reverse();
        prop_assert_eq!(before, scores(&truth, &results));
    }

    #[test]
    fn a_dropped_frame_lowers_recall_and_a_made_up_neighbour_precision(
        truth in any_truth(),
        which in any::<proptest::sample::Index>(),
    ) {
        let results = perfect(&truth);
        let mut fewer = results.clone();
        fewer.remove(which.index(results.len()));
        let dropped = scores(&truth, &fewer);
        prop_assert!(dropped.neighbours.by_range.overall.recall < Some(1.0));
        prop_assert!(dropped.spots.unwrap().by_range.overall.recall < Some(1.0));
        prop_assert_eq!(dropped.frames.missing, 1);

        let mut more = results;
        let index = which.index(more.len());
        more[index].neighbours.push(found_at([0.0, -3.0, 0.1]));
        more[index].spots.push(spot(700.0, 400.0, 4));
        let made_up = scores(&truth, &more);
        prop_assert!(made_up.neighbours.by_range.overall.precision < Some(1.0));
        prop_assert!(made_up.spots.unwrap().by_range.overall.precision < Some(1.0));
    }
}

#[test]
fn gaussian_errors_have_the_nees_of_their_covariance() {
    let mut random = Pcg64Mcg::new(7);
    let mut normal = || -> f64 { StandardNormal.sample(&mut random) };
    // Long along the line of sight, as distances are less sure than bearings.
    let root = Matrix3::new(0.10, 0.0, 0.0, 0.03, 0.05, 0.0, 0.2, -0.3, 0.9);
    let covariance_m2: [[f64; 3]; 3] = (root * root.transpose()).into();
    let (mut truths, mut results) = (Vec::new(), Vec::new());
    for frame in 0..5000 {
        let position_m = Vector3::new(0.2 * normal(), 0.2 * normal(), 10.0 + normal());
        let reported_m = position_m + root * Vector3::new(normal(), normal(), normal());
        truths.push(truth(frame, vec![there(1, position_m.into())]));
        let found = found_at(reported_m.into());
        results.push(record(
            frame,
            vec![],
            vec![NeighbourRecord { position_covariance_m2: Some(covariance_m2), ..found }],
        ));
    }
    let position = scores(&truths, &results).position.overall.consistency;
    assert_eq!(position.with_covariance, 5000, "the gate keeps every one");
    let (nees, standard_error) = (position.nees.unwrap(), position.nees_standard_error.unwrap());
    assert!((nees - 3.0).abs() < 2.5 * standard_error, "{nees} +- {standard_error}");
    assert!((standard_error - 0.0346).abs() < 1e-4);
    let sigma_of_share = (0.95 * 0.05 / 5000f64).sqrt();
    let inside_95 = position.inside_95.unwrap();
    assert!((inside_95 - 0.95).abs() < 2.5 * sigma_of_share, "{inside_95}");
    let inside_50 = position.inside_50.unwrap();
    assert!((inside_50 - 0.5).abs() < 2.5 * 0.5 / 5000f64.sqrt(), "{inside_50}");
}

#[test]
fn what_cannot_be_compared_is_refused() {
    let one = [truth(3, vec![there(1, [0.0, 0.0, 5.0])])];
    let found = |frame| record(frame, vec![], vec![]);
    let refused = |truth: &[TruthFrame], results: &[FrameRecord]| {
        evaluate(truth, results, &Settings::default()).unwrap_err()
    };
    assert_eq!(refused(&[], &[found(3)]), EvaluateError::Empty(Side::Truth));
    assert_eq!(refused(&one, &[]), EvaluateError::Empty(Side::Results));
    let elsewhere = EvaluateError::NothingInCommon { truth: (3, 3), results: (7, 9) };
    assert_eq!(refused(&one, &[found(7), found(9)]), elsewhere);
    assert_eq!(refused(&one, &[found(3), found(3)]), EvaluateError::RepeatedFrame(3, Side::Results));
    let late = FrameRecord { time_s: Some(0.4), ..found(3) };
    assert!(matches!(refused(&one, &[late]), EvaluateError::Time { frame: 3, .. }));
    let twice = [truth(3, vec![there(1, [0.0, 0.0, 5.0]), there(1, [0.0, 0.0, 6.0])])];
    assert_eq!(refused(&twice, &[found(3)]), EvaluateError::RepeatedNeighbour(3, 1));
    let mut wrong = one.clone();
    for distance_m in [-5.0, 0.0, 6.0, f64::NAN] {
        wrong[0].neighbours[0].distance_m = distance_m;
        assert!(matches!(refused(&wrong, &[found(3)]), EvaluateError::Distance { id: 1, .. }));
    }
    wrong[0].neighbours[0].position_m = [f64::INFINITY, 0.0, 0.0];
    wrong[0].neighbours[0].distance_m = f64::INFINITY;
    assert!(matches!(refused(&wrong, &[found(3)]), EvaluateError::Distance { .. }));
}

#[test]
fn numbers_that_are_none_hurt_nobody() {
    let truths = [truth(0, vec![shining(1, [0.0, 0.0, 5.0], &[[f64::MAX, -1e300]])])];
    let nothing = [[f64::NAN; 3]; 3];
    let found = NeighbourRecord {
        bearing: [1e-320, 0.0, 1e300],
        spots: vec![usize::MAX],
        position_m: Some([1e308; 3]),
        position_covariance_m2: Some(nothing),
        distance_m: Distance {
            estimate: Some(-1.0),
            sigma: Some(0.0),
            min: f64::NAN,
            max: Some(f64::NEG_INFINITY),
            perpendicular: Some(f64::INFINITY),
            inline: None,
        },
        ..found_at([0.0, 0.0, 5.0])
    };
    let scores = scores(&truths, &[record(0, vec![], vec![found])]);
    assert_eq!(scores.position.overall.consistency.with_covariance, 0);
    assert!(serde_json::to_string(&scores).is_ok());
}
