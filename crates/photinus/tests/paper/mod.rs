//! The camera and the airframes of the founding paper, and an airframe whose LEDs shine all around.

#![allow(dead_code, reason = "a test has no need of all of them")]

use std::f64::consts::FRAC_PI_2;

use photinus::airframe::{Airframe, Led, Lobe, Ring};
use photinus::camera::{Camera, Ideal, IdealLaw, Model, Pixel};

pub(crate) const WIDTH: usize = 752;
pub(crate) const HEIGHT: usize = 480;

pub(crate) fn camera() -> Camera {
    let lens =
        Ideal::new(IdealLaw::Equidistant, [1.0 / 3.7673e-3; 2], Pixel::new(375.5, 239.5)).expect("a lens");
    Camera::new(Model::Ideal(lens), WIDTH, HEIGHT, None).expect("a camera")
}

pub(crate) fn hexarotor() -> Airframe {
    let ring = Ring { arms: 6, radius_m: 0.4, leds_per_arm: 1, splay_rad: 0.0 };
    Airframe::from_ring("hexarotor", ring).expect("a ring")
}

pub(crate) fn quadrotor() -> Airframe {
    let ring = Ring { arms: 4, radius_m: 0.245, leds_per_arm: 2, splay_rad: FRAC_PI_2 };
    Airframe::from_ring("quadrotor", ring).expect("a ring")
}

/// A hexarotor whose LEDs shine all around: all six show at once.
pub(crate) fn lanterns() -> Airframe {
    let leds = hexarotor().leds().iter().map(|led| Led { lobe: Lobe::Omni, ..led.clone() }).collect();
    Airframe::new("lanterns", leds).expect("an airframe")
}
