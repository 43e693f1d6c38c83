//! A calibration is as far off as it says.

mod simulation;

#[test]
fn errors_of_bearings_have_the_covariance_that_is_claimed() {
    let truth = simulation::lens();
    let seeds = 12;
    let mut sum = 0.0;
    for seed in 0..seeds {
        let calibration = simulation::calibrated(&simulation::photos(seed, 20, 0.035));
        let (normalised, off_rad) = simulation::normalised_error(calibration.camera(), &truth);
        assert!(off_rad < 2e-3, "seed {seed}: {off_rad}");
        sum += normalised / 2.0;
    }
    // a mean of one with the scatter of a dozen calibrations that have five directions to be wrong in
    let mean = sum / f64::from(u32::try_from(seeds).expect("a few"));
    assert!((0.6..1.5).contains(&mean), "{mean}");
}
