//! What lobes are learned as: those that depend on the direction become a power of the cosine, one for all LEDs of a kind.

use photinus::airframe::{Airframe, Lobe};

/// Prior of the logarithm of a power of the cosine.
pub(super) const COSINE_SIGMA: f64 = 1.5;

/// The lobe of LEDs of one kind.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Shape {
    /// Which LEDs.
    pub(super) leds: Vec<usize>,
    /// What the airframe's file says.
    told: Lobe,
    /// Logarithm of the power of the cosine; `None` for what shines in every direction, which is not learned.
    pub(super) log_power: Option<f64>,
}

/// The kinds of lobes of an airframe.
pub(super) fn kinds(airframe: &Airframe) -> Vec<Shape> {
    let mut kinds: Vec<Shape> = Vec::new();
    for (number, led) in airframe.leds().iter().enumerate() {
        match kinds.iter_mut().find(|kind| kind.told == led.lobe) {
            Some(kind) => kind.leds.push(number),
            None => kinds.push(Shape {
                leds: vec![number],
                told: led.lobe.clone(),
                log_power: told_log_power(&led.lobe),
            }),
        }
    }
    kinds
}

fn told_log_power(told: &Lobe) -> Option<f64> {
    match told {
        Lobe::Omni => None,
        Lobe::Lambertian | Lobe::Table(_) => Some(0.0),
        Lobe::Cosine { power } => Some(libm::log(*power)),
    }
}

impl Shape {
    /// The same with a power of the cosine larger by a factor.
    #[must_use]
    pub(super) fn narrowed(self, factor: f64) -> Self {
        Self { log_power: self.log_power.map(|log| log + libm::log(factor)), ..self }
    }

    /// How far the logarithm of the power is from what the file says, where it is learned.
    pub(super) fn off_told(&self) -> Option<f64> {
        Some(self.log_power? - told_log_power(&self.told)?)
    }

    /// The lobe.
    pub(super) fn lobe(&self) -> Lobe {
        let [least, most] = Lobe::COSINE_POWERS;
        match self.log_power {
            Some(log) => Lobe::Cosine { power: libm::exp(log).clamp(least, most) },
            None => self.told.clone(),
        }
    }

    /// Derivative of the logarithm of the intensity by that of the power, at a cosine above 0.
    pub(super) fn slope(&self, cos: f64) -> f64 {
        self.log_power.map_or(0.0, |log| libm::exp(log) * libm::log(cos))
    }
}
