//! How much light an LED shows when it shines all the time, followed from frame to frame.

use crate::normal;

/// The light of an LED that shines during the whole exposure, with how sure it is. Any unit of light, the same for all.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Level {
    pub(super) full: f64,
    /// Standard deviation of `full`, as a share of it.
    pub(super) spread: f64,
    /// Probability that what is seen in a frame has nothing to do with the LED.
    pub(super) surprise: f64,
}

impl Level {
    /// How uncertain the light is of an LED that is seen for the first time: the frame may hold a part of it only.
    const AT_FIRST: f64 = 0.5;

    /// By how much the light of an LED changes in a second, as a share: vehicles turn and come closer.
    const CHANGE_PER_S: f64 = 0.5;

    /// A level is never surer than this: LEDs, edges of the signal and centres between pixels.
    const LEAST_SPREAD: f64 = 0.03;

    /// One frame in this many shows something else in the place of the LED.
    const SURPRISE: f64 = 1.0 / 500.0;

    /// More standard deviations above it are no chance: it grew faster than was believed, as an LED does that turns into view.
    const TOO_BRIGHT: f64 = 4.0;

    /// An LED whose first spot has this light; `None` for a light that is not positive.
    pub fn of_first(light: f64) -> Option<Self> {
        (light.is_finite() && light > 0.0).then_some(Self {
            full: light,
            spread: Self::AT_FIRST,
            surprise: Self::SURPRISE,
        })
    }

    /// An LED whose light is known, with a standard deviation that is a share of it; `None` where one is not positive.
    pub fn known(full: f64, spread: f64) -> Option<Self> {
        let legal = full.is_finite() && full > 0.0 && spread.is_finite() && spread > 0.0;
        legal.then_some(Self { full, spread: spread.max(Self::LEAST_SPREAD), surprise: Self::SURPRISE })
    }

    /// The light of an LED that shines all the time.
    pub fn full(&self) -> f64 {
        self.full
    }

    /// Standard deviation of that, as a share of it.
    pub fn spread(&self) -> f64 {
        self.spread
    }

    /// Time passes: `passed_s` seconds.
    pub fn wait(&mut self, passed_s: f64) {
        let change = Self::CHANGE_PER_S * passed_s.max(0.0);
        self.spread = libm::sqrt(self.spread * self.spread + change * change).min(Self::AT_FIRST);
    }

    /// Whether a light is brighter than all that the LED is believed to show: then it shone all the time, if it is the LED's.
    pub(crate) fn is_exceeded(&self, light: f64, sigma: f64) -> bool {
        self.standing(light, sigma, 1.0).0 > Self::TOO_BRIGHT
    }

    /// A spot with this light and standard deviation was seen, and the LED shone all the time with probability `lit`.
    pub fn see(&mut self, light: f64, sigma: f64, lit: f64) {
        if !(light.is_finite() && light > 0.0 && sigma.is_finite() && sigma > 0.0) {
            return;
        }
        let (off, deviation) = self.standing(light, sigma, 1.0);
        let mut lit = lit.clamp(0.0, 1.0);
        if off > Self::TOO_BRIGHT {
            self.spread = self.spread.max(light / self.full - 1.0).min(Self::AT_FIRST);
        } else {
            // What has nothing to do with the LED tells nothing of it.
            let own = normal::density(off, deviation);
            lit *= own / (own + self.surprise / (2.0 * self.full));
        }
        let (own, noise) = (self.spread * self.spread * self.full * self.full, sigma * sigma);
        let gain = lit * own / (own + noise);
        self.full += gain * (light - self.full);
        self.spread = (libm::sqrt((1.0 - gain) * own) / self.full).clamp(Self::LEAST_SPREAD, Self::AT_FIRST);
    }

    /// How far `light` is from what an LED shows that shone for `share` of the exposure, in standard deviations, and these. What is unsure of a bright light
    /// is a share of it, as where pixels are saturated: a darker one is surer, and none at all shows nothing.
    pub(super) fn standing(&self, light: f64, sigma: f64, share: f64) -> (f64, f64) {
        let mean = share * self.full;
        let own = mean * self.spread;
        let noise = if light > 0.0 { sigma * (mean / light).min(1.0) } else { sigma };
        let deviation = libm::sqrt(noise * noise + own * own);
        ((light - mean) / deviation, deviation)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every other exposure has half of the light, as where each holds an edge: the level stays, and is not the less sure.
    #[test]
    fn a_light_that_is_not_the_leds_does_not_teach_its_level() {
        let mut level = Level::known(100.0, 0.05).unwrap();
        for _ in 0..30 {
            for light in [100.0, 50.0] {
                level.wait(1.0 / 60.0);
                level.see(light, 3.0, 0.7);
            }
        }
        assert!((level.full() - 100.0).abs() < 3.0 && level.spread() < 0.06, "{level:?}");
    }

    /// Who turns away steadily is followed.
    #[test]
    fn an_led_that_fades_is_followed() {
        let mut level = Level::known(100.0, 0.05).unwrap();
        let light = |frame: i32| 100.0 * libm::exp(-0.4 * f64::from(frame) / 60.0);
        for frame in 0..120 {
            level.wait(1.0 / 60.0);
            level.see(light(frame), 3.0, 1.0);
        }
        assert!((level.full() / light(119) - 1.0).abs() < 0.05, "{level:?}");
    }
}
