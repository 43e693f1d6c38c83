//! What neighbours are called from picture to picture: a frame knows nobody, but eyes follow who moves little.
//!
//! Names are for pictures alone; results have none, and nothing is estimated over time.

use nalgebra::Vector3;
use photinus_io::results::NeighbourRecord;

/// A neighbour that moved farther between two pictures is another one, rad.
const FARTHEST_RAD: f64 = 0.12;
/// After so many pictures without it a name is free again.
const REMEMBERED: u32 = 30;

/// Who was where in the last pictures of a camera.
#[derive(Default)]
pub(super) struct Names(Vec<Known>);

struct Known {
    number: usize,
    bearing: Vector3<f64>,
    identity: Option<u64>,
    unseen: u32,
}

impl Names {
    /// The number that each neighbour goes by: that of who was nearest to it in the picture before, or the least one that is
    /// free. Where results tell neighbours apart themselves, they decide.
    pub(super) fn follow(&mut self, neighbours: &[NeighbourRecord]) -> Vec<usize> {
        self.0.iter_mut().for_each(|known| known.unseen += 1);
        self.0.retain(|known| known.unseen <= REMEMBERED);
        let mut pairs: Vec<(f64, usize, usize)> = Vec::new();
        for (at, neighbour) in neighbours.iter().enumerate() {
            let bearing = Vector3::from(neighbour.bearing);
            for (place, known) in self.0.iter().enumerate() {
                let apart = (bearing - known.bearing).norm();
                match (identity(neighbour), known.identity) {
                    (Some(a), Some(b)) if a == b => pairs.push((-1.0, at, place)),
                    (None, None) if apart < FARTHEST_RAD => pairs.push((apart, at, place)),
                    _ => {}
                }
            }
        }
        // The nearest pairs first; of two alike, the one that stands first.
        pairs.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)).then(a.2.cmp(&b.2)));
        let mut places: Vec<Option<usize>> = vec![None; neighbours.len()];
        for (_, at, place) in pairs {
            if places[at].is_none() && !places.contains(&Some(place)) {
                places[at] = Some(place);
            }
        }
        let numbers = neighbours.iter().zip(places).map(|(neighbour, place)| self.see(neighbour, place));
        numbers.collect()
    }

    fn see(&mut self, neighbour: &NeighbourRecord, place: Option<usize>) -> usize {
        let number = match place {
            Some(place) => self.0[place].number,
            None => (0..)
                .find(|number| self.0.iter().all(|known| known.number != *number))
                .unwrap_or(self.0.len()),
        };
        let seen =
            Known { number, bearing: neighbour.bearing.into(), identity: identity(neighbour), unseen: 0 };
        match place {
            Some(place) => self.0[place] = seen,
            None => self.0.push(seen),
        }
        number
    }
}

/// Who it is, where results say so.
fn identity(neighbour: &NeighbourRecord) -> Option<u64> {
    neighbour.track.or(neighbour.id.map(u64::from))
}
