//! How the light of an LED falls off to the side: a law, or a table of intensities.

use alloc::sync::Arc;
use core::f64::consts::PI;

/// How the light of an LED falls off with the angle to its axis.
#[derive(Clone, Debug, PartialEq)]
pub enum Lobe {
    /// The cosine of the angle, nothing past 90 deg: a bare LED (the paper's figure 8).
    Lambertian,
    /// The same in every direction: an LED under a diffuser.
    Omni,
    /// A power of the cosine, nothing past 90 deg: 1 is a bare LED, more is a lens over it.
    Cosine {
        /// The power, within [`Lobe::COSINE_POWERS`].
        power: f64,
    },
    /// Intensities as measured or from a data sheet.
    Table(LobeTable),
}

impl Lobe {
    /// The least and the largest power of the cosine.
    pub const COSINE_POWERS: [f64; 2] = [0.1, 200.0];

    /// Intensity at an angle to the axis, given by its cosine; 1 is that of an LED of power 1 on its axis.
    pub fn intensity(&self, cos: f64) -> f64 {
        match self {
            Self::Lambertian => cos.max(0.0),
            Self::Omni => 1.0,
            Self::Cosine { power } if cos > 0.0 => libm::pow(cos.min(1.0), *power),
            Self::Cosine { .. } => 0.0,
            Self::Table(table) => table.intensity_with_slope(angle_rad(cos)).0,
        }
    }

    /// [`Lobe::intensity`] with its derivative by the cosine.
    pub(super) fn intensity_with_slope(&self, cos: f64) -> (f64, f64) {
        match self {
            Self::Lambertian if cos > 0.0 => (cos, 1.0),
            Self::Cosine { power } if cos > 0.0 => {
                (self.intensity(cos), power * libm::pow(cos.min(1.0), power - 1.0))
            }
            Self::Lambertian | Self::Cosine { .. } => (0.0, 0.0),
            Self::Omni => (1.0, 0.0),
            Self::Table(table) => {
                let at_rad = angle_rad(cos);
                let (intensity, slope) = table.intensity_with_slope(at_rad);
                // On the axis both the slope and the sine are 0, and the angle's own gradient with them.
                (intensity, -slope / libm::sin(at_rad).max(1e-6))
            }
        }
    }

    /// Cosine of the angle from which on it is dark; `None` where it is nowhere.
    pub(crate) fn dark_from_cos(&self) -> Option<f64> {
        match self {
            Self::Omni => None,
            Self::Lambertian | Self::Cosine { .. } => Some(0.0),
            Self::Table(table) => table.dark_from_rad().map(libm::cos),
        }
    }

    /// Refuses a power of the cosine that no LED has.
    pub(super) fn check(&self) -> Result<(), LobeError> {
        let [least, most] = Self::COSINE_POWERS;
        match self {
            Self::Cosine { power } if !(least..=most).contains(power) => {
                Err(LobeError::CosinePower { power: *power })
            }
            _ => Ok(()),
        }
    }
}

fn angle_rad(cos: f64) -> f64 {
    libm::acos(cos.clamp(-1.0, 1.0))
}

/// Intensities from the axis on. Between its angles it is a cubic that is monotone wherever they are, with a slope that does
/// not jump: F. N. Fritsch, J. Butland, "A method for constructing local monotone piecewise cubic interpolants", SIAM J. Sci.
/// Stat. Comput. 5 (1984). On the axis and at the last angle it is level.
#[derive(Clone, Debug, PartialEq)]
pub struct LobeTable {
    knots: Arc<[Knot]>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Knot {
    at_rad: f64,
    intensity: f64,
    /// Derivative of the intensity by the angle, 1/rad.
    slope: f64,
}

impl LobeTable {
    /// Largest intensity.
    pub const MOST: f64 = 10.0;

