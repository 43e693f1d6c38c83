//! How sure a calibration is of each direction.
//!
//! The covariance of a model's parameters enters, taken apart into independent errors of all parameters at once; each turns the
//! bearing at a pixel a little. What an error turns over the whole field alike is taken out: it turns the camera's
//! frame, and that frame is fixed by the mounting calibration, which is made with the same camera file and takes the turn in.

use alloc::vec;
use alloc::vec::Vec;

use nalgebra::{DMatrix, Matrix3, Matrix3x2, Vector2, Vector3};

use super::error::{CameraError, finite};
use super::field::Field;
use super::radial::{AtRadius, Radial};
use super::{Camera, KannalaBrandt, Model, OCam, Pixel};
#[cfg(not(feature = "std"))]
use crate::float::Float as _;

/// Most parameters of a model: the coefficients of an OCam polynomial, its centre and its stretch matrix.
const MOST_PARAMETERS: usize = OCam::MAX_COEFFICIENTS + 6;

/// Columns and rows of the lattice of pixels over which the common turn is measured.
const LATTICE: usize = 40;

/// A pivot of a correlation matrix below this is rounding.
const NOTHING: f64 = 1e-13;

/// The covariance of a model's parameters, ready for use at a pixel.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Calibration {
    pub(super) covariance: DMatrix<f64>,
    /// Independent errors of one standard deviation, one after another: the change of each parameter.
    errors: Vec<f64>,
    /// The turn of the whole field that takes the common part out of each error, rad.
    turns: Vec<Vector3<f64>>,
}

/// Derivatives of a bearing by the parameters of a model, at a fixed pixel.
struct ByParameters {
    values: [Vector3<f64>; MOST_PARAMETERS],
    count: usize,
}

impl ByParameters {
    fn new() -> Self {
        Self { values: [Vector3::zeros(); MOST_PARAMETERS], count: 0 }
    }

    fn push(&mut self, value: Vector3<f64>) {
        if let Some(place) = self.values.get_mut(self.count) {
            *place = value;
            self.count += 1;
        }
    }

    fn push_centre(&mut self, by_pixel: &Matrix3x2<f64>) {
        self.push(-by_pixel.column(0));
        self.push(-by_pixel.column(1));
    }

    /// The derivative by the entry (`row`, `column`) of the matrix from the plane to pixels.
    fn push_entry(&mut self, by_pixel: &Matrix3x2<f64>, place: &Vector2<f64>, row: usize, column: usize) {
        self.push(-by_pixel.column(row) * place[column]);
    }

    /// What an error of the parameters does to the bearing.
    fn times(&self, error: &[f64]) -> Vector3<f64> {
        self.values[..self.count]
            .iter()
            .zip(error)
            .fold(Vector3::zeros(), |sum, (by, change)| sum + by * *change)
    }
}

impl Calibration {
    pub(super) fn new(camera: &Camera, covariance: DMatrix<f64>) -> Result<Self, CameraError> {
        let needed = camera.model.parameter_count();
        if needed == 0 || covariance.shape() != (needed, needed) {
            return Err(CameraError::CovarianceSize { needed, rows: covariance.nrows() });
        }
        finite("an entry of the covariance", covariance.as_slice())?;
        let errors = root(&covariance).ok_or(CameraError::NoCovariance)?;
        let turns = common_turns(camera, &errors, needed);
        finite(
            "the turn of an error",
            turns.iter().flat_map(Vector3::iter).copied().collect::<Vec<_>>().as_slice(),
        )?;
        Ok(Self { covariance, errors, turns })
    }

    /// Covariance of the bearing at a pixel of the camera, rad^2.
    pub(super) fn at(&self, camera: &Camera, pixel: Pixel) -> Option<Matrix3<f64>> {
        let (bearing, by) = by_parameters(camera, pixel)?;
        let mut sum = Matrix3::zeros();
        for (error, turn) in self.errors.chunks_exact(by.count.max(1)).zip(&self.turns) {
            let off = by.times(error) + turn.cross(&bearing);
            sum += off * off.transpose();
        }
        Some(sum)
    }
}

