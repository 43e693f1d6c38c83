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
const VIEWS: usize = 5;

/// What is off in a direction, if anything is. Where light alone tells the yaw the mixture is a fifth too narrow; where it is narrow in all of
/// them, this fails.
fn complaint(difference: &Difference) -> Option<String> {
    let Difference { mean_sigmas, standard_error_sigmas, sigma_ratio, variance_error, weight } = *difference;
    let spread = sigma_ratio.powi(2) - 1.0;
    let holds = mean_sigmas.abs() < 0.15 + 3.0 * standard_error_sigmas
        && (-0.35 - 3.0 * variance_error..0.15 + 3.0 * variance_error).contains(&spread)
        && weight < 0.15;
    (!holds).then(|| format!("mean off {mean_sigmas:.3} sigma, covariance {sigma_ratio:.3}^2, {weight:.3} of the weight elsewhere"))
}

#[test]
fn the_mixture_has_the_mean_the_spread_and_the_weights_of_the_posterior() {
    let (mut complaints, mut narrow) = (Vec::new(), 0);
    for airframe in [view::hexarotor(), view::quadrotor()] {
        let mut locator = view::locator(&airframe);
        let mut rng = Pcg64::new(21, 4);
        for distance_m in [5.0, 10.0] {
            for view in 0..VIEWS {
                let what = format!("{} at {distance_m} m, view {view}", airframe.name());
                let experiment = Experiment::run(&airframe, &mut locator, distance_m, STEPS, &mut rng);
                let Plane { ahead, across } = experiment.plane();
                let differences = [ahead, across].map(|axis| experiment.difference(&axis));
                for Difference { mean_sigmas, sigma_ratio, weight, .. } in &differences {
                    println!("{what}: mean {mean_sigmas:+.3}, sigma {sigma_ratio:.3}, weight {weight:.3}");
                }
                narrow += differences.iter().filter(|difference| difference.sigma_ratio < 0.9).count();
                let mut own: Vec<String> = differences.iter().filter_map(complaint).collect();
                if experiment.rest.iter().any(|&rest| rest > 0.02) {
                    own.push(format!("{:?} at other distances", experiment.rest));
                }
                complaints.extend((!own.is_empty()).then(|| format!("{what}: {}", own.join("; "))));
            }
        }
    }
    // One view in twenty lacks a mode.
    assert!(complaints.len() <= 1, "{complaints:#?}");
    assert!(narrow <= 4 * VIEWS / 2, "{narrow} of {} directions too narrow", 8 * VIEWS);
}
