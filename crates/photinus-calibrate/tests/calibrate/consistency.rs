//! A calibration is as far off as it says.

use crate::simulation;

#[test]
fn errors_of_bearings_have_the_covariance_that_is_claimed() {
    let truth = simulation::lens();
    let seeds = 20..25_u32;
    let mut sum = 0.0;
    for seed in seeds.clone() {
        let calibration = simulation::calibrated(&simulation::photos(u64::from(seed), 20, 0.035));
        let (normalised, off_rad) = simulation::normalised_error(calibration.camera(), &truth);
        assert!(off_rad < 2e-3, "seed {seed}: {off_rad}");
        sum += normalised / 2.0;
    }
    // one photo session is wrong in one or two ways over the whole field, so that its number scatters by its own size; the example
    // `consistency` averages a hundred
    let mean = sum / seeds.len() as f64;
    assert!((0.3..2.2).contains(&mean), "{mean}");
}
