//! A report as a few bytes: four for who sends it, twelve a sight.
//!
//! Of a covariance, its sigma along the line of sight and the larger one across it are sent, a sixteenth of an octave each, rounded up: that is how
//! a camera's errors lie. Places are rounded to a centimetre, which is added to the covariance where they are read.

use nalgebra::{Matrix3, Vector3};

use super::{Report, Sight};
use crate::Normal;

const HEAD: usize = 4;
const SIGHT: usize = 12;
const CM_M: f64 = 0.01;
const LEAST_SIGMA_M: f64 = 1e-3;
const STEPS_PER_OCTAVE: f64 = 16.0;
/// Stands for a sight without identity.
const NOBODY: u32 = u32::MAX;

impl Report {
    /// The message. Sights further than 327 m, or that are not finite, are left out.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = self.from.to_le_bytes().to_vec();
        self.sights.iter().filter_map(written).for_each(|sight| bytes.extend_from_slice(&sight));
        bytes
    }

    /// The report of a message; `None` where no message has its length.
    pub fn from_bytes(bytes: &[u8]) -> Option<Self> {
        let (head, sights) = bytes.split_first_chunk::<HEAD>()?;
        let (sights, rest) = sights.as_chunks::<SIGHT>();
        rest.is_empty()
            .then(|| Self { from: u32::from_le_bytes(*head), sights: sights.iter().map(read).collect() })
    }
}

fn written(sight: &Sight) -> Option<[u8; SIGHT]> {
    let Normal { mean, covariance } = sight.position_m;
    let towards = mean.try_normalize(1e-6)?;
    let along2 = towards.dot(&(covariance * towards));
    let across = Matrix3::identity() - towards * towards.transpose();
    let flat = across * covariance * across;
    // The larger of its two eigenvalues that are not zero, by their sum and the sum of their squares.
    let (half, squares) = (0.5 * flat.trace(), flat.norm_squared());
    let across2 = half + libm::sqrt((0.5 * squares - half * half).max(0.0));
    let sigmas = [along2, across2].map(|variance| {
        let steps = STEPS_PER_OCTAVE * libm::log2(libm::sqrt(variance) / LEAST_SIGMA_M);
        libm::ceil(steps).clamp(0.0, 255.0) as u8
    });
    let centimetres = (mean / CM_M).map(libm::round);
    let fits = centimetres.iter().all(|x| x.abs() <= f64::from(i16::MAX)) && covariance.trace().is_finite();
    let mut bytes = [0; SIGHT];
    bytes[..4].copy_from_slice(&sight.identity.unwrap_or(NOBODY).to_le_bytes());
    for (place, x) in bytes[4..10].as_chunks_mut::<2>().0.iter_mut().zip(centimetres.iter()) {
        *place = (*x as i16).to_le_bytes();
    }
    bytes[10..].copy_from_slice(&sigmas);
    fits.then_some(bytes)
}

fn read(bytes: &[u8; SIGHT]) -> Sight {
    let [a, b, c, d, x0, x1, y0, y1, z0, z1, along, across] = *bytes;
    let identity = u32::from_le_bytes([a, b, c, d]);
    let mean = Vector3::from([[x0, x1], [y0, y1], [z0, z1]].map(|x| f64::from(i16::from_le_bytes(x)) * CM_M));
    let [along2, across2] = [along, across].map(|steps| {
        let sigma = LEAST_SIGMA_M * libm::exp2(f64::from(steps) / STEPS_PER_OCTAVE);
        sigma * sigma + CM_M * CM_M / 12.0
    });
    let towards = mean.try_normalize(1e-6).unwrap_or_else(Vector3::zeros);
    let line = towards * towards.transpose();
    let covariance = Matrix3::identity() * across2 + line * (along2 - across2);
    Sight { identity: (identity != NOBODY).then_some(identity), position_m: Normal { mean, covariance } }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_report_survives_the_link(
            at in [-300.0..300.0_f64, -300.0..300.0_f64, 1.0..300.0_f64], along in 0.01..10.0_f64, across in 0.01..1.0_f64,
        ) {
            let mean = Vector3::from(at);
            let line = mean.normalize() * mean.normalize().transpose();
            let covariance = Matrix3::identity() * (across * across) + line * (along * along - across * across);
            let sight = Sight { identity: Some(3), position_m: Normal { mean, covariance } };
            let anonymous = Sight { identity: None, ..sight };
            let report = Report { from: 9, sights: vec![sight, anonymous] };
            let bytes = report.to_bytes();
            prop_assert_eq!(bytes.len(), 28);
            let back = Report::from_bytes(&bytes).unwrap();
            prop_assert_eq!((back.from, back.sights[0].identity, back.sights[1].identity), (9, Some(3), None));
            let told = back.sights[0].position_m;
            prop_assert!((told.mean - mean).amax() <= 0.005 + 1e-9);
            let more = told.covariance - covariance;
            // Never surer than it was, and less sure by no more than a step.
            prop_assert!(more.symmetric_eigenvalues().min() > -0.01 * along * along);
            prop_assert!(told.covariance.trace() < 1.1 * covariance.trace() + 1e-3);
        }

        #[test]
        fn any_bytes_are_read_or_refused(bytes in proptest::collection::vec(any::<u8>(), 0..60)) {
            let read = Report::from_bytes(&bytes);
            prop_assert_eq!(read.is_some(), bytes.len() >= 4 && (bytes.len() - 4).is_multiple_of(12));
        }
    }
}