    /// A table of intensities at angles to the axis, rad: from 0 on, ascending, up to where it is dark or to pi.
    ///
    /// # Errors
    /// [`LobeError`] for lists of different length or with fewer than two entries, for angles that do not ascend from 0 to at
    /// most pi, for intensities that are not 0 to [`Self::MOST`], none of them above 0, and for light at the last angle where
    /// that is less than pi.
    pub fn new(angles_rad: &[f64], intensities: &[f64]) -> Result<Self, LobeError> {
        let (angles, count) = (angles_rad.len(), intensities.len());
        if angles != count || count < 2 {
            return Err(LobeError::Lengths { angles, intensities: count });
        }
        let ascends = angles_rad.windows(2).all(|pair| pair[1] - pair[0] > 1e-6);
        // What is written in degrees may be pi but for its rounding.
        let last_rad = angles_rad[count - 1];
        if !(ascends && angles_rad[0].abs() <= 0.0 && last_rad <= PI + 1e-9) {
            return Err(LobeError::Angles);
        }
        if let Some(wrong) = intensities.iter().position(|value| !(0.0..=Self::MOST).contains(value)) {
            return Err(LobeError::Intensity { entry: wrong, value: intensities[wrong] });
        }
        if intensities.iter().all(|&value| value <= 0.0) {
            return Err(LobeError::Dark);
        }
        if intensities[count - 1] > 0.0 && last_rad < PI - 1e-9 {
            return Err(LobeError::OpenEnd { last_rad });
        }
        let knot = |index: usize| Knot {
            at_rad: angles_rad[index],
            intensity: intensities[index],
            slope: slope(angles_rad, intensities, index),
        };
        Ok(Self { knots: (0..count).map(knot).collect() })
    }

    /// Its angles, rad, with the intensities there.
    pub fn entries(&self) -> impl ExactSizeIterator<Item = (f64, f64)> + '_ {
        self.knots.iter().map(|knot| (knot.at_rad, knot.intensity))
    }

    /// The angle from which on it is dark; `None` where it shines up to pi.
    fn dark_from_rad(&self) -> Option<f64> {
        let shines = self.knots.iter().rposition(|knot| knot.intensity > 0.0)?;
        self.knots.get(shines + 1).map(|knot| knot.at_rad)
    }

    /// Intensity at an angle, rad, with its derivative, 1/rad.
    fn intensity_with_slope(&self, at_rad: f64) -> (f64, f64) {
        let next = self.knots.partition_point(|knot| knot.at_rad <= at_rad);
        let Some(far) = self.knots.get(next) else {
            return (self.knots[next - 1].intensity, 0.0);
        };
        // The first angle is 0, and none is less.
        let near = &self.knots[next - 1];
        let width_rad = far.at_rad - near.at_rad;
        let t = (at_rad - near.at_rad) / width_rad;
        let rise = far.intensity - near.intensity;
        let (bend, twist) = (
            3.0 * rise - width_rad * (2.0 * near.slope + far.slope),
            width_rad * (near.slope + far.slope) - 2.0 * rise,
        );
        let intensity = near.intensity + t * (width_rad * near.slope + t * (bend + t * twist));
        let slope = near.slope + t * (2.0 * bend + t * 3.0 * twist) / width_rad;
        (intensity.max(0.0), slope)
    }
}

/// Slope at an inner angle: the harmonic mean of those on both sides, weighed by how wide they are; 0 where they differ in
/// sign, and at the ends.
fn slope(angles_rad: &[f64], intensities: &[f64], index: usize) -> f64 {
    if index == 0 || index + 1 == angles_rad.len() {
        return 0.0;
    }
    let width_rad = |of: usize| angles_rad[of + 1] - angles_rad[of];
    let rise = |of: usize| (intensities[of + 1] - intensities[of]) / width_rad(of);
    let (before, after) = (rise(index - 1), rise(index));
    if before * after <= 0.0 {
        return 0.0;
    }
    let weight_before = 2.0 * width_rad(index) + width_rad(index - 1);
    let weight_after = width_rad(index) + 2.0 * width_rad(index - 1);
    (weight_before + weight_after) / (weight_before / before + weight_after / after)
}

