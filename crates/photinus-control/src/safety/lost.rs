//! Neighbours that were seen and are not any more: still there, until the watch would have told. And what was known of those that are seen, where a frame tells less:
//! a neighbour cannot have come nearer since than both can fly.

use nalgebra::Rotation3;

use crate::Seen;

/// What was seen last of each track.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Lost {
    last: Vec<Seen>,
}

impl Lost {
    /// Takes up who is seen now; who is not grows old, until it `is_gone`. Of a track of which was known that it is farther than now is told, what was known stays:
    /// both may have come nearer at `closing_m_s` since.
    pub(super) fn update(
        &mut self,
        seen: &[Seen],
        level_from_before: &Rotation3<f64>,
        dt_s: f64,
        closing_m_s: f64,
        is_gone: impl Fn(&Seen) -> bool,
    ) {
        self.last.iter_mut().for_each(|old| {
            old.bearing = level_from_before * old.bearing;
            old.age_s += dt_s;
        });
        // a number that is told twice is of two
        self.last.retain(|old| match seen.iter().filter(|now| now.track == old.track).count() {
            0 => !is_gone(old),
            1 => true,
            _ => false,
        });
        let nearest_m = |seen: &Seen| seen.distance.bounds.min_m() - closing_m_s * seen.age_s;
        let remembered = self.last.len();
        for now in seen {
            match self.last[..remembered].iter_mut().find(|old| old.track == now.track) {
                Some(old) if nearest_m(old) > nearest_m(now) => {}
                Some(old) => *old = *now,
                None => self.last.push(*now),
            }
        }
    }

    /// All who are seen or were.
    pub(super) fn all(&self) -> &[Seen] {
        &self.last
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;
    use photinus::locator::Distance;
    use photinus::ranging::Interval;

    use super::*;

    fn seen(track: u64, near_m: f64) -> Seen {
        let bounds = Interval::new(near_m, 9.0).unwrap();
        Seen {
            track,
            identity: None,
            bearing: Vector3::x_axis(),
            bearing_bound_rad: 0.1,
            distance: Distance { estimate: None, bounds, perpendicular_m: None, inline_m: None },
            position_m: None,
            velocity_m_s: None,
            heading: None,
            probability: 1.0,
            spot_px: None,
            age_s: 0.0,
        }
    }

    #[test]
    fn what_was_known_stays_until_a_frame_tells_more() {
        let mut lost = Lost::default();
        let mut held = |told: &[Seen]| {
            lost.update(told, &Rotation3::identity(), 0.5, 2.0, |old| old.age_s > 0.9);
            lost.all().iter().map(|seen| (seen.distance.bounds.min_m(), seen.age_s)).collect::<Vec<_>>()
        };
        assert_eq!(held(&[seen(1, 5.0)]), [(5.0, 0.0)]);
        // a looser bound tells less than that both came 1 m nearer
        assert_eq!(held(&[seen(1, 3.9)]), [(5.0, 0.5)]);
        assert_eq!(held(&[seen(1, 3.1)]), [(3.1, 0.0)]);
        // two on one number are told as they are; one who is not seen is forgotten when gone
        assert_eq!(held(&[seen(1, 1.0), seen(1, 2.0)]), [(1.0, 0.0), (2.0, 0.0)]);
        assert_eq!(held(&[]).len(), 2);
        assert!(held(&[]).is_empty());
    }
}
