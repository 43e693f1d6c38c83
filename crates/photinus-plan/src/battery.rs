//! What the light costs: LEDs that shine all the time, against what hovering takes.

use serde::Serialize;

use crate::setup::Setup;

/// What the light costs.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Battery {
    /// Power of all LEDs with their drivers, W. Words that are on half of the time take half of it.
    pub light_w: f64,
    /// Against what hovering takes.
    pub share: f64,
    /// How long the vehicle hovers without light, min.
    pub dark_min: f64,
    /// How much sooner it lands for the light, min.
    pub lost_min: f64,
}

impl Battery {
    /// The cost where the set-up says what carries the LEDs.
    pub(crate) fn of(setup: &Setup) -> Option<Self> {
        let [capacity_wh, hover_w] = setup.battery?;
        let light_w = setup.light.electrical_w * setup.airframe.leds().len() as f64;
        let minutes = |power_w: f64| 60.0 * capacity_wh / power_w;
        let dark_min = minutes(hover_w);
        Some(Self {
            light_w,
            share: light_w / hover_w,
            dark_min,
            lost_min: dark_min - minutes(hover_w + light_w),
        })
    }
}