/// Why no LED shines like that.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LobeError {
    /// A power of the cosine that no LED has.
    #[error("a power of the cosine of {power}: {} to {} are possible", Lobe::COSINE_POWERS[0], Lobe::COSINE_POWERS[1])]
    CosinePower {
        /// The power.
        power: f64,
    },
    /// Lists that do not fit each other.
    #[error("{angles} angles and {intensities} intensities: as many of each, two or more")]
    Lengths {
        /// How many angles.
        angles: usize,
        /// How many intensities.
        intensities: usize,
    },
    /// Angles that are in no order.
    #[error("the angles of a lobe must ascend from 0 to 180 deg at most")]
    Angles,
    /// An intensity that cannot be.
    #[error("intensity {entry} of a lobe, counted from 0, is {value}: 0 to {max} are possible", max = LobeTable::MOST)]
    Intensity {
        /// Which one.
        entry: usize,
        /// What it is.
        value: f64,
    },
    /// Nothing shines.
    #[error("a lobe without any light")]
    Dark,
    /// Light where the table ends.
    #[error("a lobe ends with light at {:.1} deg: let it end with intensity 0, or at 180 deg", last_rad.to_degrees())]
    OpenEnd {
        /// The last angle, rad.
        last_rad: f64,
    },
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn table(entries_deg: &[(f64, f64)]) -> Result<LobeTable, LobeError> {
        let (angles, intensities): (Vec<f64>, Vec<f64>) =
            entries_deg.iter().map(|&(deg, intensity)| (deg.to_radians(), intensity)).unzip();
        LobeTable::new(&angles, &intensities)
    }

    #[test]
    fn a_dense_table_of_a_law_is_the_law() {
        let law = Lobe::Cosine { power: 3.0 };
        let at = |deg: i32| {
            (
                f64::from(deg),
                if deg == 90 { 0.0 } else { law.intensity(libm::cos(f64::from(deg).to_radians())) },
            )
        };
        let tabled = Lobe::Table(table(&(0..=18).map(|step| at(5 * step)).collect::<Vec<_>>()).unwrap());
        for deg in 0..100 {
            let cos = libm::cos((f64::from(deg) + 0.3).to_radians());
            let off = (tabled.intensity(cos) - law.intensity(cos)).abs();
            assert!(off < 3e-3, "{deg} deg: {off}");
        }
    }

    #[test]
    fn impossible_lobes_are_refused_by_name() {
        assert!(matches!(table(&[(0.0, 1.0)]), Err(LobeError::Lengths { angles: 1, .. })));
        assert!(matches!(LobeTable::new(&[0.0, 1.0], &[1.0]), Err(LobeError::Lengths { .. })));
        for angles in [[0.1, 1.0], [0.0, f64::NAN], [0.0, -1.0], [0.0, 3.2]] {
            assert_eq!(LobeTable::new(&angles, &[1.0, 0.0]), Err(LobeError::Angles));
        }
        for value in [-0.1, f64::NAN, 11.0] {
            assert!(matches!(
                table(&[(0.0, 1.0), (50.0, value), (90.0, 0.0)]),
                Err(LobeError::Intensity { entry: 1, .. })
            ));
        }
        assert_eq!(table(&[(0.0, 0.0), (90.0, 0.0)]), Err(LobeError::Dark));
        assert!(matches!(table(&[(0.0, 1.0), (90.0, 0.2)]), Err(LobeError::OpenEnd { .. })));
        assert!(table(&[(0.0, 1.0), (180.0, 0.2)]).is_ok());
        for power in [0.0, -1.0, f64::NAN, 1e3] {
            assert!(matches!(Lobe::Cosine { power }.check(), Err(LobeError::CosinePower { .. })));
        }
    }

    proptest! {
        #[test]
        fn a_table_passes_its_entries_and_stays_between_neighbours_without_a_jump(
            steps_deg in prop::collection::vec(1.0..30.0_f64, 2..6),
            intensities in prop::collection::vec(0.0..2.0_f64, 6),
        ) {
            let mut at_deg = 0.0;
            let mut entries = vec![(0.0, intensities[0] + 0.01)];
            for (step, value) in steps_deg.iter().zip(&intensities[1..]) {
                at_deg += step;
                entries.push((at_deg, *value));
            }
            entries.last_mut().unwrap().1 = 0.0;
            let table = table(&entries).unwrap();
            for pair in entries.windows(2) {
                let (low, high) = (pair[0].1.min(pair[1].1), pair[0].1.max(pair[1].1));
                prop_assert!((table.intensity_with_slope(pair[0].0.to_radians()).0 - pair[0].1).abs() < 1e-12);
                for share in [0.01, 0.3, 0.5, 0.9, 0.99] {
                    let at_rad = (pair[0].0 + share * (pair[1].0 - pair[0].0)).to_radians();
                    let (value, slope) = table.intensity_with_slope(at_rad);
                    prop_assert!(value >= low - 1e-12 && value <= high + 1e-12);
                    let beside = |by: f64| table.intensity_with_slope(at_rad + by).0;
                    let numeric = (beside(1e-6) - beside(-1e-6)) / 2e-6;
                    prop_assert!((numeric - slope).abs() < 1e-3, "{numeric} {slope}");
                }
                let around = |by: f64| table.intensity_with_slope(pair[1].0.to_radians() + by).1;
                prop_assert!((around(1e-9) - around(-1e-9)).abs() < 1e-3, "the slope jumps at {}", pair[1].0);
            }
        }
    }
}