/// Columns whose products with themselves add up to the covariance; `None` when the matrix is not a covariance.
fn root(covariance: &DMatrix<f64>) -> Option<Vec<f64>> {
    let size = covariance.nrows();
    let sigma: Vec<f64> = (0..size).map(|k| covariance[(k, k)].max(0.0).sqrt()).collect();
    let mut rest = DMatrix::from_fn(size, size, |i, j| {
        let scale = sigma[i] * sigma[j];
        if scale > 0.0 { covariance[(i, j)] / scale } else { covariance[(i, j)] }
    });
    let is_symmetric = (0..size).all(|i| (0..i).all(|j| (rest[(i, j)] - rest[(j, i)]).abs() <= 1e-9));
    let mut columns = Vec::with_capacity(size * size);
    for k in 0..size {
        let pivot = rest[(k, k)];
        if pivot <= NOTHING {
            if pivot < -1e-6 {
                return None;
            }
            continue;
        }
        let column: Vec<f64> =
            (0..size).map(|i| if i < k { 0.0 } else { rest[(i, k)] / pivot.sqrt() }).collect();
        for i in k..size {
            for j in k..size {
                rest[(i, j)] -= column[i] * column[j];
            }
        }
        columns.extend(column.iter().zip(&sigma).map(|(value, sigma)| value * sigma));
    }
    let left = rest.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
    (is_symmetric && left < 1e-6).then_some(columns)
}

/// For each error the turn w that makes the sum over the field of |error + w x bearing|^2 least, every direction
/// counting alike.
fn common_turns(camera: &Camera, errors: &[f64], parameters: usize) -> Vec<Vector3<f64>> {
    let count = errors.len() / parameters;
    let (mut matrix, mut right) = (Matrix3::zeros(), vec![Vector3::zeros(); count]);
    for i in 0..LATTICE * LATTICE {
        let share = |i: usize, side: usize| (i as f64 + 0.5) / LATTICE as f64 * side as f64 - 0.5;
        let pixel = Pixel::new(share(i % LATTICE, camera.width_px), share(i / LATTICE, camera.height_px));
        let Some((_, by_pixel)) = camera.bearing_with_jacobian(pixel) else { continue };
        let Some((bearing, by)) = by_parameters(camera, pixel) else { continue };
        let solid_angle = by_pixel.column(0).cross(&by_pixel.column(1)).norm();
        matrix += (Matrix3::identity() - bearing * bearing.transpose()) * solid_angle;
        for (error, right) in errors.chunks_exact(parameters).zip(&mut right) {
            *right -= bearing.cross(&by.times(error)) * solid_angle;
        }
    }
    let inverse = matrix.try_inverse().unwrap_or_else(Matrix3::zeros);
    right.iter().map(|right| inverse * right).collect()
}

/// The bearing at a pixel, and its derivatives by the model's parameters in their order.
fn by_parameters(camera: &Camera, pixel: Pixel) -> Option<(Vector3<f64>, ByParameters)> {
    if !camera.holds(pixel) {
        return None;
    }
    let plane = camera.model.plane();
    let place = plane.place(pixel);
    let (bearing, by_place) = camera.model.lift(&camera.field, &place)?;
    let by_pixel = by_place * plane.plane_from_pixel;
    let mut by = ByParameters::new();
    match &camera.model {
        Model::OCam(lens) => {
            push_ocam(&mut by, lens, &camera.field, &place)?;
            by.push_centre(&by_pixel);
            for (row, column) in [(1, 1), (1, 0), (0, 1), (0, 0)] {
                by.push_entry(&by_pixel, &place, row, column);
            }
        }
        Model::KannalaBrandt(lens) => {
            by.push_entry(&by_pixel, &place, 0, 0);
            by.push_entry(&by_pixel, &place, 1, 1);
            push_kannala_brandt(&mut by, lens, &camera.field, &place)?;
            by.push_centre(&by_pixel);
            by.push_entry(&by_pixel, &place, 1, 0);
        }
        Model::Ideal(_) => {
            by.push_entry(&by_pixel, &place, 0, 0);
            by.push_entry(&by_pixel, &place, 1, 1);
            by.push_centre(&by_pixel);
        }
        Model::Pinhole(_) => {}
    }
    Some((bearing, by))
}

/// By the coefficients of z(r): the angle is atan2(r, -z).
fn push_ocam(by: &mut ByParameters, lens: &OCam, field: &Field, place: &Vector2<f64>) -> Option<()> {
    let radius = place.norm_squared().sqrt();
    let at = lens.at_radius(radius, &field.inverse)?;
    let tilt = tilt(&at, place, radius);
    let mut by_term = radius * at.sin_per_radius * at.sin_per_radius;
    for _ in lens.direct() {
        by.push(tilt * by_term);
        by_term *= radius;
    }
    Some(())
}

