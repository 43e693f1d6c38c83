//! What lies near a direction, without looking at everything: directions in the order of one of their axes.

use nalgebra::Vector3;

/// Directions by their height.
#[derive(Debug, Default)]
pub(super) struct Directions {
    sorted: Vec<(f64, usize)>,
}

impl Directions {
    /// Takes the place of all that were there; each goes by its number.
    pub(super) fn begin(&mut self, directions: impl Iterator<Item = (usize, Vector3<f64>)>) {
        self.sorted.clear();
        self.sorted.extend(directions.map(|(number, direction)| (direction.y, number)));
        self.sorted.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    }

    /// All that may lie within `reach_rad` of a direction, and others.
    pub(super) fn near(&self, direction: &Vector3<f64>, reach_rad: f64) -> impl Iterator<Item = usize> + '_ {
        let (low, high) = (direction.y - reach_rad, direction.y + reach_rad);
        let first = self.sorted.partition_point(|&(y, _)| y < low);
        self.sorted[first..].iter().take_while(move |&&(y, _)| y <= high).map(|&(_, number)| number)
    }
}
