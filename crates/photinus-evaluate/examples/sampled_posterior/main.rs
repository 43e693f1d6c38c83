//! The reported mixture of poses against samples of the posterior that it stands for, where two markers leave much open.
//!
//! `cargo run --release -p photinus-evaluate --example sampled_posterior [picture.svg]`
//!
//! A plain Metropolis walk over a density that is written down anew from its description. For each view and direction: how
//! far the mean is from that of the samples, in standard deviations of the posterior; the ratio of the standard deviations, and how sure that of the samples is (of the variance);
//! the largest difference of the weight below a cut.

#![expect(clippy::print_stdout, reason = "an example prints its table")]

mod chain;
mod compare;
mod experiment;
mod model;
#[path = "../pose_accuracy/view.rs"]
#[allow(dead_code, reason = "bounds of accuracy are for the other example")]
mod neighbour;
mod picture;
mod view;

use photinus_io::Result;
use rand_pcg::Pcg64;

use compare::Difference;
use experiment::{Experiment, Plane};

const STEPS: usize = 2_000_000;
const VIEWS: usize = 4;

fn main() -> Result<()> {
    println!(
        "                           along the line of sight                  across it                          weight elsewhere"
    );
    println!(
        "airframe   range  view   mean (error)  sigma (error)  weight   mean (error)  sigma (error)  weight   samples  modes"
    );
    let mut drawn = Vec::new();
    for airframe in [view::hexarotor(), view::quadrotor()] {
        let mut locator = view::locator(&airframe);
        let mut rng = Pcg64::new(21, 4);
        for distance_m in [5.0, 10.0] {
            for number in 0..VIEWS {
                let experiment = Experiment::run(&airframe, &mut locator, distance_m, STEPS, &mut rng);
                let Plane { ahead, across } = experiment.plane();
                let [along, across] = [ahead, across].map(|axis| columns(&experiment.difference(&axis)));
                let [samples, modes] = experiment.rest;
                println!(
                    "{:9} {distance_m:4.0} m  {number:4} {along} {across} {samples:9.4} {modes:7.4}",
                    airframe.name()
                );
                if number == 0 {
                    drawn.push((format!("{}, {distance_m} m", airframe.name()), experiment));
                }
            }
        }
    }
    match std::env::args().nth(1) {
        Some(file) => picture::draw(file.as_ref(), &drawn),
        None => Ok(()),
    }
}

fn columns(difference: &Difference) -> String {
    let Difference { mean_sigmas, standard_error_sigmas, sigma_ratio, variance_error, weight } = difference;
    format!(
        "{mean_sigmas:+7.3} ({standard_error_sigmas:.3}) {sigma_ratio:6.3} ({variance_error:.3}) {weight:7.3}"
    )
}
