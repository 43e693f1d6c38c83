//! Where a marker is and how it moves, on the plane that touches the sphere of directions at its bearing.
//!
//! The plane goes along: with the observer's rotation and along the great circle on which the marker moves. So the mean lies always at
//! its origin, the rate keeps its components (parallel transport), and the covariance is that of a motion in a plane.

use nalgebra::{Matrix2, Matrix3, Matrix3x2, Rotation3, Vector2, Vector3};

use crate::camera::Bearing;

/// Bearing and rate with their covariance; a motion of constant rate with white acceleration.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Motion {
    /// Two axes of the plane and the bearing, as columns: right-handed.
    axes: Matrix3<f64>,
    rate_rad_s: Vector2<f64>,
    covariance: Covariance,
}

/// Of bearing and rate on the axes of a plane, in blocks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Covariance {
    /// rad^2.
    pub(super) bearing: Matrix2<f64>,
    /// Bearing by rate, rad^2/s.
    pub(super) cross: Matrix2<f64>,
    /// rad^2/s^2.
    pub(super) rate: Matrix2<f64>,
}

/// Where a sighting lies from the origin of a plane, and how unsure that is.
#[derive(Clone, Copy, Debug)]
pub(super) struct Offset {
    /// rad.
    pub(super) value: Vector2<f64>,
    /// rad^2.
    pub(super) noise: Matrix2<f64>,
}

impl Motion {
    /// A marker seen once, of which nothing is known but how fast markers are.
    pub(super) fn new(bearing: &Bearing, covariance_rad2: &Matrix3<f64>, rate_sigma_rad_s: f64) -> Self {
        let ahead = *bearing.vector();
        // the axis of the camera that is the farthest from the bearing
        let aside = if ahead.x * ahead.x < 0.5 { Vector3::x() } else { Vector3::y() };
        let axes = upright(aside, ahead);
        let mut motion = Self {
            axes,
            rate_rad_s: Vector2::zeros(),
            covariance: Covariance {
                bearing: Matrix2::zeros(),
                cross: Matrix2::zeros(),
                rate: Matrix2::identity() * (rate_sigma_rad_s * rate_sigma_rad_s),
            },
        };
        motion.covariance.bearing = motion.on_plane(covariance_rad2);
        motion
    }

    /// Unit vector of the bearing.
    pub(super) fn ahead(&self) -> Vector3<f64> {
        self.axes.column(2).into_owned()
    }

    /// The axes of the plane.
    pub(super) fn axes(&self) -> Matrix3x2<f64> {
        self.axes.fixed_columns::<2>(0).into_owned()
    }

    /// How fast the bearing moves, rad/s: tangent to the sphere.
    pub(super) fn rate_rad_s(&self) -> Vector3<f64> {
        self.axes() * self.rate_rad_s
    }

    /// The rate on the axes of the plane.
    pub(super) fn rate_on_plane(&self) -> Vector2<f64> {
        self.rate_rad_s
    }

    /// A part of the rate turns out not to be the marker's.
    pub(super) fn take_from_rate(&mut self, part_rad_s: Vector2<f64>) {
        self.rate_rad_s -= part_rad_s;
    }

    pub(super) fn covariance(&self) -> &Covariance {
        &self.covariance
    }

    /// Time passes, with accelerations of this spectral density each way.
    pub(super) fn wait(&mut self, passed_s: f64, acceleration_rad2_s3: f64) {
        let noise = |factor: f64| Matrix2::identity() * (acceleration_rad2_s3 * factor);
        let Covariance { bearing, cross, rate } = &mut self.covariance;
        let square_s2 = passed_s * passed_s;
        *bearing +=
            (*cross + cross.transpose()) * passed_s + *rate * square_s2 + noise(square_s2 * passed_s / 3.0);
        *cross += *rate * passed_s + noise(square_s2 / 2.0);
        *rate += noise(passed_s);
        self.shift(self.rate_rad_s * passed_s);
    }

