//! Whether a vehicle is there at all, and if so, whether something hides it: a Bernoulli recursion with three states, shown, hidden, absent.
//!
//! A vehicle of which no marker is seen though several must show is hidden behind something or gone: frames with nothing are no independent news. J. L.
//! Williams, "Marginal multi-Bernoulli filters", IEEE Trans. Aerosp. Electron. Syst. 51 (2015), for the recursion.

use super::settings::Settings;

/// How often a vehicle leaves for good, 1/s: in view once in ten minutes, hidden once in a minute.
const LEAVES_SHOWN: f64 = 1.0 / 600.0;
const LEAVES_HIDDEN: f64 = 1.0 / 60.0;

/// How likely one comes after a while that nobody knew of, out of where one is hidden: as often as those leave for good.
pub(super) fn comes(interval_s: f64) -> f64 {
    within(LEAVES_HIDDEN, interval_s)
}

/// How likely what happens at a rate has happened after a while.
fn within(rate: f64, interval_s: f64) -> f64 {
    -libm::expm1(-rate * interval_s)
}

/// How likely a vehicle is shown or hidden; the rest is that there is none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Existence {
    pub(super) shown: f64,
    pub(super) hidden: f64,
}

impl Existence {
    /// Of a vehicle that exists so likely and is hidden so likely, if it does.
    pub(super) fn new(existence: f64, hidden: f64) -> Self {
        Self { shown: existence * (1.0 - hidden), hidden: existence * hidden }
    }

    pub(super) fn total(&self) -> f64 {
        self.shown + self.hidden
    }

    /// A while later.
    pub(super) fn after(&self, interval_s: f64, settings: &Settings) -> Self {
        let within = |rate: f64| within(rate, interval_s);
        let (hides, shows) = (within(settings.hiding_per_s), within(1.0 / settings.hidden_s));
        let shown = self.shown * (1.0 - within(LEAVES_SHOWN));
        let hidden = self.hidden * (1.0 - within(LEAVES_HIDDEN));
        Self { shown: shown * (1.0 - hides) + hidden * shows, hidden: hidden * (1.0 - shows) + shown * hides }
    }

    /// How likely nothing of it is seen, where one that is shown is not seen as likely as `unseen_if_shown`.
    pub(super) fn unseen(&self, unseen_if_shown: f64) -> f64 {
        (1.0 - self.total()).max(0.0) + self.hidden + self.shown * unseen_if_shown
    }

    /// With a frame in which it was not seen with this probability.
    pub(super) fn with(&self, unseen: f64, unseen_if_shown: f64) -> Self {
        let share = unseen / self.unseen(unseen_if_shown).max(f64::MIN_POSITIVE);
        Self { shown: (1.0 - unseen) + share * self.shown * unseen_if_shown, hidden: share * self.hidden }
    }
}
