//! Random numbers that are functions of a seed and a place: nobody draws them in an order.

use core::f64::consts::TAU;

use crate::sensor::hash;

/// What a number is drawn for; each use has numbers of its own.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Use {
    Edge = 0x0065_6467,
    Gyro = 0x6779_726f,
    Gravity = 0x6772_6176,
    Odometry = 0x006f_646f,
    Drop = 0x6472_6f70,
    Late = 0x6c61_7465,
    Swap = 0x7377_6170,
}

/// The key of a number, for a seed, a use and a place.
pub(crate) fn key(seed: u64, what: Use, place: &[u64]) -> u64 {
    place.iter().fold(hash(seed ^ hash(what as u64)), |key, part| hash(key ^ hash(*part)))
}

/// A number from 0 to just below 1, all equally likely.
pub(crate) fn uniform(key: u64) -> f64 {
    (hash(key) >> 11) as f64 / (1_u64 << 53) as f64
}

/// A standard normal number (G. Box, M. Muller, 1958).
pub(crate) fn normal(key: u64) -> f64 {
    let above_0 = 1.0 - uniform(key);
    (-2.0 * libm::log(above_0)).sqrt() * libm::cos(TAU * uniform(!key))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_their_moments_and_uses_differ() {
        let count = 200_000;
        let mean = |f: &dyn Fn(u64) -> f64| {
            (0..count).map(|i| f(key(3, Use::Gyro, &[i, 1]))).sum::<f64>() / count as f64
        };
        assert!((mean(&uniform) - 0.5).abs() < 3e-3);
        assert!((mean(&|k| uniform(k) * uniform(k)) - 1.0 / 3.0).abs() < 3e-3);
        assert!(mean(&normal).abs() < 0.01);
        assert!((mean(&|k| normal(k) * normal(k)) - 1.0).abs() < 0.015);
        assert!((mean(&|k| libm::pow(normal(k), 4.0)) - 3.0).abs() < 0.1);
        // shares beyond one and two sigma
        assert!((mean(&|k| f64::from(normal(k).abs() > 1.0)) - 0.317_3).abs() < 5e-3);
        assert!((mean(&|k| f64::from(normal(k).abs() > 2.0)) - 0.045_5).abs() < 2e-3);
        let together = (0..count).map(|i| normal(key(3, Use::Gyro, &[i])) * normal(key(3, Use::Edge, &[i])));
        assert!((together.sum::<f64>() / count as f64).abs() < 0.01);
    }
}