    /// The observer turned.
    pub(super) fn turn(&mut self, now_from_before: &Rotation3<f64>) {
        self.axes = now_from_before.matrix() * self.axes;
        self.axes = upright(self.axes.column(0).into_owned(), self.ahead());
    }

    /// By a rotation that is known with this covariance, rad^2.
    pub(super) fn blur(&mut self, turn_rad2: &Matrix3<f64>) {
        let by_turn = self.by_turn();
        self.covariance.bearing += by_turn.transpose() * turn_rad2 * by_turn;
    }

    /// Derivative of the place on the plane by a small rotation of the observer's axes, transposed.
    pub(super) fn by_turn(&self) -> Matrix3x2<f64> {
        Matrix3x2::from_columns(&[self.axes.column(1).into_owned(), -self.axes.column(0)])
    }

    /// Where a sighting lies on the plane.
    pub(super) fn offset(&self, bearing: &Bearing, covariance_rad2: &Matrix3<f64>) -> Offset {
        Offset { value: self.axes().transpose() * bearing.vector(), noise: self.on_plane(covariance_rad2) }
    }

    /// What is known when each of these sightings is the marker's with its probability, and none with what is left: mean and covariance of
    /// the mixture.
    pub(super) fn update(&mut self, sightings: impl Iterator<Item = (f64, Offset)>) {
        let prior = self.covariance;
        let mut none = 1.0;
        let (mut moved, mut hastened) = (Vector2::zeros(), Vector2::zeros());
        let mut all =
            Covariance { bearing: Matrix2::zeros(), cross: Matrix2::zeros(), rate: Matrix2::zeros() };
        for (probability, Offset { value, noise }) in sightings {
            let Some(inverse) = (prior.bearing + noise).try_inverse() else { continue };
            let (gain, rate_gain) = (prior.bearing * inverse, prior.cross.transpose() * inverse);
            let (by, hasten) = (gain * value, rate_gain * value);
            none -= probability;
            moved += by * probability;
            hastened += hasten * probability;
            all.bearing += (prior.bearing - gain * prior.bearing + by * by.transpose()) * probability;
            all.cross += (prior.cross - gain * prior.cross + by * hasten.transpose()) * probability;
            all.rate += (prior.rate - rate_gain * prior.cross + hasten * hasten.transpose()) * probability;
        }
        let none = none.max(0.0);
        all.bearing += prior.bearing * none - moved * moved.transpose();
        all.cross += prior.cross * none - moved * hastened.transpose();
        all.rate += prior.rate * none - hastened * hastened.transpose();
        let symmetric = |matrix: Matrix2<f64>| (matrix + matrix.transpose()) * 0.5;
        self.covariance =
            Covariance { bearing: symmetric(all.bearing), cross: all.cross, rate: symmetric(all.rate) };
        self.rate_rad_s += hastened;
        self.shift(moved);
    }

    fn on_plane(&self, covariance_rad2: &Matrix3<f64>) -> Matrix2<f64> {
        let axes = self.axes();
        axes.transpose() * covariance_rad2 * axes
    }

    /// Moves the plane along a great circle, by an angle small enough for two terms of its tangent.
    fn shift(&mut self, by_rad: Vector2<f64>) {
        let long = 1.0 + by_rad.norm_squared() / 3.0;
        let ahead = self.ahead() + self.axes() * (by_rad * long);
        self.axes = upright(self.axes.column(0).into_owned(), ahead);
    }
}

/// Right-handed unit axes: the last along `ahead`, the first as near to `aside` as that allows.
fn upright(aside: Vector3<f64>, ahead: Vector3<f64>) -> Matrix3<f64> {
    let ahead = ahead / ahead.norm();
    let aside = aside - ahead * ahead.dot(&aside);
    let aside = aside / aside.norm();
    Matrix3::from_columns(&[aside, ahead.cross(&aside), ahead])
}
