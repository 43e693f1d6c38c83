//! Neighbours that tilt, or a known gravity that is wrong: as far as frames tell.

use super::*;

/// The mean of what a locator believes of tilts, rad, over the frames after the first hundred, where vehicles tilt so far along each axis and gravity is so far
/// from what it is told to be.
fn learned(tilt_sigma_rad: f64, gravity_off_rad: f64) -> f64 {
    let down = Rotation3::from_axis_angle(&Vector3::z_axis(), gravity_off_rad) * level();
    let tilt = |rng: &mut Pcg64| {
        let [x, z] = [(); 2].map(|()| -> f64 { StandardNormal.sample(rng) });
        Vector3::new(x, 0.0, z) * tilt_sigma_rad
    };
    mean_told(
        &hexarotor(),
        &down,
        Pcg64::new(37, 41),
        tilt,
        |_| true,
        |located| located.tilt_sigma_rad.unwrap(),
    )
}

#[test]
fn frames_tell_how_far_neighbours_tilt_but_never_that_they_cannot() {
    let supposed_rad = pose::Settings::default().tilt_sigma_rad;
    let [upright_rad, as_supposed_rad, steep_rad] =
        [0.2, 1.0, 3.0].map(|times| learned(times * supposed_rad, 0.0));
    assert!((upright_rad / supposed_rad - 1.0).abs() < 1e-9, "{upright_rad}");
    assert!((1.0..1.15).contains(&(as_supposed_rad / supposed_rad)), "{as_supposed_rad}");
    // As sure as 6 tilts is what is supposed, and 24 tell: three times as much is 2.7 times as much.
    assert!((2.4..2.9).contains(&(steep_rad / supposed_rad)), "{steep_rad}");
}

#[test]
fn a_gravity_that_is_wrong_is_a_tilt_of_all() {
    // Of 0.35 rad along one of two axes, with the 0.05 of the vehicles, 0.25 rad; 0.23 with what is supposed.
    let told_rad = learned(0.05, 0.35);
    assert!((0.2..0.26).contains(&told_rad), "{told_rad}");
}
