//! Whether a marker is there: in sight, hidden behind something, or gone.

use super::Settings;

/// What is not watched is out of sight so soon, 1/s.
const LEAVES_PER_S: f64 = 60.0;

/// How likely a marker passes from one to another while time passes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Passage {
    hide: f64,
    /// Beyond the border.
    leave: f64,
    back: f64,
    go: f64,
}

impl Passage {
    pub(super) fn of(passed_s: f64, settings: &Settings) -> Self {
        let within = |per_s: f64| 1.0 - libm::exp(-per_s * passed_s);
        Self {
            hide: within(settings.hides_per_s),
            leave: within(LEAVES_PER_S),
            back: within(settings.returns_per_s),
            go: within(settings.goes_per_s),
        }
    }
}

/// Probabilities of the three; what is left is gone, or never was.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Presence {
    in_sight: f64,
    hidden: f64,
}

impl Presence {
    /// A first sighting that is a marker with this probability.
    pub(super) fn new(probability: f64) -> Self {
        Self { in_sight: probability, hidden: 0.0 }
    }

    /// The probability that it exists.
    pub(super) fn exists(&self) -> f64 {
        self.in_sight + self.hidden
    }

    /// The probability that it exists and nothing hides it.
    pub(super) fn in_sight(&self) -> f64 {
        self.in_sight
    }

    /// The probability that nothing hides it if it exists.
    pub(super) fn shows(&self) -> f64 {
        self.in_sight / self.exists().max(f64::MIN_POSITIVE)
    }

    /// Time passes. What is not watched hides all that is there.
    pub(super) fn wait(&mut self, passage: &Passage, is_watched: bool) {
        let (hide, back) = if is_watched { (passage.hide, passage.back) } else { (passage.leave, 0.0) };
        let (hides, returns) = (hide * self.in_sight, back * self.hidden);
        self.in_sight += returns - hides;
        self.hidden = (self.hidden + hides - returns) * (1.0 - passage.go);
    }

    /// A frame that is this much more likely if the marker is in sight than if it is not.
    pub(super) fn weigh(&mut self, ratio: f64) {
        let gone = (1.0 - self.exists()).max(0.0);
        let in_sight = self.in_sight * ratio;
        let all = in_sight + self.hidden + gone;
        self.in_sight = in_sight / all;
        self.hidden /= all;
    }
}
