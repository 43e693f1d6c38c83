//! The lens found -> a camera of `photinus`, and the same for tools that know OCamCalib only.

use nalgebra::{DMatrix, DVector, Matrix2, Vector2, Vector3};
use photinus::camera::{Bearing, Camera, CameraError, KannalaBrandt, Model, OCam, Pixel};

use super::Calibration;
use crate::adjust::Cholesky;
use crate::lens::{AFFINE, CENTRE, Lens, MOST_PARAMETERS, RADIAL};

/// A camera of another model that agrees with the given one over its field.
#[derive(Clone, Debug)]
pub struct Export {
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
    /// No Kannala-Brandt lens without shear follows the camera.
    #[error("no Kannala-Brandt lens follows this camera: the nearest is {:.1} mrad off", 1e3 * max_off_rad)]
    NoKannalaBrandt {
        /// How far off the nearest is, rad; infinite where there is none at all.
        max_off_rad: f64,
    },
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
/// Columns and rows of the places of the image at which the two are compared.
const PLACES: [usize; 2] = [61, 41];

impl Calibration {
    /// The same camera with the model OCam, for files that other tools read.
    ///
    /// # Errors
    /// As [`ocam_of`].
    pub fn ocam(&self) -> Result<Export, ExportError> {
        ocam_of(self.camera())
    }
}

/// A camera of any model as one of model OCam. What is not symmetric about the axis, but for an affine part, is not followed; how far
/// that is off at most is said.
///
/// # Errors
/// [`ExportError`] when no polynomial follows the lens over its field.
pub fn ocam_of(camera: &Camera) -> Result<Export, ExportError> {
    if let Model::OCam(_) = camera.model() {
        return Ok(Export { camera: camera.clone(), max_off_rad: 0.0 });
    }
    let limit_rad = camera.field_limit_rad();
    let nothing = ExportError::NoPolynomial { limit_rad };
    let axis = Bearing::new(Vector3::z())
        .and_then(|axis| camera.pixel_with_jacobian(&axis))
        .ok_or(nothing.clone())?;
    let (centre, jacobian) = axis;
    // On (row, column), in the unit of columns.
    let [across, down] = [0, 1].map(|row| [jacobian[(row, 0)], jacobian[(row, 1)]]);
    let unit = across[0];
    let stretch = Matrix2::new(down[1] / unit, down[0] / unit, across[1] / unit, 1.0);
    let from_image = stretch.try_inverse().ok_or(nothing.clone())?;
    let seen: Vec<(Pixel, Bearing)> = places(camera).collect();
    let mut curve: Vec<(f64, f64)> = seen
        .iter()
        .map(|(pixel, bearing)| {
            let radius = (from_image * Vector2::new(pixel.v - centre.v, pixel.u - centre.u)).norm();
            let ray = bearing.vector();
            (radius, libm::atan2(libm::hypot(ray.x, ray.y), ray.z))
        })
        .filter(|(radius, _)| *radius > 1.0)
        .collect();
    curve.sort_by(|a, b| a.0.total_cmp(&b.0));
    let radius_px = curve.last().ok_or(nothing.clone())?.0;
    let mut best: Option<Export> = None;
    for degree in DEGREES {
        let Some(direct) = even_polynomial(&curve, radius_px, degree) else { continue };
        let Ok(lens) = OCam::new(&direct, centre, stretch) else { continue };
        let Ok(export) = Camera::new(Model::OCam(lens), camera.width(), camera.height(), Some(limit_rad))
        else {
            continue;
        };
        let max_off_rad = largest_off_rad(&seen, &export);
        if best.as_ref().is_none_or(|best| max_off_rad < best.max_off_rad) {
            best = Some(Export { camera: export, max_off_rad });
        }
        if max_off_rad < GOOD_ENOUGH_RAD {
            break;
        }
    }
    best.ok_or(nothing)
}

/// Places all over the image that have a bearing.
pub(super) fn places(camera: &Camera) -> impl Iterator<Item = (Pixel, Bearing)> {
    let along = |side: usize, step: usize, steps: usize| (side - 1) as f64 * step as f64 / (steps - 1) as f64;
    let [columns, rows] = PLACES;
    (0..columns * rows).filter_map(move |place| {
        let pixel = Pixel::new(
            along(camera.width(), place % columns, columns),
            along(camera.height(), place / columns, rows),
        );
        Some((pixel, camera.bearing(pixel)?))
    })
}

/// The largest angle between what two cameras see at a place; a place where one is blind tells nothing.
pub(super) fn largest_off_rad(seen: &[(Pixel, Bearing)], other: &Camera) -> f64 {
    let off = |(pixel, bearing): &(Pixel, Bearing)| {
        let apart = bearing.vector() - other.bearing(*pixel)?.vector();
        // The chord of a small angle, without the loss of digits of its cosine.
        Some(2.0 * libm::asin((apart.norm() / 2.0).min(1.0)))
    };
    seen.iter().filter_map(off).fold(0.0, f64::max)
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

#[cfg(test)]
mod tests {
    use photinus::camera::{Ideal, IdealLaw};

    use super::*;

    #[test]
    fn every_model_is_followed_and_what_is_said_of_it_is_so() {
        let centre = Pixel::new(370.3, 236.2);
        let ideal = |law| Model::Ideal(Ideal::new(law, [265.0, 266.0], centre).unwrap());
        let kannala_brandt =
            KannalaBrandt::with_shear([265.0, 266.0], centre, [-0.02, 0.004, 0.0, 0.0], 0.3).unwrap();
        for model in [
            ideal(IdealLaw::Equidistant),
            ideal(IdealLaw::Equisolid),
            ideal(IdealLaw::Stereographic),
            Model::KannalaBrandt(kannala_brandt),
        ] {
            let camera = Camera::new(model, 752, 480, Some(1.6)).unwrap();
            let export = ocam_of(&camera).unwrap();
            assert!(export.max_off_rad < 1e-4, "{:?} off by {}", camera.model(), export.max_off_rad);
            // Places that the fit did not take.
            for (u, v) in [(13.3, 401.7), (377.1, 9.2), (640.9, 77.7), (370.3, 236.9)] {
                let [a, b] = [&camera, &export.camera].map(|camera| camera.bearing(Pixel::new(u, v)));
                let (Some(a), Some(b)) = (a, b) else { continue };
                assert!((a.vector() - b.vector()).norm() < 1.2e-4, "at {u}, {v}");
            }
        }
    }
}
