//! LEDs that do not shine as their airframe's file says: as far as frames tell.

use super::*;
use crate::airframe::{Led, Lobe};

/// The mean of what a locator believes of how many times as much as supposed the light of LEDs spreads, over the frames after the first hundred, where each LED
/// of a hexarotor is as it is built.
fn learned(build: impl Fn(usize, &mut Led)) -> f64 {
    let mut leds = hexarotor().leds().to_vec();
    leds.iter_mut().enumerate().for_each(|(number, led)| build(number, led));
    let built = Airframe::new("built", leds).unwrap();
    let upright = |_: &mut Pcg64| Vector3::zeros();
    mean_told(&built, &level(), Pcg64::new(43, 47), upright, |_| true, |located| located.light_times.unwrap())
}

#[test]
fn frames_tell_how_far_light_is_from_what_the_airframe_says_but_never_that_it_is_nearer() {
    // Powers that spread by so many times the 0.12 of the logarithm that is supposed.
    let spread = |times: f64| {
        let normal = [0.45, -1.4, 0.9, -0.4, 1.5, -1.05];
        learned(|number, led| led.power = libm::exp(0.12 * times * normal[number]))
    };
    let [alike, as_supposed, uneven] = [0.0, 1.0, 4.0].map(spread);
    assert!((alike - 1.0).abs() < 1e-9, "{alike}");
    assert!((1.0..1.2).contains(&as_supposed), "{as_supposed}");
    // As sure as 6 lights is what is supposed, and 24 tell: these powers, 4.6 times as far apart, are 4.1 times as much.
    assert!((uneven / 4.1 - 1.0).abs() < 0.05, "{uneven}");
    let narrow = learned(|_, led| led.lobe = Lobe::Cosine { power: 2.0 });
    assert!(narrow > 2.0, "{narrow}");
}
