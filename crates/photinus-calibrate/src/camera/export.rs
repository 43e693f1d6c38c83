//! The lens found -> a camera of `photinus`, and the same for tools that know OCamCalib only.

use nalgebra::{DMatrix, DVector, Matrix2};
use photinus::camera::{Camera, CameraError, KannalaBrandt, Model, OCam, Pixel};

use super::Calibration;
use crate::adjust::Cholesky;
use crate::lens::{AFFINE, CENTRE, Lens, MOST_PARAMETERS, RADIAL};

/// A camera of model OCam that agrees with the calibrated one over its field.
#[derive(Clone, Debug)]
pub struct OcamExport {
    /// The camera.
    pub camera: Camera,
    /// Largest angle between the two, rad.
    pub max_off_rad: f64,
}

/// Why there is no such camera.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ExportError {
    /// No polynomial follows the lens.
    #[error("no polynomial z(r) follows this lens out to {:.1} deg off the axis", limit_rad.to_degrees())]
    NoPolynomial {
        /// Field limit, rad.
        limit_rad: f64,
    },
    /// The polynomial makes no camera.
    #[error("the polynomial that follows this lens makes no camera: {0}")]
    Camera(#[from] CameraError),
}

/// The model of `photinus`, and how its parameters (rows) follow from those of the lens (columns).
pub(super) fn model_of(lens: &Lens) -> Result<(Model, DMatrix<f64>), CameraError> {
    let p = lens.all_parameters();
    let scale = lens.scale_px();
    let centre = Pixel::new(p[CENTRE], p[CENTRE + 1]);
    let (c, d) = (p[AFFINE], p[AFFINE + 1]);
    if let Some(degree) = lens.model().ocam_degree() {
        let mut direct = vec![0.0; degree + 1];
        let mut by = DMatrix::zeros(degree + 7, MOST_PARAMETERS);
        for k in 0..degree {
            let power = if k == 0 { 0 } else { k + 1 };
            let unit = -scale * libm::pow(scale, -(power as f64));
            direct[power] = unit * p[RADIAL + k];
            by[(power, RADIAL + k)] = unit;
        }
        for (row, column) in [(1, CENTRE), (2, CENTRE + 1), (3, AFFINE), (4, AFFINE + 1)] {
            by[(degree + row, column)] = 1.0;
        }
        let lens = OCam::new(&direct, centre, Matrix2::new(c, d, 0.0, 1.0))?;
        return Ok((Model::OCam(lens), by));
    }
    let focal = p[RADIAL] * scale;
    let k = std::array::from_fn(|k| p[RADIAL + 1 + k]);
    let lens = KannalaBrandt::with_shear([focal, c * focal], centre, k, d * focal)?;
    let mut by = DMatrix::zeros(9, MOST_PARAMETERS);
    by[(0, RADIAL)] = scale;
    (by[(1, RADIAL)], by[(1, AFFINE)]) = (c * scale, focal);
    for k in 0..4 {
        by[(2 + k, RADIAL + 1 + k)] = 1.0;
    }
    (by[(6, CENTRE)], by[(7, CENTRE + 1)]) = (1.0, 1.0);
    (by[(8, RADIAL)], by[(8, AFFINE + 1)]) = (d * scale, focal);
    Ok((Model::KannalaBrandt(lens), by))
}

/// An OCam polynomial this near is not worth another degree, rad.
const GOOD_ENOUGH_RAD: f64 = 5e-5;
/// Degrees that are tried: programs in the field accept 63.
const DEGREES: [usize; 7] = [4, 6, 8, 10, 12, 14, 16];
/// Places along the radius at which the two are compared.
const STEPS: usize = 400;

