//! Whatever the spots and whatever is believed: no panic, and what is told has a meaning.
//!
//! Spots, observations, bearings and points that are finite and nothing else: anywhere, of any light and covariance, blinking
//! any signal, some of them twice, for airframes of two LEDs and more. Checked: every number that leaves is finite (but for
//! the far bound), covariances are symmetric and not negative, weights add up to 1, estimates lie within their bounds. Not
//! checked: that they are right.

mod airframes;
mod any;
mod closed_forms;
mod estimator;
mod locator;
mod meaning;

use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};

/// Most spots of one frame.
const MOST_SPOTS: usize = 9;

/// The same cases in every run.
fn runner(cases: u32) -> TestRunner {
    let config = Config { cases, failure_persistence: None, ..Config::default() };
    TestRunner::new_with_rng(config, TestRng::deterministic_rng(RngAlgorithm::ChaCha))
}
