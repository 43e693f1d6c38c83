//! One LED: where it sits, where it shines and how much.

use nalgebra::{Unit, Vector3};

use super::{Airframe, AirframeError, Lobe};

/// One LED in the body frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Led {
    /// Where it sits, m.
    pub position_m: Vector3<f64>,
    /// Where it shines.
    pub axis: Unit<Vector3<f64>>,
    /// How its light falls off to the side.
    pub lobe: Lobe,
    /// How much it shines against the others of its kind: 1 is the mean part. Within [`Led::POWERS`].
    pub power: f64,
    /// Which of the airframe's blink signals it carries, if it blinks.
    pub signal: Option<u32>,
}

impl Led {
    /// The least and the largest power.
    pub const POWERS: [f64; 2] = [1e-3, 1e3];

    /// Intensity towards a camera at `camera_m` (body frame, m); 1 is that of an LED of power 1 straight ahead.
    pub fn intensity(&self, camera_m: &Vector3<f64>) -> f64 {
        let ray_m = camera_m - self.position_m;
        let distance_m = ray_m.norm();
        if !(distance_m.is_finite() && distance_m > 0.0) {
            return 0.0;
        }
        self.power * self.lobe.intensity(self.axis.dot(&ray_m) / distance_m)
    }

    /// [`Led::intensity`] with its derivative by the camera's place, 1/m.
    pub(super) fn intensity_with_gradient(&self, camera_m: &Vector3<f64>) -> (f64, Vector3<f64>) {
        let ray_m = camera_m - self.position_m;
        let distance_m = ray_m.norm();
        if !(distance_m.is_finite() && distance_m > 0.0) {
            return (0.0, Vector3::zeros());
        }
        let cos = self.axis.dot(&ray_m) / distance_m;
        let (share, by_cos) = self.lobe.intensity_with_slope(cos);
        let cos_gradient = (self.axis.into_inner() - ray_m * (cos / distance_m)) / distance_m;
        (self.power * share, cos_gradient * (self.power * by_cos))
    }
}

/// Refuses LEDs that no airframe can have.
pub(super) fn check(leds: &[Led]) -> Result<(), AirframeError> {
    if leds.len() > Airframe::MAX_LEDS {
        return Err(AirframeError::TooManyLeds { leds: leds.len() });
    }
    for (index, led) in leds.iter().enumerate() {
        if !led.position_m.iter().chain(led.axis.iter()).all(|number| number.is_finite()) {
            return Err(AirframeError::NotFinite { led: index });
        }
        if (led.axis.norm() - 1.0).abs() > 1e-6 {
            return Err(AirframeError::Axis { led: index });
        }
        if !(Led::POWERS[0]..=Led::POWERS[1]).contains(&led.power) {
            return Err(AirframeError::Power { led: index, power: led.power });
        }
        led.lobe.check().map_err(|error| AirframeError::Lobe { led: index, error })?;
        let distance_m = led.position_m.norm();
        if distance_m > Airframe::MAX_REACH_M {
            return Err(AirframeError::TooFar { led: index, distance_m });
        }
        let same = |other: &Led| other.position_m == led.position_m && other.axis == led.axis;
        if let Some(first) = leds[..index].iter().position(same) {
            return Err(AirframeError::Duplicate { first, second: index });
        }
    }
    Ok(())
}
