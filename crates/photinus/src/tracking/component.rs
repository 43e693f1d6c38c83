//! One normal distribution of where a vehicle is, how fast and how turned.
//!
//! An error is [position, m; velocity, m/s; rotation in the body frame, rad; yaw rate, rad/s], position and velocity along the camera's axes at the stamp,
//! relative to the camera, which do not rotate.

use nalgebra::{
    Matrix3, Matrix4, Matrix4x6, Matrix6, Rotation3, SMatrix, SVector, Vector3, Vector4, Vector6,
};

use super::power::Power;
use super::silent::Silent;
use crate::pose::{Pose, turn_of};

/// Numbers of a state.
pub(super) const SIZE: usize = 10;
/// An error of the state.
pub(super) type Step = SVector<f64, SIZE>;
/// Its part that is the pose's: [position, m; rotation in the body frame, rad].
pub(super) type PoseStep = Vector6<f64>;
/// The covariance of an error of the state.
pub(super) type Covariance = SMatrix<f64, SIZE, SIZE>;

/// Where an error of the state has that of the pose: position and rotation.
pub(super) const POSE: [usize; 6] = [0, 1, 2, 6, 7, 8];
/// Where it has that of the rates at which the pose changes: velocity and yaw rate.
pub(super) const RATES: [usize; 4] = [3, 4, 5, YAW_RATE];
/// Where it has the yaw, and how fast that changes.
pub(super) const YAW: usize = 8;
pub(super) const YAW_RATE: usize = 9;

/// A normal distribution of the state, with a weight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Component {
    pub(super) weight: f64,
    pub(super) pose: Pose,
    pub(super) velocity_m_s: Vector3<f64>,
    /// How fast it turns about its own vertical axis, rad/s.
    pub(super) yaw_rate_rad_s: f64,
    pub(super) covariance: Covariance,
    /// Which of its markers may be silent.
    pub(super) silent: Silent,
    /// How bright its LEDs are, if it is there.
    pub(super) power: Power,
}

impl Component {
    /// The same, elsewhere.
    pub(super) fn stepped(&self, step: &Step) -> Self {
        let of_pose = PoseStep::from_fn(|axis, _| step[POSE[axis]]);
        let velocity_m_s = self.velocity_m_s + step.fixed_rows::<3>(3);
        let yaw_rate_rad_s = self.yaw_rate_rad_s + step[YAW_RATE];
        Self { pose: pose_after(&self.pose, &of_pose), velocity_m_s, yaw_rate_rad_s, ..*self }
    }

    /// The step that leads to another.
    pub(super) fn step_to(&self, other: &Self) -> Step {
        let of_pose = pose_step(&self.pose, &other.pose);
        let mut step = Step::zeros();
        POSE.into_iter().zip(of_pose.iter()).for_each(|(place, own)| step[place] = *own);
        step.fixed_rows_mut::<3>(3).copy_from(&(other.velocity_m_s - self.velocity_m_s));
        step[YAW_RATE] = other.yaw_rate_rad_s - self.yaw_rate_rad_s;
        step
    }

    /// The same with a turn of its airframe's symmetry: errors of the attitude are along the axes of the body, which turn.
    pub(super) fn turned(&self, symmetric: &Rotation3<f64>) -> Self {
        let mut axes = Covariance::identity();
        axes.fixed_view_mut::<3, 3>(6, 6).copy_from(symmetric.matrix());
        let pose = Pose { camera_from_body: self.pose.camera_from_body * symmetric, ..self.pose };
        Self { pose, covariance: axes.transpose() * self.covariance * axes, ..*self }
    }

    /// The covariance of the pose: position, m, and rotation.
    pub(super) fn pose_covariance(&self) -> Matrix6<f64> {
        Matrix6::from_fn(|line, column| self.covariance[(POSE[line], POSE[column])])
    }

    /// The covariance of the rates, and that of them with the pose.
    pub(super) fn rates_covariances(&self) -> (Matrix4<f64>, Matrix4x6<f64>) {
        (
            Matrix4::from_fn(|line, column| self.covariance[(RATES[line], RATES[column])]),
            Matrix4x6::from_fn(|line, column| self.covariance[(RATES[line], POSE[column])]),
        )
    }

    /// The same with other rates: velocity, then yaw rate.
    pub(super) fn with_rates_off(&self, off: &Vector4<f64>) -> Self {
        let velocity_m_s = self.velocity_m_s + off.fixed_rows::<3>(0);
        Self { velocity_m_s, yaw_rate_rad_s: self.yaw_rate_rad_s + off[3], ..*self }
    }

    /// The variance of the position across a line of sight, m^2, over both axes.
    pub(super) fn aside_m2(&self, ahead: &Vector3<f64>) -> f64 {
        let covariance_m2 = self.block(0);
        covariance_m2.trace() - ahead.dot(&(covariance_m2 * ahead))
    }

    /// The covariance of a part of the state: 0 position, 1 velocity, 2 attitude.
    pub(super) fn block(&self, part: usize) -> Matrix3<f64> {
        self.covariance.fixed_view::<3, 3>(3 * part, 3 * part).into_owned()
    }
}

/// The pose after an error of it.
pub(super) fn pose_after(pose: &Pose, step: &PoseStep) -> Pose {
    let turn = Rotation3::new(step.fixed_rows::<3>(3).into_owned());
    Pose {
        position_m: pose.position_m + step.fixed_rows::<3>(0),
        camera_from_body: pose.camera_from_body * turn,
    }
}

/// The error of a pose that leads to another.
pub(super) fn pose_step(from: &Pose, to: &Pose) -> PoseStep {
    let mut step = PoseStep::zeros();
    step.fixed_rows_mut::<3>(0).copy_from(&(to.position_m - from.position_m));
    let turn = turn_of(&(from.camera_from_body.inverse() * to.camera_from_body));
    step.fixed_rows_mut::<3>(3).copy_from(&turn);
    step
}

/// The one normal distribution with the mean and covariance of several, at their weight; `None` of none.
pub(super) fn merged<'a>(all: impl Iterator<Item = &'a Component> + Clone) -> Option<Component> {
    let heaviest = all.clone().reduce(|best, next| if next.weight > best.weight { next } else { best })?;
    let weight: f64 = all.clone().map(|component| component.weight).sum();
    if weight <= 0.0 {
        return Some(*heaviest);
    }
    let (mut mean, mut square) = (Step::zeros(), Covariance::zeros());
    let (mut silent, mut power) = (Silent::NONE, Power::UNKNOWN);
    for component in all {
        let (off, share) = (heaviest.step_to(component), component.weight / weight);
        mean += off * share;
        silent.add(&component.silent, share);
        power.add(&component.power, share);
        square += (component.covariance + off * off.transpose()) * share;
    }
    Some(Component {
        weight,
        covariance: square - mean * mean.transpose(),
        silent,
        power,
        ..heaviest.stepped(&mean)
    })
}

#[cfg(test)]
impl Component {
    /// A vehicle at a place that is known to so much, everything else to one unit.
    pub(super) fn somewhere(position_m: Vector3<f64>, sigma_m: f64) -> Self {
        let mut covariance = Covariance::identity();
        covariance.fixed_view_mut::<3, 3>(0, 0).copy_from(&Matrix3::from_diagonal_element(sigma_m * sigma_m));
        Self {
            weight: 1.0,
            pose: Pose { position_m, camera_from_body: Rotation3::identity() },
            velocity_m_s: Vector3::zeros(),
            yaw_rate_rad_s: 0.0,
            covariance,
            silent: Silent::BEFOREHAND,
            power: Power::UNKNOWN,
        }
    }
}
