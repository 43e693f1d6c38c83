//! Why LEDs are not an airframe.

use super::{Airframe, Led, LobeError};

/// Why a list of LEDs or a ring is not an airframe. LEDs are counted from 0.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum AirframeError {
    /// Nothing that shines.
    #[error("no LED: an airframe has at least one")]
    NoLed,
    /// A ring so small that its LEDs are seen as one.
    #[error("{leds} LEDs of a ring form {markers} marker: they must be 3 cm or more apart")]
    TooFewMarkers {
        /// LEDs given.
        leds: usize,
        /// Markers that they form.
        markers: usize,
    },
    /// More LEDs than an airframe may have.
    #[error("{leds} LEDs: at most {max} are allowed", max = Airframe::MAX_LEDS)]
    TooManyLeds {
        /// LEDs asked for.
        leds: usize,
    },
    /// A coordinate that is not a number, or infinite.
    #[error("LED {led} has a coordinate that is not finite")]
    NotFinite {
        /// Which LED.
        led: usize,
    },
    /// An axis whose length is not 1.
    #[error("the axis of LED {led} is not a unit vector")]
    Axis {
        /// Which LED.
        led: usize,
    },
    /// A power that no LED has against others.
    #[error("LED {led} has a power of {power}: {} to {} are possible, 1 is the mean of its kind", Led::POWERS[0], Led::POWERS[1])]
    Power {
        /// Which LED.
        led: usize,
        /// Its power.
        power: f64,
    },
    /// A lobe that no LED has.
    #[error("LED {led}: {error}")]
    Lobe {
        /// Which LED.
        led: usize,
        /// What is wrong with its lobe.
        error: LobeError,
    },
    /// An LED beyond [`Airframe::MAX_REACH_M`].
    #[error("LED {led} sits {distance_m} m from the origin, {max} m at most: are the positions in metres?", max = Airframe::MAX_REACH_M)]
    TooFar {
        /// Which LED.
        led: usize,
        /// Its distance from the origin, m.
        distance_m: f64,
    },
    /// The same LED listed twice.
    #[error("LEDs {first} and {second} have the same position and axis: remove one")]
    Duplicate {
        /// The earlier LED.
        first: usize,
        /// The later LED.
        second: usize,
    },
    /// A ring with fewer than three arms.
    #[error("a ring of {arms} arm(s): it needs at least 3")]
    RingArms {
        /// Arms given.
        arms: usize,
    },
    /// A ring whose radius is not a positive length.
    #[error("a ring with a radius of {radius_m} m: it must be above 0 and at most {max} m", max = Airframe::MAX_REACH_M)]
    RingRadius {
        /// Radius given, m.
        radius_m: f64,
    },
    /// A ring with neither one nor two LEDs on an arm.
    #[error("a ring with {leds_per_arm} LEDs on an arm: it takes 1 or 2")]
    RingLeds {
        /// LEDs per arm given.
        leds_per_arm: usize,
    },
    /// A splay that the LEDs of an arm cannot have.
    #[error(
        "a splay of {splay_rad} rad with {leds_per_arm} LED(s) on an arm: one LED takes 0, two take above 0 up to pi"
    )]
    RingSplay {
        /// LEDs per arm given.
        leds_per_arm: usize,
        /// Splay given, rad.
        splay_rad: f64,
    },
}
