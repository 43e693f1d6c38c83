//! Bearings over the field: how sure they are, and how far two calibrations differ.

use nalgebra::{Matrix3, Vector2, Vector3};
use photinus::camera::{Bearing, Camera};

use super::Calibration;
use crate::lens::Lens;
use crate::solve::reach_rad;

/// Width of a ring of the field, rad.
pub const RING_RAD: f64 = 10.0 * std::f64::consts::PI / 180.0;
/// Distance between neighbouring samples, rad.
const STEP_RAD: f64 = RING_RAD / 2.0;

/// Directions spread evenly over the field that the photos cover, where the image shows them.
#[derive(Clone, Debug)]
pub struct Field {
    samples: Vec<Sample>,
    reach_rad: f64,
}

/// A direction of the field.
#[derive(Clone, Copy, Debug)]
struct Sample {
    pixel: Vector2<f64>,
    off_axis_rad: f64,
    /// Its share of the field, sr.
    solid_angle: f64,
}

/// A ring of the field, `from_rad` to `to_rad` off the axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ring {
    /// Where it begins, rad off the axis.
    pub from_rad: f64,
    /// Where it ends, rad off the axis.
    pub to_rad: f64,
    /// Root mean square over its directions of an angle (both axes together), rad.
    pub rms_rad: f64,
}

/// How far two lenses differ, without the turn that they have in common.
#[derive(Clone, Debug)]
pub struct Difference {
    /// Pixel, and how far the bearing there moves, rad; directions that one of the lenses does not see are missing.
    pub moves: Vec<(Vector2<f64>, Vector3<f64>)>,
    off_axis_rad: Vec<f64>,
}

impl Field {
    /// The field of a camera out to `reach_rad`.
    pub fn of(camera: &Camera, reach_rad: f64) -> Self {
        let mut samples = Vec::new();
        let rings = (reach_rad / STEP_RAD).ceil() as usize;
        for ring in 0..rings {
            let (from, to) = (ring as f64 * STEP_RAD, ((ring + 1) as f64 * STEP_RAD).min(reach_rad));
            let off_axis_rad = 0.5 * (from + to);
            let (sin, cos) = libm::sincos(off_axis_rad);
            let around = ((2.0 * std::f64::consts::PI * sin / STEP_RAD).ceil() as usize).max(6);
            let share = 2.0 * std::f64::consts::PI * (libm::cos(from) - libm::cos(to)) / around as f64;
            for i in 0..around {
                let (y, x) = libm::sincos(2.0 * std::f64::consts::PI * (i as f64 + 0.5) / around as f64);
                let direction = Bearing::new(Vector3::new(sin * x, sin * y, cos));
                if let Some(pixel) = direction.and_then(|direction| camera.pixel(&direction)) {
                    let pixel = Vector2::new(pixel.u, pixel.v);
                    samples.push(Sample { pixel, off_axis_rad, solid_angle: share });
                }
            }
        }
        Self { samples, reach_rad }
    }

    /// Mean over the field of the variance of a bearing (both axes together) by the camera's calibration, rad^2.
    pub(super) fn mean_variance(&self, camera: &Camera) -> f64 {
        let (mut sum, mut weights) = (0.0, 0.0);
        for sample in &self.samples {
            if let Some(covariance) = camera.calibration_covariance(pixel(sample)) {
                sum += sample.solid_angle * covariance.trace();
                weights += sample.solid_angle;
            }
        }
        sum / weights
    }

    /// Sigma of bearings, ring by ring, as the camera's calibration says.
    pub fn claimed(&self, camera: &Camera) -> Vec<Ring> {
        let variances = self.samples.iter().filter_map(|sample| {
            let covariance = camera.calibration_covariance(pixel(sample))?;
            Some((sample.off_axis_rad, covariance.trace()))
        });
        self.rings(variances)
    }

    /// How far the bearings of `other` are from those of `one`.
    pub fn difference(&self, one: &Lens, other: &Lens) -> Difference {
        let limit = |lens: &Lens| lens.rises_to_rad((self.reach_rad + 0.2).min(3.1));
        let (limit_one, limit_other) = (limit(one), limit(other));
        let mut moves = Vec::new();
        for sample in &self.samples {
            let bearings = (one.bearing(&sample.pixel, limit_one), other.bearing(&sample.pixel, limit_other));
            if let (Some(a), Some(b)) = bearings {
                moves.push((*sample, a, b - a));
            }
        }
        let (mut matrix, mut right) = (Matrix3::zeros(), Vector3::zeros());
        for (sample, bearing, off) in &moves {
            matrix += (Matrix3::identity() - bearing * bearing.transpose()) * sample.solid_angle;
            right -= bearing.cross(off) * sample.solid_angle;
        }
        let turn = matrix.try_inverse().map_or_else(Vector3::zeros, |inverse| inverse * right);
        Difference {
            off_axis_rad: moves.iter().map(|(sample, ..)| sample.off_axis_rad).collect(),
            moves: moves
                .iter()
                .map(|(sample, bearing, off)| (sample.pixel, off + turn.cross(bearing)))
                .collect(),
        }
    }

    /// Differences ring by ring.
    pub fn rings_of(&self, difference: &Difference) -> Vec<Ring> {
        let squares = difference.moves.iter().map(|(_, off)| off.norm_squared());
        self.rings(difference.off_axis_rad.iter().copied().zip(squares))
    }

    /// The scatter of lenses about `middle`, ring by ring.
    pub fn scatter(&self, middle: &Lens, lenses: &[Lens]) -> Vec<Ring> {
        let differences: Vec<Difference> = lenses.iter().map(|lens| self.difference(middle, lens)).collect();
        let squares = differences.iter().flat_map(|difference| {
            let squares = difference.moves.iter().map(|(_, off)| off.norm_squared());
            difference.off_axis_rad.iter().copied().zip(squares)
        });
        self.rings(squares)
    }

    /// Root means of squares by ring.
    fn rings(&self, squares: impl Iterator<Item = (f64, f64)>) -> Vec<Ring> {
        let count = (self.reach_rad / RING_RAD).ceil() as usize;
        let mut sums = vec![(0.0, 0.0); count];
        for (off_axis_rad, square) in squares {
            if let Some(sum) = sums.get_mut((off_axis_rad / RING_RAD) as usize) {
                sum.0 += square;
                sum.1 += 1.0;
            }
        }
        let ring = |(index, (sum, count)): (usize, (f64, f64))| Ring {
            from_rad: index as f64 * RING_RAD,
            to_rad: ((index + 1) as f64 * RING_RAD).min(self.reach_rad),
            rms_rad: if count > 0.0 { (sum / count).sqrt() } else { f64::NAN },
        };
        sums.into_iter().enumerate().map(ring).collect()
    }
}

fn pixel(sample: &Sample) -> photinus::camera::Pixel {
    photinus::camera::Pixel::new(sample.pixel.x, sample.pixel.y)
}

impl Calibration {
    /// The field that the photos cover.
    pub fn field(&self) -> Field {
        Field::of(self.camera(), self.reach_rad())
    }

    /// The angle off the axis of the outermost LED, rad.
    pub fn reach_rad(&self) -> f64 {
        reach_rad(self.views(), self.scene())
    }
}