/// By k1 to k4 of r = t + k1 t^3 + ..., at a fixed r.
fn push_kannala_brandt(
    by: &mut ByParameters,
    lens: &KannalaBrandt,
    field: &Field,
    place: &Vector2<f64>,
) -> Option<()> {
    let radius = place.norm_squared().sqrt();
    let at = lens.at_radius(radius, &field.inverse)?;
    let angle = libm::atan2(at.sin_per_radius * radius, at.cos);
    let tilt = tilt(&at, place, radius);
    let mut power = angle;
    for _ in lens.k() {
        power *= angle * angle;
        by.push(tilt * (-power * at.slope));
    }
    Some(())
}

/// How the bearing moves when its angle off the axis grows.
fn tilt(at: &AtRadius, place: &Vector2<f64>, radius: f64) -> Vector3<f64> {
    let outward = if radius > 0.0 { place / radius } else { Vector2::x() };
    Vector3::new(at.cos * outward.x, at.cos * outward.y, -at.sin_per_radius * radius)
}

impl Model {
    /// How many parameters the covariance of a calibration speaks of, 0 for a pinhole, which Photinus does not calibrate.
    /// In their order:
    ///
    /// | model | parameters |
    /// |---|---|
    /// | [`Model::OCam`] | the direct polynomial in ascending powers (px per px^k), centre u, v (px), stretch c, d, e and the last entry |
    /// | [`Model::KannalaBrandt`] | focal length along u, v (px), k1 to k4, centre u, v (px), shear (px) |
    /// | [`Model::Ideal`] | focal length along u, v (px), centre u, v (px) |
    pub fn parameter_count(&self) -> usize {
        match self {
            Model::OCam(lens) => lens.direct().len() + 6,
            Model::KannalaBrandt(lens) => lens.k().len() + 5,
            Model::Ideal(_) => 4,
            Model::Pinhole(_) => 0,
        }
    }
}

impl Camera {
    /// The camera with the covariance of its model's parameters, in the order of [`Model::parameter_count`]; a parameter that
    /// was not calibrated has zeros.
    ///
    /// # Errors
    /// [`CameraError::CovarianceSize`] when it is of another size, [`CameraError::NotFinite`] when a number is not finite,
    /// [`CameraError::NoCovariance`] when it is not symmetric or has a negative variance.
    pub fn with_calibration(mut self, covariance: DMatrix<f64>) -> Result<Self, CameraError> {
        self.calibration = Some(Calibration::new(&self, covariance)?);
        Ok(self)
    }

    /// The covariance of the model's parameters, in the order of [`Model::parameter_count`], where the camera knows it.
    pub fn parameter_covariance(&self) -> Option<&DMatrix<f64>> {
        self.calibration.as_ref().map(|calibration| &calibration.covariance)
    }

