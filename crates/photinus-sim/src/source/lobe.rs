//! Lobes that airframe files do not know: what an LED really does, whatever the method believes of it.

use std::sync::Arc;

use photinus::airframe;

/// How the light of an LED falls off with the angle to its axis.
#[derive(Clone, Debug, PartialEq)]
pub enum Lobe {
    /// The same in every direction.
    Omni,
    /// A power of the cosine, nothing past 90 deg: 1 is a bare face, more is a lens over it.
    Cosine {
        /// The power, 0 to 200.
        power: f64,
    },
    /// Intensities from the axis on at equal steps, linear between, nothing past the last: a data sheet's curve.
    Table {
        /// Step, rad.
        step_rad: f64,
        /// Intensity against that of an LED of the mean part on its axis.
        intensity: Arc<[f64]>,
    },
}

impl Lobe {
    /// A power of the cosine; `None` unless it is 0 to 200.
    pub fn cosine(power: f64) -> Option<Self> {
        (0.0..=200.0).contains(&power).then_some(Self::Cosine { power })
    }

    /// A table; `None` unless there are two intensities or more, 0 to 10 each, not reaching past 180 deg.
    pub fn table(step_rad: f64, intensity: &[f64]) -> Option<Self> {
        let reach_rad = step_rad * intensity.len().saturating_sub(1) as f64;
        let legal = intensity.len() >= 2 && step_rad > 0.0 && reach_rad <= core::f64::consts::PI + 1e-9;
        let positive = intensity.iter().all(|value| (0.0..=10.0).contains(value));
        (legal && positive).then(|| Self::Table { step_rad, intensity: intensity.into() })
    }

    /// Intensity at an angle to the axis, by its cosine.
    pub fn intensity(&self, cos: f64) -> f64 {
        match self {
            Self::Omni => 1.0,
            Self::Cosine { power } if cos > 0.0 => libm::pow(cos.min(1.0), *power),
            Self::Cosine { .. } => 0.0,
            Self::Table { step_rad, intensity } => {
                let at = libm::acos(cos.clamp(-1.0, 1.0)) / step_rad;
                let whole = at.floor() as usize;
                let Some(near) = intensity.get(whole) else { return 0.0 };
                let far = intensity.get(whole + 1).copied().unwrap_or(0.0);
                near + (far - near) * (at - at.floor())
            }
        }
    }
}

/// Intensity at an angle to the axis, by its cosine, of a lobe as an airframe tells it: of its words and numbers, not by the
/// method's own arithmetic. Tables are linear between their angles here.
pub(crate) fn told(lobe: &airframe::Lobe, cos: f64) -> f64 {
    match lobe {
        airframe::Lobe::Lambertian => cos.max(0.0),
        airframe::Lobe::Omni => Lobe::Omni.intensity(cos),
        airframe::Lobe::Cosine { power } => Lobe::Cosine { power: *power }.intensity(cos),
        airframe::Lobe::Table(table) => {
            let at_rad = libm::acos(cos.clamp(-1.0, 1.0));
            let before = table.entries().take_while(|(entry_rad, _)| *entry_rad <= at_rad).last();
            let after = table.entries().find(|(entry_rad, _)| *entry_rad > at_rad);
            match (before, after) {
                (Some((from_rad, from)), Some((to_rad, to))) => {
                    from + (to - from) * (at_rad - from_rad) / (to_rad - from_rad)
                }
                (Some((_, last)), None) => last,
                (None, _) => 0.0,
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn light_of_a_cosine_lobe_over_the_sphere_is_that_of_the_integral() {
        // 2 pi / (n + 1)
        for power in [0.0, 1.0, 3.0, 20.5] {
            let lobe = Lobe::cosine(power).unwrap();
            let steps = 200_000;
            let sum: f64 = (0..steps)
                .map(|i| lobe.intensity(2.0 * (f64::from(i) + 0.5) / f64::from(steps) - 1.0))
                .sum::<f64>();
            let flux = sum * 2.0 / f64::from(steps) * core::f64::consts::TAU;
            assert!((flux / (core::f64::consts::TAU / (power + 1.0)) - 1.0).abs() < 1e-4, "{flux} {power}");
        }
        assert!(Lobe::cosine(3.0).unwrap().intensity(-0.1) <= 0.0);
        assert_eq!(Lobe::cosine(f64::NAN), None);
    }

    #[test]
    fn what_an_airframe_tells_is_what_its_words_mean() {
        let at = |lobe: &airframe::Lobe, deg: f64| told(lobe, libm::cos(deg.to_radians()));
        let cosine = airframe::Lobe::Cosine { power: 3.0 };
        assert!((at(&cosine, 60.0) - 0.125).abs() < 1e-12 && at(&cosine, 95.0) <= 0.0);
        let angles_rad = [0.0, 40.0, 80.0].map(f64::to_radians);
        let table = airframe::LobeTable::new(&angles_rad, &[1.0, 0.6, 0.0]).unwrap();
        let table = airframe::Lobe::Table(table);
        for (deg, expected) in [(0.0, 1.0), (20.0, 0.8), (60.0, 0.3), (85.0, 0.0)] {
            assert!((at(&table, deg) - expected).abs() < 1e-9, "{deg}");
        }
        assert!((at(&airframe::Lobe::Omni, 170.0) - 1.0).abs() <= 0.0);
        assert!((at(&airframe::Lobe::Lambertian, 60.0) - 0.5).abs() < 1e-12);
    }

    #[test]
    fn a_table_is_linear_between_its_angles_and_dark_past_them() {
        let lobe = Lobe::table(30.0_f64.to_radians(), &[1.0, 0.8, 0.2]).unwrap();
        for (deg, expected) in
            [(0.0_f64, 1.0), (15.0, 0.9), (45.0, 0.5), (60.0, 0.2), (75.0, 0.1), (95.0, 0.0)]
        {
            let intensity = lobe.intensity(libm::cos(deg.to_radians()));
            assert!((intensity - expected).abs() < 1e-9, "{intensity} at {deg}");
        }
        assert_eq!(
            (Lobe::table(1.0, &[1.0; 5]), Lobe::table(0.1, &[1.0]), Lobe::table(0.1, &[1.0, -0.1])),
            (None, None, None)
        );
    }
}