impl Calibration {
    /// The same camera with the model OCam, for files that other tools read.
    ///
    /// # Errors
    /// [`ExportError`] when no polynomial follows the lens over its field.
    pub fn ocam(&self) -> Result<OcamExport, ExportError> {
        if let Model::OCam(_) = self.camera().model() {
            return Ok(OcamExport { camera: self.camera().clone(), max_off_rad: 0.0 });
        }
        let limit_rad = self.camera().field_limit_rad();
        let nothing = ExportError::NoPolynomial { limit_rad };
        let radius_px = self.lens().radius_px(limit_rad).ok_or(nothing.clone())?;
        let curve: Vec<(f64, f64)> = (1..=STEPS)
            .filter_map(|i| {
                let angle = limit_rad * i as f64 / STEPS as f64;
                Some((self.lens().radius_px(angle)?, angle))
            })
            .collect();
        let mut best: Option<(Vec<f64>, f64)> = None;
        for degree in DEGREES {
            let Some(direct) = even_polynomial(&curve, radius_px, degree) else { continue };
            let off_rad = largest_off_rad(&curve, &direct);
            if best.as_ref().is_none_or(|(_, least)| off_rad < *least) {
                best = Some((direct, off_rad));
            }
            if off_rad < GOOD_ENOUGH_RAD {
                break;
            }
        }
        let (direct, max_off_rad) = best.ok_or(nothing)?;
        let p = self.lens().all_parameters();
        let centre = Pixel::new(p[CENTRE], p[CENTRE + 1]);
        let lens = OCam::new(&direct, centre, Matrix2::new(p[AFFINE], p[AFFINE + 1], 0.0, 1.0))?;
        let [width_px, height_px] = self.size_px();
        let camera = Camera::new(Model::OCam(lens), width_px, height_px, Some(limit_rad))?;
        Ok(OcamExport { camera, max_off_rad })
    }
}

/// z(r) in even powers of r (a smooth lens has no others) that follows a curve of (radius, angle) best in angle.
fn even_polynomial(curve: &[(f64, f64)], radius_px: f64, degree: usize) -> Option<Vec<f64>> {
    let terms = degree / 2 + 1;
    let (mut normal, mut right) = (DMatrix::zeros(terms, terms), DVector::zeros(terms));
    let mut row = vec![0.0; terms];
    for &(radius, angle) in curve {
        let (sin, cos) = libm::sincos(angle);
        // an error of z turns the ray by this much of it
        let weight = sin * sin / radius;
        chebyshev(2.0 * (radius / radius_px) * (radius / radius_px) - 1.0, &mut row);
        for i in 0..terms {
            right[i] += weight * weight * row[i] * (-radius * cos / sin);
            for j in 0..=i {
                normal[(i, j)] += weight * weight * row[i] * row[j];
            }
        }
    }
    let weights = Cholesky::new(&normal)?.solve(&right);
    Some(plain_powers(weights.as_slice(), radius_px))
}

/// T0 to Tn at x.
fn chebyshev(x: f64, values: &mut [f64]) {
    let (mut before, mut now) = (x, 1.0);
    for value in values {
        *value = now;
        (before, now) = (now, 2.0 * x * now - before);
    }
}

/// The sum of `weights[k] T_k(2 (r / radius)^2 - 1)` in ascending powers of r.
fn plain_powers(weights: &[f64], radius_px: f64) -> Vec<f64> {
    let count = weights.len();
    // in powers of q = (r / radius)^2, times x = 2 q - 1
    let times_x = |p: &[f64]| -> Vec<f64> {
        (0..count).map(|k| (if k > 0 { 2.0 * p[k - 1] } else { 0.0 }) - p[k]).collect()
    };
    let mut now = vec![0.0; count];
    now[0] = 1.0;
    let mut before = times_x(&now);
    let mut sum = vec![0.0; count];
    for weight in weights {
        for (total, value) in sum.iter_mut().zip(&now) {
            *total += weight * value;
        }
        let next = times_x(&now).iter().zip(&before).map(|(x, before)| 2.0 * x - before).collect();
        before = std::mem::replace(&mut now, next);
    }
    let mut powers = vec![0.0; 2 * count - 1];
    for (k, value) in sum.iter().enumerate() {
        powers[2 * k] = value * libm::pow(radius_px, -2.0 * k as f64);
    }
    powers
}

fn largest_off_rad(curve: &[(f64, f64)], direct: &[f64]) -> f64 {
    let off = |&(radius, angle): &(f64, f64)| {
        let z = direct.iter().rev().fold(0.0, |sum, a| sum * radius + a);
        (libm::atan2(radius, -z) - angle).abs()
    };
    curve.iter().map(off).fold(0.0, f64::max)
}