    /// How far off the calibration may be at a place: the covariance of its bearing, rad^2, zero along the bearing.
    ///
    /// Without what turns the whole field alike (in the sense of least squares, every direction of the field counting the same):
    /// that is a turn of the camera's frame, which the mounting calibration made with this camera takes in.
    /// `None` outside the image or the field, and for a camera that does not carry its calibration's covariance.
    pub fn calibration_covariance(&self, pixel: Pixel) -> Option<Matrix3<f64>> {
        self.calibration.as_ref()?.at(self, pixel)
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Matrix2;

    use super::super::{Ideal, IdealLaw};
    use super::*;

    const CENTRE: [f64; 2] = [376.0, 238.0];

    /// A camera of each calibrated model from its parameters in their order.
    fn build(which: usize, p: &[f64]) -> Camera {
        let model = match which {
            0 => {
                let stretch = Matrix2::new(p[7], p[8], p[9], p[10]);
                Model::OCam(OCam::new(&p[..5], Pixel::new(p[5], p[6]), stretch).unwrap())
            }
            1 => {
                let k = [p[2], p[3], p[4], p[5]];
                let lens = KannalaBrandt::with_shear([p[0], p[1]], Pixel::new(p[6], p[7]), k, p[8]);
                Model::KannalaBrandt(lens.unwrap())
            }
            _ => {
                let lens = Ideal::new(IdealLaw::Equisolid, [p[0], p[1]], Pixel::new(p[2], p[3]));
                Model::Ideal(lens.unwrap())
            }
        };
        Camera::new(model, 752, 480, Some(1.4)).unwrap()
    }

    fn parameters() -> [Vec<f64>; 3] {
        let [u, v] = CENTRE;
        [
            vec![-259.5, 0.0, 1.6e-3, -2.3e-6, 6.6e-9, u, v, 1.001, 0.002, -0.001, 1.0],
            vec![255.0, 252.0, -0.02, 0.004, -0.003, 0.0005, u, v, 0.3],
            vec![250.0, 251.0, u, v],
        ]
    }

    #[test]
    fn one_parameter_moves_the_bearing_as_finite_differences_do_up_to_a_common_turn() {
        for (which, parameters) in parameters().iter().enumerate() {
            let camera = build(which, parameters);
            assert_eq!(camera.model().parameter_count(), parameters.len());
            for k in 0..parameters.len() {
                let sigma = 1e-6 * parameters[k].abs().max(1e-9);
                let mut covariance = DMatrix::zeros(parameters.len(), parameters.len());
                covariance[(k, k)] = sigma * sigma;
                let calibrated = camera.clone().with_calibration(covariance).unwrap();
                let calibration = calibrated.calibration.as_ref().unwrap();
                let moved = |sign: f64| {
                    let mut parameters = parameters.clone();
                    parameters[k] += sign * sigma;
                    build(which, &parameters)
                };
                let (plus, minus) = (moved(1.0), moved(-1.0));
                for pixel in [Pixel::new(500.0, 100.0), Pixel::new(100.0, 300.0), Pixel::new(376.0, 400.0)] {
                    let vector = |camera: &Camera| *camera.bearing(pixel).unwrap().vector();
                    let off =
                        (vector(&plus) - vector(&minus)) / 2.0 + calibration.turns[0].cross(&vector(&camera));
                    let expected = off * off.transpose();
                    let found = calibrated.calibration_covariance(pixel).unwrap();
                    let slack = 1e-4 * expected.norm() + 1e-22;
                    assert!((found - expected).norm() < slack, "{which} {k} {found} {expected}");
                }
            }
        }
    }

    #[test]
    fn a_turn_of_the_camera_costs_nothing_on_its_axis() {
        // a centre that is off by a pixel: near the axis that is a turn of the frame
        let camera = build(2, &[250.0, 250.0, CENTRE[0], CENTRE[1]]);
        let mut covariance = DMatrix::zeros(4, 4);
        covariance[(2, 2)] = 1.0;
        let camera = camera.with_calibration(covariance).unwrap();
        let sigma = |u: f64| camera.calibration_covariance(Pixel::new(u, CENTRE[1])).unwrap().trace().sqrt();
        assert!(sigma(CENTRE[0]) < 0.5 / 250.0 && sigma(CENTRE[0] + 250.0) < 1.0 / 250.0);
        let along = camera.bearing(Pixel::new(500.0, 100.0)).unwrap();
        let covariance = camera.calibration_covariance(Pixel::new(500.0, 100.0)).unwrap();
        assert!((covariance * along.vector()).norm() < 1e-15 * covariance.norm().max(1.0));
    }

    #[test]
    fn what_is_no_covariance_is_refused() {
        let camera = || build(2, &[250.0, 250.0, CENTRE[0], CENTRE[1]]);
        let refused = |covariance: DMatrix<f64>| camera().with_calibration(covariance).unwrap_err();
        assert!(matches!(refused(DMatrix::zeros(3, 3)), CameraError::CovarianceSize { needed: 4, rows: 3 }));
        let mut odd = DMatrix::identity(4, 4);
        odd[(0, 1)] = 0.5;
        assert_eq!(refused(odd.clone()), CameraError::NoCovariance);
        odd[(1, 0)] = 0.5;
        assert!(camera().with_calibration(odd.clone()).is_ok());
        odd[(2, 2)] = -1.0;
        assert_eq!(refused(odd.clone()), CameraError::NoCovariance);
        odd[(2, 2)] = f64::NAN;
        assert!(matches!(refused(odd), CameraError::NotFinite { .. }));
        let mut too_much = DMatrix::identity(4, 4);
        (too_much[(0, 1)], too_much[(1, 0)]) = (2.0, 2.0);
        assert_eq!(refused(too_much), CameraError::NoCovariance);
        assert!(camera().calibration_covariance(Pixel::new(300.0, 200.0)).is_none());
    }
}
