//! What neighbours are called from picture to picture: by their id where results tell it, else by a letter, for a frame knows nobody, but
//! eyes follow who moves little.
//!
//! Letters and colours are for pictures alone; results have none, and nothing is estimated over time.

use nalgebra::Vector3;
use photinus_io::results::{FrameRecord, TrackRecord};
use tiny_skia::ColorU8 as Colour;

use super::colours;

/// A neighbour that moved farther between two pictures is another one, rad.
const FARTHEST_RAD: f64 = 0.12;
/// After this many pictures without it a name is free again.
const REMEMBERED: u32 = 30;

/// The name of a neighbour or a track.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Name {
    number: usize,
    /// In words.
    pub(super) word: String,
}

impl Name {
    /// For a neighbour that is not known: A to Z, then A2 to Z2, and so on.
    pub(super) fn letter(number: usize) -> Self {
        let (round, letter) = (number / 26, (b'A'..=b'Z').map(char::from).nth(number % 26).unwrap_or('?'));
        let word = if round == 0 { letter.to_string() } else { format!("{letter}{}", round + 1) };
        Self { number, word }
    }

    fn of(number: usize, id: Option<u32>) -> Self {
        match id {
            Some(id) => Self { number, word: format!("#{id}") },
            None => Self::letter(number),
        }
    }

    /// The colour that it is drawn in.
    pub(super) fn colour(&self) -> Colour {
        colours::neighbour(self.number)
    }
}

/// The names of a record: of each of its neighbours, and of each of its tracks.
pub(super) struct Called {
    pub(super) neighbours: Vec<Name>,
    pub(super) tracks: Vec<Name>,
}

/// Who was where in the last pictures of a camera.
#[derive(Default)]
pub(super) struct Names(Vec<Known>);

struct Known {
    number: usize,
    sight: Sight,
    unseen: u32,
}

/// Somebody in a picture: where, and who it is where results tell that.
#[derive(Clone, Copy)]
struct Sight {
    bearing: Vector3<f64>,
    identity: Option<u64>,
    id: Option<u32>,
}

impl Names {
    /// The names of all in a record: that of who was nearest to it in the picture before, or by the first letter that is free. Where
    /// results tell neighbours apart themselves, they decide.
    pub(super) fn follow(&mut self, record: &FrameRecord) -> Called {
        let is_neighbour =
            |track: &TrackRecord| record.neighbours.iter().any(|seen| seen.track == Some(track.track));
        let mut sights: Vec<Sight> = record
            .neighbours
            .iter()
            .map(|seen| Sight {
                bearing: seen.bearing.into(),
                identity: seen.track.or(seen.id.map(u64::from)),
                id: seen.id,
            })
            .collect();
        sights.extend(record.tracks.iter().filter(|track| !is_neighbour(track)).map(|track| {
            let position_m = Vector3::from(track.position_m);
            let bearing = position_m.try_normalize(0.0).unwrap_or(position_m);
            Sight { bearing, identity: Some(track.track), id: track.id }
        }));
        let mut names = self.numbers(&sights).into_iter().zip(&sights);
        let name = |(number, sight): (usize, &Sight)| Name::of(number, sight.id);
        let neighbours: Vec<Name> = names.by_ref().take(record.neighbours.len()).map(name).collect();
        let mut unseen = names.map(name);
        let of_track = |track: &TrackRecord| {
            let seen = record.neighbours.iter().position(|seen| seen.track == Some(track.track));
            seen.map_or_else(|| unseen.next(), |index| neighbours.get(index).cloned())
        };
        let tracks = record.tracks.iter().filter_map(of_track).collect();
        Called { neighbours, tracks }
    }

    fn numbers(&mut self, sights: &[Sight]) -> Vec<usize> {
        self.0.iter_mut().for_each(|known| known.unseen += 1);
        self.0.retain(|known| known.unseen <= REMEMBERED);
        let mut pairs: Vec<(f64, usize, usize)> = Vec::new();
        for (at, sight) in sights.iter().enumerate() {
            for (place, known) in self.0.iter().enumerate() {
                let apart = (sight.bearing - known.sight.bearing).norm();
                match (sight.identity, known.sight.identity) {
                    (Some(a), Some(b)) if a == b => pairs.push((-1.0, at, place)),
                    (None, None) if apart < FARTHEST_RAD => pairs.push((apart, at, place)),
                    _ => {}
                }
            }
        }
        // The nearest pairs first; of two alike, the one that stands first.
        pairs.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)).then(a.2.cmp(&b.2)));
        let mut places: Vec<Option<usize>> = vec![None; sights.len()];
        for (_, at, place) in pairs {
            if places[at].is_none() && !places.contains(&Some(place)) {
                places[at] = Some(place);
            }
        }
        sights.iter().zip(places).map(|(sight, place)| self.see(*sight, place)).collect()
    }

    fn see(&mut self, sight: Sight, place: Option<usize>) -> usize {
        let number = match place {
            Some(place) => self.0[place].number,
            None => (0..)
                .find(|number| self.0.iter().all(|known| known.number != *number))
                .unwrap_or(self.0.len()),
        };
        let seen = Known { number, sight, unseen: 0 };
        match place {
            Some(place) => self.0[place] = seen,
            None => self.0.push(seen),
        }
        number
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_have_letters_however_many() {
        assert_eq!([0, 25, 26].map(|number| Name::letter(number).word), ["A", "Z", "A2"]);
    }
}
