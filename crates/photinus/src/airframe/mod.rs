//! Where the LEDs of a neighbour sit and how they shine.
//!
//! A list of LEDs (or a [`Ring`] that stands for one) enters; an [`Airframe`] leaves: its *markers*, the
//! places that a camera sees as one spot, and how brightly each shines towards a camera. Everything is in the
//! body frame (x forward, y left, z up). A single marker is ranged by its size alone, and its attitude is not told.

mod error;
mod led;
mod lobe;
mod marker;
mod ring;
mod symmetry;

use alloc::string::String;
use alloc::vec::Vec;

use nalgebra::{Rotation3, Vector3};

pub use error::AirframeError;
pub use led::Led;
pub use lobe::{Lobe, LobeError, LobeTable};
pub use marker::{MARKER_GAP_M, Marker};
pub use ring::{Ring, RingGeometry};

/// A neighbour's LEDs, checked, and the markers they form.
#[derive(Clone, Debug, PartialEq)]
pub struct Airframe {
    name: String,
    leds: Vec<Led>,
    markers: Vec<Marker>,
    ring: Option<RingGeometry>,
    max_radius_m: f64,
}

impl Airframe {
    /// Most LEDs that an airframe may have.
    pub const MAX_LEDS: usize = 256;
    /// Farthest that an LED may sit from the body's origin, m.
    pub const MAX_REACH_M: f64 = 100.0;

    /// An airframe from its LEDs; those closer than [`MARKER_GAP_M`], transitively, form one marker.
    ///
    /// # Errors
    /// [`AirframeError`] for more than [`Self::MAX_LEDS`], for an LED that is not finite, has no axis, sits too far
    /// out or appears twice, and for a list without LEDs.
    pub fn new(name: impl Into<String>, leds: Vec<Led>) -> Result<Self, AirframeError> {
        led::check(&leds)?;
        if leds.is_empty() {
            return Err(AirframeError::NoLed);
        }
        let markers = marker::group(&leds);
        let ring = RingGeometry::detect(&markers);
        let max_radius_m = markers.iter().map(|marker| marker.position_m.norm()).fold(0.0, f64::max);
        Ok(Self { name: name.into(), leds, markers, ring, max_radius_m })
    }

    /// An airframe with its LEDs on a regular ring.
    ///
    /// # Errors
    /// [`AirframeError`] when the ring itself is impossible, or as [`Airframe::new`].
    pub fn from_ring(name: impl Into<String>, ring: Ring) -> Result<Self, AirframeError> {
        let airframe = Self::new(name, ring.leds()?)?;
        match airframe.markers.len() {
            markers @ ..2 => Err(AirframeError::TooFewMarkers { leds: airframe.leds.len(), markers }),
            _ => Ok(airframe),
        }
    }

    /// What the airframe is called.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The LEDs, in the order given.
    pub fn leds(&self) -> &[Led] {
        &self.leds
    }

    /// The markers, in the order of their first LEDs; at least one.
    pub fn markers(&self) -> &[Marker] {
        &self.markers
    }

    /// The regular ring that the markers form, if they do: what the paper's equations need.
    pub fn ring(&self) -> Option<RingGeometry> {
        self.ring
    }

    /// How many turns about the z axis, each by the same part of a circle, leave the airframe as it was: at least 1.
    pub(crate) fn turns(&self) -> usize {
        symmetry::turns(self)
    }

    /// Whether the LEDs below the plane z = 0 mirror those above.
    pub(crate) fn is_mirrored(&self) -> bool {
        symmetry::is_mirrored(self)
    }

    /// Largest distance of a marker from the body's origin, m.
    pub fn max_radius_m(&self) -> f64 {
        self.max_radius_m
    }

    /// The attitude, upright against `up`, in which a marker shines at a camera that sees the airframe in the direction `ahead`.
    pub(crate) fn facing(&self, marker: usize, ahead: &Vector3<f64>, up: &Vector3<f64>) -> Rotation3<f64> {
        let marker = &self.markers()[marker];
        let axes: Vector3<f64> = marker.leds.iter().map(|&led| self.leds()[led].axis.into_inner()).sum();
        let shines = if axes.xy().norm() > 0.1 { axes } else { marker.position_m };
        let yaw_rad = libm::atan2(shines.y, shines.x);
        // Body x towards the camera, as far as that is level.
        let level = |towards: Vector3<f64>| towards - up * towards.dot(up);
        let towards = level(-ahead).try_normalize(1e-3).or_else(|| level(Vector3::z()).try_normalize(1e-3));
        let towards = towards.unwrap_or_else(|| level(Vector3::x()).normalize());
        let upright = Rotation3::from_basis_unchecked(&[towards, up.cross(&towards), *up]);
        upright * Rotation3::from_axis_angle(&Vector3::z_axis(), -yaw_rad)
    }

    /// How brightly marker `marker` shines towards a camera at `camera_m` (body frame, m): the sum of its
    /// LEDs' powers times their lobes, each at its own angle to the camera. 1 is one LED of power 1 straight ahead; the
    /// falling off with distance is not included. 0 for a marker that does not exist or a camera that is not somewhere.
    pub fn intensity(&self, marker: usize, camera_m: &Vector3<f64>) -> f64 {
        let leds = self.markers.get(marker).map_or(&[][..], |marker| &marker.leds);
        leds.iter().map(|&led| self.leds[led].intensity(camera_m)).sum()
    }

    /// [`Airframe::intensity`] with its derivative by the camera's place (body frame), 1/m.
    pub fn intensity_with_gradient(&self, marker: usize, camera_m: &Vector3<f64>) -> (f64, Vector3<f64>) {
        let leds = self.markers.get(marker).map_or(&[][..], |marker| &marker.leds);
        leds.iter().fold((0.0, Vector3::zeros()), |(sum, slope), &led| {
            let (intensity, gradient) = self.leds[led].intensity_with_gradient(camera_m);
            (sum + intensity, slope + gradient)
        })
    }

    /// Whether marker `marker` shines at all towards a camera at `camera_m` (body frame, m).
    pub fn is_visible(&self, marker: usize, camera_m: &Vector3<f64>) -> bool {
        self.intensity(marker, camera_m) > 0.0
    }

    /// Indices of the markers that shine towards a camera at `camera_m` (body frame, m).
    pub fn visible(&self, camera_m: Vector3<f64>) -> impl Iterator<Item = usize> + '_ {
        (0..self.markers.len()).filter(move |&marker| self.is_visible(marker, &camera_m))
    }
}

#[cfg(test)]
mod tests;
