//! Neighbours that were seen and are not any more: still there, until the watch would have told.

use nalgebra::Rotation3;

use crate::Seen;

/// What was seen last of each track.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Lost {
    last: Vec<Seen>,
}

impl Lost {
    /// Takes up who is seen now; who is not grows old, and is forgotten after `patience_s`.
    pub(super) fn update(
        &mut self,
        seen: &[Seen],
        level_from_before: &Rotation3<f64>,
        dt_s: f64,
        patience_s: f64,
    ) {
        self.last.retain_mut(|old| {
            old.bearing = level_from_before * old.bearing;
            old.age_s += dt_s;
            old.age_s <= patience_s && !seen.iter().any(|now| now.track == old.track)
        });
        self.last.extend_from_slice(seen);
    }

    /// All who are seen or were.
    pub(super) fn all(&self) -> &[Seen] {
        &self.last
    }
}
