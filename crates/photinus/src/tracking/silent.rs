//! Frames in which a marker should have shone -> how likely it is silent: its LED is dead, or stands behind a body that nobody describes.
//!
//! That a marker is missed for the noise of one frame says nothing of the next; that it is silent says all. Each of a vehicle's distributions has its own
//! belief, since which marker is missing is just what they differ in. So a pose that needs a dead LED pays for it once, and not in every frame.

use super::branches::MOST_SPOTS;

/// This share of LEDs is silent.
const SHARE: f64 = 0.01;
/// After so long one that is silent may shine again, s: what stands before it has turned away; the dead are learnt anew at little cost.
const LASTS_S: f64 = 10.0;

/// How likely each marker of a vehicle is silent; of more markers than spots are looked for the rest never is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Silent([f64; MOST_SPOTS]);

impl Silent {
    /// Nothing is known yet.
    pub(super) const BEFOREHAND: Self = Self([SHARE; MOST_SPOTS]);

    /// A while later.
    pub(super) fn after(&self, interval_s: f64) -> Self {
        let gone = -libm::expm1(-interval_s / LASTS_S);
        Self(self.0.map(|silent| silent + (SHARE - silent) * gone))
    }

    /// Lowers how likely each marker is lit.
    pub(super) fn dim(&self, lit: &mut [f64]) {
        lit.iter_mut().zip(&self.0).for_each(|(lit, silent)| *lit *= 1.0 - silent);
    }

    /// A marker was seen, or it was not, which was so likely (1 where nobody looked).
    pub(super) fn learn(&mut self, marker: usize, unseen: Option<f64>) {
        if let Some(silent) = self.0.get_mut(marker) {
            *silent = unseen.map_or(0.0, |unseen| (*silent / unseen).min(1.0));
        }
    }

    /// Learns nothing of these markers: what hides them is known.
    pub(super) fn keep(&mut self, before: &Self, of: &[bool]) {
        let own = self.0.iter_mut().zip(&before.0).zip(of);
        own.filter(|(_, of)| **of).for_each(|((own, before), _)| *own = *before);
    }

    /// Adds this share of another.
    pub(super) fn add(&mut self, other: &Self, share: f64) {
        self.0.iter_mut().zip(&other.0).for_each(|(own, other)| *own += share * other);
    }

    /// To add to.
    pub(super) const NONE: Self = Self([0.0; MOST_SPOTS]);
}
