//! What is wrong with the LEDs of one vehicle: unequal, weak, dead, not where the drawing has them.

use nalgebra::Vector3;
use photinus::airframe::{Airframe, AirframeError, Led};
use rand_distr::{Distribution, StandardNormal, StandardUniform};
use rand_pcg::Pcg64;

use super::Emitter;

/// What is wrong with the LEDs of a vehicle. The default is nothing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LedFaults {
    /// Spread of intensity between units in place of the emitter's: sigma of its logarithm.
    pub spread: Option<f64>,
    /// LEDs that do not shine, by number.
    pub dead: Vec<usize>,
    /// Chance of every other LED not to shine.
    pub dead_share: f64,
    /// LEDs that shine with a share of their power, by number.
    pub weak: Vec<(usize, f64)>,
    /// Sigma along each axis of how far a marker, with all its LEDs, sits from where it should, m.
    pub misplaced_m: f64,
}

impl LedFaults {
    /// The airframe as it was really built: markers where they are. Vehicle `id` under `seed` always gets the same.
    ///
    /// # Errors
    /// [`AirframeError`] where the markers, moved, are no airframe any more.
    pub fn built(&self, nominal: &Airframe, seed: u64, id: u32) -> Result<Airframe, AirframeError> {
        if self.misplaced_m <= 0.0 {
            return Ok(nominal.clone());
        }
        let mut random = Pcg64::new(u128::from(seed), 0x3a9 ^ (u128::from(id) << 16));
        let mut leds: Vec<Led> = nominal.leds().to_vec();
        for marker in nominal.markers() {
            let off_m =
                Vector3::from_fn(|_, _| -> f64 { StandardNormal.sample(&mut random) }) * self.misplaced_m;
            marker.leds.iter().for_each(|&led| leds[led].position_m += off_m);
        }
        Airframe::new(nominal.name(), leds)
    }

    /// Intensity of each of `count` LEDs against that of the mean part; `draws` gives a standard normal number for each.
    pub fn powers(
        &self,
        emitter: &Emitter,
        count: usize,
        (seed, id): (u64, u32),
        mut draws: impl FnMut() -> f64,
    ) -> Vec<f64> {
        let part = Emitter { unit_spread: self.spread.unwrap_or(emitter.unit_spread), ..*emitter };
        let mut random = Pcg64::new(u128::from(seed), 0xdead ^ (u128::from(id) << 16));
        let power = |led: usize| {
            let unit = part.unit_factor(draws());
            let chance: f64 = StandardUniform.sample(&mut random);
            if self.dead.contains(&led) || chance < self.dead_share {
                return 0.0;
            }
            self.weak.iter().filter(|weak| weak.0 == led).fold(unit, |power, weak| power * weak.1)
        };
        (0..count).map(power).collect()
    }
}

#[cfg(test)]
mod tests {
    use photinus::airframe::Ring;

    use super::*;

    fn hexarotor() -> Airframe {
        let ring = Ring { arms: 6, radius_m: 0.4, leds_per_arm: 2, splay_rad: 1.0 };
        Airframe::from_ring("hexarotor", ring).unwrap()
    }

    #[test]
    fn markers_sit_off_by_the_sigma_that_was_asked_for_all_leds_of_one_alike() {
        let (nominal, faults) = (hexarotor(), LedFaults { misplaced_m: 0.004, ..Default::default() });
        let (mut square, mut count) = (0.0, 0.0);
        for id in 0..2000 {
            let built = faults.built(&nominal, 3, id).unwrap();
            for (led, should) in built.leds().iter().zip(nominal.leds()) {
                let off_m = led.position_m - should.position_m;
                square += off_m.norm_squared();
                count += 3.0;
            }
            let off = |led: usize| built.leds()[led].position_m - nominal.leds()[led].position_m;
            let marker = &nominal.markers()[2].leds;
            assert!(marker.len() == 2 && (off(marker[0]) - off(marker[1])).norm() < 1e-15);
        }
        assert!((f64::sqrt(square / count) / 0.004 - 1.0).abs() < 0.01);
        assert_eq!(faults.built(&nominal, 3, 7), faults.built(&nominal, 3, 7));
        assert_ne!(faults.built(&nominal, 3, 7), faults.built(&nominal, 4, 7));
        assert_eq!(LedFaults::default().built(&nominal, 3, 7).unwrap(), nominal);
    }

    #[test]
    fn powers_spread_weaken_and_die_as_they_are_told_to() {
        let emitter = Emitter { peak_w_per_sr: 1.0, radius_m: 1e-3, unit_spread: 0.05, wavelength_m: 4e-7 };
        let faults = LedFaults {
            spread: Some(0.2),
            dead: vec![3],
            dead_share: 0.25,
            weak: vec![(1, 0.5)],
            ..Default::default()
        };
        let mut random = Pcg64::new(1, 2);
        let powers = faults.powers(&emitter, 100_000, (1, 1), || StandardNormal.sample(&mut random));
        assert!(powers[3] <= 0.0);
        let alive: Vec<f64> = powers.iter().copied().filter(|power| *power > 0.0).collect();
        assert!((alive.len() as f64 / 1e5 - 0.75).abs() < 0.006, "{}", alive.len());
        let square = alive.iter().map(|power| libm::log(*power).powi(2)).sum::<f64>() / alive.len() as f64;
        assert!((square.sqrt() / 0.2 - 1.0).abs() < 0.02, "{square}");
        let one = LedFaults { weak: vec![(1, 0.5)], ..Default::default() };
        assert_eq!(one.powers(&emitter, 3, (1, 1), || 0.0), [1.0, 0.5, 1.0]);
    }
}
