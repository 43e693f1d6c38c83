//! One assignment of the spots of a neighbour to markers, and what its cost is written in.
//!
//! A step is dimensionless, [delta; omega]: position += distance * delta, camera_from_body *= exp(omega), so that delta is
//! along the camera's axes and omega along the body's: omega_z is yaw. In these coordinates the prior on position is flat,
//! which is the prior that prefers no direction and no scale: even over the sphere and over the logarithm of distance.

use nalgebra::{Matrix6, Rotation3, Vector3, Vector6};

use super::known::Known;
use super::observation::{Observation, Whitened};
use super::settings::Settings;
use crate::airframe::Airframe;

/// Where an airframe is and how it is turned, in the camera frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// The airframe's origin, m.
    pub position_m: Vector3<f64>,
    /// Its attitude: maps the body's coordinates to the camera's.
    pub camera_from_body: Rotation3<f64>,
}

impl Pose {
    /// The pose after a step [delta; omega].
    pub(super) fn stepped(&self, step: &Vector6<f64>) -> Self {
        let distance_m = self.position_m.norm();
        let [delta, omega] = [step.fixed_rows::<3>(0), step.fixed_rows::<3>(3)];
        Self {
            position_m: self.position_m + distance_m * delta,
            camera_from_body: self.camera_from_body * Rotation3::new(omega.into_owned()),
        }
    }

    /// Where the camera is in the body frame, m.
    pub fn camera_in_body_m(&self) -> Vector3<f64> {
        -(self.camera_from_body.inverse() * self.position_m)
    }
}

/// What becomes of markers beside each other in the image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Merging {
    /// They are far from each other: one without a spot is dark.
    Far,
    /// One without a spot shines into those beside it.
    Near,
    /// One without a spot is dark, also beside one.
    Dark,
}

/// One assignment of spots to markers.
#[derive(Clone, Copy, Debug)]
pub(super) struct Problem<'a> {
    pub(super) airframe: &'a Airframe,
    pub(super) settings: &'a Settings,
    pub(super) observations: &'a [Observation],
    pub(super) whitened: &'a [Whitened],
    /// The marker of each spot; `None` for a spot that is not used.
    pub(super) markers: &'a [Option<u16>],
    pub(super) known: &'a Known<'a>,
    pub(super) merging: Merging,
    /// In so many frames what errs alike from frame to frame is the same, 1 where each is looked at by itself.
    pub(super) repeats: f64,
}

/// The cost of a pose, nats, with gradient and Gauss-Newton information for a step [delta; omega].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Normal {
    pub(crate) nats: f64,
    pub(crate) gradient: Vector6<f64>,
    pub(crate) information: Matrix6<f64>,
    /// Logarithm of the light of an LED of intensity 1 at 1 m that fits best; `None` where no spot has a light.
    pub(crate) log_power: Option<f64>,
}

impl Normal {
    pub(super) fn zero() -> Self {
        Self { nats: 0.0, gradient: Vector6::zeros(), information: Matrix6::zeros(), log_power: None }
    }

    /// Adds a residual of unit variance with its row of derivatives.
    pub(super) fn add(&mut self, residual: f64, row: &Vector6<f64>) {
        self.nats += 0.5 * residual * residual;
        self.add_weighted(1.0, residual, row);
    }

    /// Adds a row to gradient and information with a weight, and nothing to the cost.
    pub(super) fn add_weighted(&mut self, weight: f64, residual: f64, row: &Vector6<f64>) {
        for column in 0..6 {
            let scaled = weight * row[column];
            self.gradient[column] += scaled * residual;
            for line in 0..=column {
                self.information[(line, column)] += scaled * row[line];
            }
        }
    }

    pub(super) fn finish(&mut self) {
        self.information.fill_lower_triangle_with_upper_triangle();
    }
}

impl Problem<'_> {
    /// The spots in use with the marker of each.
    pub(super) fn used(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        let marker = |(spot, marker): (usize, &Option<u16>)| marker.map(|marker| (spot, usize::from(marker)));
        self.markers.iter().enumerate().filter_map(marker)
    }

    /// Whether a marker has a spot.
    pub(super) fn is_used(&self, marker: usize) -> bool {
        self.markers.contains(&u16::try_from(marker).ok())
    }
}
