//! Which frames are drawn: few while a target flies, more while it spins, so that its markers are seen to turn.

use photinus_sim::Scene;
use photinus_sim::motion::{Motion, Spin};

/// Between pictures, s.
const FLYING_S: f64 = 5.0;
/// Between pictures of a spin, s: a quarter of a turn per second shows as 18 deg, less than half of what is between arms.
const SPINNING_S: f64 = 0.2;

/// Tells frame by frame whether to draw it.
pub(crate) struct Pace {
    spins: Vec<Spin>,
    last_s: Option<f64>,
}

impl Pace {
    /// For the spins of a scene's targets.
    pub(crate) fn of(scene: &Scene) -> Self {
        let spins = scene.targets.iter().flat_map(|target| match &target.motion {
            Motion::Flown(flight) => flight.spins.as_slice(),
            Motion::Recorded(_) => &[],
        });
        Self { spins: spins.copied().collect(), last_s: None }
    }

    /// Whether the next frame, taken at this time, is to be drawn.
    pub(crate) fn is_due(&mut self, time_s: f64) -> bool {
        let spinning = |spin: &Spin| (spin.start_s..=spin.start_s + spin.duration_s).contains(&time_s);
        let interval_s = if self.spins.iter().any(spinning) { SPINNING_S } else { FLYING_S };
        let is_due = self.last_s.is_none_or(|last_s| time_s - last_s >= interval_s);
        if is_due {
            self.last_s = Some(time_s);
        }
        is_due
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_spin_is_drawn_more_often() {
        let mut pace =
            Pace { spins: vec![Spin { start_s: 20.0, duration_s: 8.0, turns: 2.0 }], last_s: None };
        let drawn: Vec<f64> = (0..4000).map(|n| f64::from(n) / 100.0).filter(|&s| pace.is_due(s)).collect();
        let within = |from_s: f64, to_s: f64| drawn.iter().filter(|&&s| (from_s..to_s).contains(&s)).count();
        assert_eq!(within(0.0, 20.0), 4);
        assert!((38..=41).contains(&within(20.0, 28.0)), "{drawn:?}");
        assert_eq!(within(28.1, 40.0), 2);
    }
}
