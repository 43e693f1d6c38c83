//! Airframes of many kinds.

use std::f64::consts::FRAC_PI_2;

use nalgebra::{Unit, Vector3};
use photinus::airframe::{Airframe, Led, Lobe, Ring};

fn led(position_m: [f64; 3], axis: [f64; 3], lobe: Lobe) -> Led {
    let axis = Unit::new_normalize(Vector3::from(axis));
    Led { position_m: Vector3::from(position_m), axis, lobe, power: 1.0, signal: None }
}

fn ring(arms: usize, leds_per_arm: usize, splay_rad: f64) -> Vec<Led> {
    let ring = Ring { arms, radius_m: 0.3, leds_per_arm, splay_rad };
    Airframe::from_ring("ring", ring).expect("a ring").leds().to_vec()
}

/// A hexarotor, the same with signals, a quadrotor, lanterns, LEDs on the axis, a pair, and three that are far apart and near.
pub(crate) fn airframes() -> Vec<Airframe> {
    let hexarotor = ring(6, 1, 0.0);
    let signalled =
        (0..).zip(&hexarotor).map(|(signal, led)| Led { signal: Some(signal % 3), ..led.clone() }).collect();
    let lanterns = hexarotor.iter().map(|led| Led { lobe: Lobe::Omni, ..led.clone() }).collect();
    let mast =
        (0..3).map(|level| led([0.0, 0.0, 0.2 * f64::from(level)], [0.0, 0.0, 1.0], Lobe::Omni)).collect();
    let pair = [0.2, -0.2].map(|y| led([0.0, y, 0.0], [1.0, 0.0, 0.0], Lobe::Lambertian)).to_vec();
    let uneven = vec![
        led([0.0; 3], [0.0, 0.0, -1.0], Lobe::Lambertian),
        led([9.0, -2.0, 4.0], [0.6, 0.0, 0.8], Lobe::Omni),
        led([0.03, 0.0, 0.0], [1.0, 0.0, 0.0], Lobe::Lambertian),
    ];
    [hexarotor, signalled, ring(4, 2, FRAC_PI_2), lanterns, mast, pair, uneven]
        .into_iter()
        .map(|leds| Airframe::new("any", leds).expect("an airframe"))
        .collect()
}
