#![allow(dead_code, reason = "each test takes what it needs")]
//! Simulated calibrations: a lens, a hand-made board and photos of it, all with truth, the same for the same seed.

use nalgebra::{Isometry3, Matrix2, Matrix3, Point3, UnitQuaternion, Vector2, Vector3};
use photinus::camera::{Bearing, Camera, KannalaBrandt, Model, Pixel};
use photinus_calibrate::adjust::{Observation, View};
use photinus_calibrate::camera::{BoardChoice, Calibration, Choices, calibrate};
use photinus_calibrate::grid::Grid;
use photinus_calibrate::lens::LensModel;
use rand_distr::{Distribution, Normal, Uniform};
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::SeedableRng;

pub(crate) const SIZE_PX: [usize; 2] = [960, 600];

/// Random numbers of one seed.
pub(crate) struct Dice(Pcg64Mcg);

impl Dice {
    pub(crate) fn new(seed: u64) -> Self {
        Self(Pcg64Mcg::seed_from_u64(seed))
    }

    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        Uniform::new(low, high).expect("low is below high").sample(&mut self.0)
    }

    pub(crate) fn normal(&mut self, sigma: f64) -> f64 {
        Normal::new(0.0, sigma).expect("a sigma").sample(&mut self.0)
    }
}

/// A UV fisheye much like a real one.
pub(crate) fn lens() -> Camera {
    let lens =
        KannalaBrandt::with_shear([463.6, 463.5], Pixel::new(509.6, 275.8), [-0.190, 0.0172, 0.0, 0.0], 0.1);
    Camera::new(Model::KannalaBrandt(lens.expect("a lens")), SIZE_PX[0], SIZE_PX[1], Some(1.3))
        .expect("a camera")
}

/// A pose of the board: its middle up to `off_axis_rad` off the axis, tilted by up to `tilt_rad`, turned at will.
pub(crate) fn pose(dice: &mut Dice, off_axis_rad: f64, tilt_rad: f64) -> Isometry3<f64> {
    let (around, off_axis) = (dice.between(0.0, std::f64::consts::TAU), dice.between(0.0, off_axis_rad));
    let ((y, x), (sin, cos)) = (libm::sincos(around), libm::sincos(off_axis));
    let sight = Vector3::new(sin * x, sin * y, cos);
    let facing = UnitQuaternion::rotation_between(&Vector3::z(), &sight).unwrap_or_default();
    let lean = dice.between(0.0, std::f64::consts::TAU);
    let tilt = Vector3::new(libm::cos(lean), libm::sin(lean), 0.0) * dice.between(0.0, tilt_rad);
    let roll = Vector3::z() * dice.between(-3.1, 3.1);
    let rotation = facing * UnitQuaternion::from_scaled_axis(tilt) * UnitQuaternion::from_scaled_axis(roll);
    Isometry3::from_parts((sight * dice.between(0.45, 1.5)).into(), rotation)
}

/// Where the LEDs are seen; `None` where one is not.
pub(crate) fn seen(
    camera: &Camera,
    board_m: &[Vector3<f64>],
    pose: &Isometry3<f64>,
) -> Option<Vec<Vector2<f64>>> {
    let pixel = |place: &Vector3<f64>| {
        let bearing = Bearing::new((pose * Point3::from(*place)).coords)?;
        camera.pixel(&bearing).map(|pixel| Vector2::new(pixel.u, pixel.v))
    };
    board_m.iter().map(pixel).collect()
}

/// Photos of a board made by hand (LEDs off by 0.25 mm), spots off by `sigma_px` along each axis.
pub(crate) fn photos(seed: u64, count: usize, sigma_px: f64) -> Vec<View> {
    let mut dice = Dice::new(seed);
    let grid = Grid::new(7, 5, 0.05).expect("a grid");
    let board_m: Vec<_> =
        grid.nominal_m().iter().map(|place| place + Vector3::from_fn(|_, _| dice.normal(0.00025))).collect();
    let camera = lens();
    let mut views = Vec::new();
    while views.len() < count {
        let pose = pose(&mut dice, 0.85, 0.6);
        let Some(pixels) = seen(&camera, &board_m, &pose) else { continue };
        let observation = |(led, pixel): (usize, Vector2<f64>)| Observation {
            led,
            pixel: pixel + Vector2::from_fn(|_, _| dice.normal(sigma_px)),
        };
        let observations = pixels.into_iter().enumerate().map(observation).collect();
        views.push(View { photo: views.len(), observations });
    }
    views
}

/// Calibrates with the true model and a free board.
pub(crate) fn calibrated(views: &[View]) -> Calibration {
    let grid = Grid::new(7, 5, 0.05).expect("a grid");
    let model = LensModel::kannala_brandt(2).expect("a model");
    let choices = Choices { models: vec![model], board: BoardChoice::Solve };
    calibrate(views, &grid, SIZE_PX, &choices, |_| ()).expect("a calibration")
}

/// Squared errors of bearings over the field, in units of the covariance that the camera claims (2 is what it promises), and the root
/// mean square error, rad; the turn that all have in common is taken out of the errors as the covariance leaves it out.
pub(crate) fn normalised_error(found: &Camera, truth: &Camera) -> (f64, f64) {
    const STEPS: usize = 40;
    let (mut matrix, mut right, mut samples) = (Matrix3::zeros(), Vector3::zeros(), Vec::new());
    for i in 0..STEPS * STEPS {
        let at = |i: usize, side: usize| (i as f64 + 0.5) / STEPS as f64 * side as f64 - 0.5;
        let pixel = Pixel::new(at(i % STEPS, SIZE_PX[0]), at(i / STEPS, SIZE_PX[1]));
        let Some((bearing, by_pixel)) = found.bearing_with_jacobian(pixel) else { continue };
        let Some(expected) = truth.bearing(pixel) else { continue };
        let off = bearing.vector() - expected.vector();
        let solid_angle = by_pixel.column(0).cross(&by_pixel.column(1)).norm();
        matrix += (Matrix3::identity() - bearing.vector() * bearing.vector().transpose()) * solid_angle;
        right -= bearing.vector().cross(&off) * solid_angle;
        samples.push((pixel, *bearing.vector(), off, solid_angle));
    }
    let turn = matrix.try_inverse().expect("a field") * right;
    let (mut normalised, mut squares, mut weights) = (0.0, 0.0, 0.0);
    for (pixel, bearing, off, solid_angle) in samples {
        let off = off + turn.cross(&bearing);
        let covariance = found.calibration_covariance(pixel).expect("a calibrated camera");
        let across =
            bearing.cross(&if bearing.x.abs() < 0.5 { Vector3::x() } else { Vector3::y() }).normalize();
        let down = bearing.cross(&across);
        let entry = |a: &Vector3<f64>, b: &Vector3<f64>| a.dot(&(covariance * b));
        let tangent = Matrix2::new(
            entry(&across, &across),
            entry(&across, &down),
            entry(&down, &across),
            entry(&down, &down),
        );
        let off = Vector2::new(across.dot(&off), down.dot(&off));
        normalised += solid_angle * off.dot(&(tangent.try_inverse().expect("two directions") * off));
        squares += solid_angle * off.norm_squared();
        weights += solid_angle;
    }
    (normalised / weights, (squares / weights).sqrt())
}
