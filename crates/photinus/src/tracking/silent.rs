//! Frames in which a marker should have shone -> how likely it is silent: its LED is dead, or stands behind a body that nobody describes; and where
//! another vehicle stands before it, how likely that one's body hides it.
//!
//! That a marker is missed for the noise of one frame says nothing of the next; that it is silent or hidden says all. Each of a vehicle's distributions has
//! its own belief, since which marker is missing is just what they differ in. So a pose that needs a dead or hidden LED pays for it once, and not in every
//! frame.

use super::branches::MOST_SPOTS;

/// This share of LEDs is silent.
const SHARE: f64 = 0.01;
/// After so long one that is silent may shine again, s: what stands before it has turned away; the dead are learnt anew at little cost.
const LASTS_S: f64 = 10.0;
/// What lies behind another vehicle's markers is so likely behind its body: rings of markers are open, bodies are not.
const BEHIND: f64 = 0.5;

/// How likely each marker of a vehicle is silent, and hidden where it is behind another vehicle; of more markers than spots are looked for the rest never is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Silent {
    silent: [f64; MOST_SPOTS],
    hidden: [f64; MOST_SPOTS],
}

impl Silent {
    /// Nothing is known yet.
    pub(super) const BEFOREHAND: Self = Self { silent: [SHARE; MOST_SPOTS], hidden: [BEHIND; MOST_SPOTS] };
    /// To add to.
    pub(super) const NONE: Self = Self { silent: [0.0; MOST_SPOTS], hidden: [0.0; MOST_SPOTS] };

    /// A while later, where what hides a marker is another after a given time.
    pub(super) fn after(&self, interval_s: f64, hidden_s: f64) -> Self {
        let gone = |lasts_s: f64| -libm::expm1(-interval_s / lasts_s);
        let (silent, hidden) = (gone(LASTS_S), gone(hidden_s));
        Self {
            silent: self.silent.map(|own| own + (SHARE - own) * silent),
            hidden: self.hidden.map(|own| own + (BEHIND - own) * hidden),
        }
    }

    /// Lowers how likely each marker is lit that is looked at, some of them past another vehicle.
    pub(super) fn dim(&self, lit: &mut [f64], screened: &[bool]) {
        lit.iter_mut().zip(&self.silent).for_each(|(lit, silent)| *lit *= 1.0 - silent);
        let behind = lit.iter_mut().zip(&self.hidden).zip(screened).filter(|(_, screened)| **screened);
        behind.for_each(|((lit, hidden), _)| *lit *= 1.0 - hidden);
    }

    /// A marker was seen, or it was not, which was so likely (1 where nobody looked).
    pub(super) fn learn(&mut self, marker: usize, unseen: Option<f64>) {
        if marker < MOST_SPOTS {
            for own in [&mut self.silent[marker], &mut self.hidden[marker]] {
                *own = unseen.map_or(0.0, |unseen| (*own / unseen).min(1.0));
            }
        }
    }

    /// Holds what was learnt only of what may be the reason: of a marker behind another vehicle that this hides it, of others that they are silent, and that only where it
    /// is sure whose the spots are.
    pub(super) fn blame(&mut self, before: &Self, screened: &[bool], is_sure: bool) {
        for (marker, &screened) in screened.iter().enumerate().take(MOST_SPOTS) {
            if screened || !is_sure {
                self.silent[marker] = before.silent[marker];
            }
            if !screened {
                self.hidden[marker] = BEHIND;
            }
        }
    }

    /// Adds this share of another.
    pub(super) fn add(&mut self, other: &Self, share: f64) {
        let own = self.silent.iter_mut().chain(&mut self.hidden);
        own.zip(other.silent.iter().chain(&other.hidden)).for_each(|(own, other)| *own += share * other);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What it costs, nats, that a marker that shows is not seen in frame after frame.
    fn cost_unseen(frames: usize, screened: bool) -> f64 {
        let mut silent = Silent::BEFOREHAND;
        let mut nats = 0.0;
        for _ in 0..frames {
            silent = silent.after(1.0 / 60.0, 2.0);
            let mut lit = [1.0];
            silent.dim(&mut lit, &[screened]);
            let unseen = 1.0 - 0.98 * lit[0];
            nats -= libm::log(unseen);
            let before = silent;
            silent.learn(0, Some(unseen));
            silent.blame(&before, &[screened], true);
        }
        nats
    }

    #[test]
    fn a_reason_is_paid_for_once() {
        // Behind another vehicle a marker is hidden with one half, whatever is in view one LED in a hundred is dead.
        assert!((cost_unseen(1, true) - 0.67).abs() < 0.03 && (cost_unseen(1, false) - 3.5).abs() < 0.1);
        let (hidden, dead) = (cost_unseen(60, true), cost_unseen(60, false));
        assert!((0.6..1.3).contains(&hidden) && (4.4..4.9).contains(&dead), "{hidden} {dead}");
    }

    #[test]
    fn what_was_seen_past_another_vehicle_is_missed_there() {
        let mut silent = Silent::BEFOREHAND;
        silent.learn(0, None);
        silent.blame(&Silent::BEFOREHAND, &[true], true);
        let mut lit = [1.0, 1.0];
        silent.dim(&mut lit, &[true, true]);
        assert!(lit[0] > 0.98 && (0.49..0.5).contains(&lit[1]), "{lit:?}");
        // Elsewhere it is new.
        silent.blame(&silent.clone(), &[false], true);
        let mut lit = [1.0];
        silent.dim(&mut lit, &[true]);
        assert!(lit[0] < 0.5, "{lit:?}");
    }
}
