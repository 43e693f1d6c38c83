//! One LED: where it sits, where it shines, how its light falls off to the side.

use nalgebra::{Unit, Vector3};

use super::{Airframe, AirframeError};

/// How the light of an LED falls off with the angle to its axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lobe {
    /// The cosine of the angle, nothing past 90 deg: a bare LED (the paper's figure 8).
    Lambertian,
    /// The same in every direction: an LED under a diffuser.
    Omni,
}

/// One LED in the body frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Led {
    /// Where it sits, m.
    pub position_m: Vector3<f64>,
    /// Where it shines.
    pub axis: Unit<Vector3<f64>>,
    /// How its light falls off to the side.
    pub lobe: Lobe,
    /// Which of the airframe's blink signals it carries, if it blinks.
    pub signal: Option<u32>,
}

impl Led {
    /// Intensity towards a camera at `camera_m` (body frame, m), as a share of that on the axis: 0 to 1.
    pub fn intensity(&self, camera_m: &Vector3<f64>) -> f64 {
        let ray_m = camera_m - self.position_m;
        let distance_m = ray_m.norm();
        if !(distance_m.is_finite() && distance_m > 0.0) {
            return 0.0;
        }
        match self.lobe {
            Lobe::Lambertian => (self.axis.dot(&ray_m) / distance_m).max(0.0),
            Lobe::Omni => 1.0,
        }
    }

    /// [`Led::intensity`] with its derivative by the camera's place, 1/m.
    pub(super) fn intensity_with_gradient(&self, camera_m: &Vector3<f64>) -> (f64, Vector3<f64>) {
        let intensity = self.intensity(camera_m);
        if self.lobe == Lobe::Omni || intensity <= 0.0 {
            return (intensity, Vector3::zeros());
        }
        let ray_m = camera_m - self.position_m;
        let distance_m = ray_m.norm();
        (intensity, (self.axis.into_inner() - ray_m * (intensity / distance_m)) / distance_m)
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
