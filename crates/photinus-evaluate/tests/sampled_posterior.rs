//! The reported mixture agrees with samples of the posterior that it stands for, in views of two markers: the example of the
//! same name with a shorter walk, held to limits.

#[path = "../examples/sampled_posterior/chain.rs"]
mod chain;
#[path = "../examples/sampled_posterior/compare.rs"]
mod compare;
#[path = "../examples/sampled_posterior/experiment.rs"]
mod experiment;
#[path = "../examples/sampled_posterior/model.rs"]
mod model;
#[path = "../examples/pose_accuracy/view.rs"]
#[allow(dead_code, reason = "bounds of accuracy are for the other example")]
mod neighbour;
#[path = "../examples/sampled_posterior/view.rs"]
mod view;

use rand_pcg::Pcg64;

use compare::Difference;
use experiment::{Experiment, Plane};

const STEPS: usize = 400_000;

#[test]
fn the_mixture_has_the_mean_the_spread_and_the_weights_of_the_posterior() {
    for airframe in [view::hexarotor(), view::quadrotor()] {
        let mut locator = view::locator(&airframe);
        let mut rng = Pcg64::new(21, 4);
        for distance_m in [5.0, 10.0] {
            let experiment = Experiment::run(&airframe, &mut locator, distance_m, STEPS, &mut rng);
            let Plane { ahead, across } = experiment.plane();
            for (name, axis) in [("along", ahead), ("across", across)] {
                let Difference { mean_sigmas, standard_error_sigmas, sigma_ratio, variance_error, weight } =
                    experiment.difference(&axis);
                let what = format!("{} at {distance_m} m, {name}", airframe.name());
                println!(
                    "{what}: mean {mean_sigmas:+.3} ({standard_error_sigmas:.3}), sigma {sigma_ratio:.3} ({variance_error:.3}), weight {weight:.3}"
                );
                assert!(
                    mean_sigmas.abs() < 0.1 + 3.0 * standard_error_sigmas,
                    "{what}: mean off {mean_sigmas} sigma"
                );
                assert!(
                    (sigma_ratio.powi(2) - 1.0).abs() < 0.15 + 3.0 * variance_error,
                    "{what}: covariance {sigma_ratio}^2 ({variance_error})"
                );
                assert!(weight < 0.1, "{what}: {weight} of the weight elsewhere");
            }
            assert!(
                experiment.rest.iter().all(|&rest| rest < 0.02),
                "{:?} at other distances",
                experiment.rest
            );
        }
    }
}
