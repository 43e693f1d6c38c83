//! Wind: a mean, and gusts that every vehicle meets for itself.
//!
//! Gusts are an Ornstein-Uhlenbeck process along each axis: the simplest whose spectrum falls like that of Dryden's model. Vehicles a few metres apart
//! meet much the same air in nature; here their gusts have a share in common.

use nalgebra::Vector3;

use crate::chance::{Chance, Use};

/// How the air moves.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wind {
    /// On the mean, in the world, m/s.
    pub mean_m_s: Vector3<f64>,
    /// Gusts along each axis, sigma, m/s.
    pub gust_m_s: f64,
    /// For how long a gust lasts, s.
    pub gust_s: f64,
    /// The share of the gusts' power that all vehicles meet at once, 0 to 1.
    pub common: f64,
}

/// The air about every vehicle.
#[derive(Clone, Debug)]
pub struct WindField {
    wind: Wind,
    common: Gust,
    own: Vec<Gust>,
}

#[derive(Clone, Debug)]
struct Gust {
    chance: Chance,
    unit: Vector3<f64>,
}

impl Gust {
    fn new(mut chance: Chance) -> Self {
        Self { unit: chance.normals(), chance }
    }

    fn step(&mut self, keeps: f64) {
        self.unit = self.unit * keeps + self.chance.normals() * (1.0 - keeps * keeps).sqrt();
    }
}

impl WindField {
    /// Air about this many vehicles.
    pub fn new(wind: Wind, vehicles: usize, seed: u64) -> Self {
        let gust = |owner: usize| Gust::new(Chance::new(seed, Use::Wind, owner as u64));
        Self { wind, common: gust(usize::MAX), own: (0..vehicles).map(gust).collect() }
    }

    /// Lets time pass.
    pub fn step(&mut self, step_s: f64) {
        if self.wind.gust_m_s <= 0.0 {
            return;
        }
        let keeps = libm::exp(-step_s / self.wind.gust_s);
        self.common.step(keeps);
        self.own.iter_mut().for_each(|gust| gust.step(keeps));
    }

    /// How the air about a vehicle moves, m/s.
    pub fn at(&self, vehicle: usize) -> Vector3<f64> {
        let own = self.own[vehicle].unit * (1.0 - self.wind.common).sqrt();
        self.wind.mean_m_s + (self.common.unit * self.wind.common.sqrt() + own) * self.wind.gust_m_s
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gusts_have_their_sigma_their_length_and_their_common_share() {
        let wind = Wind { mean_m_s: Vector3::new(3.0, 0.0, 0.0), gust_m_s: 1.5, gust_s: 2.0, common: 0.6 };
        let mut field = WindField::new(wind, 2, 7);
        let steps = 400_000;
        let (mut square, mut cross, mut mean, mut late) = (0.0, 0.0, Vector3::zeros(), 0.0);
        let mut before = Vec::new();
        for step in 0..steps {
            field.step(0.05);
            let [a, b] = [0, 1].map(|vehicle| field.at(vehicle) - wind.mean_m_s);
            mean += field.at(0) / f64::from(steps);
            square += a.norm_squared() / 3.0 / f64::from(steps);
            cross += a.dot(&b) / 3.0 / f64::from(steps);
            before.push(a.x);
            // 2 s are 40 steps
            if step >= 40 {
                late += a.x * before[step as usize - 40] / f64::from(steps);
            }
        }
        assert!((mean - wind.mean_m_s).norm() < 0.1, "{mean}");
        assert!((square / 2.25 - 1.0).abs() < 0.05, "{square}");
        assert!((cross / square - 0.6).abs() < 0.05, "{}", cross / square);
        assert!((late / square - libm::exp(-1.0)).abs() < 0.05, "{}", late / square);
    }
}
