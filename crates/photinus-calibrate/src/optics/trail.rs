//! Brightest pixels of frame after frame in; which of them are one light that moves out.
//!
//! The nearest to where a light is expected is that light, unless another is near enough to be it.

use super::summits::Summit;

/// A light is looked for around where it is expected: as far as this share of its distance to others, at most so many px.
const APART: f64 = 0.4;
const FARTHEST_PX: f64 = 20.0;

/// Lights as they were in the frame before.
#[derive(Clone, Debug, Default)]
pub(super) struct Trails {
    ends: Vec<End>,
    started: u64,
}

/// The end of a trail.
#[derive(Clone, Copy, Debug)]
struct End {
    trail: u64,
    at: [f64; 2],
    step: [f64; 2],
}

impl Trails {
    /// The trail of each brightest pixel of the next frame.
    pub(super) fn follow(&mut self, summits: &[Summit]) -> Vec<u64> {
        let places: Vec<[f64; 2]> =
            summits.iter().map(|summit| [summit.column as f64, summit.row as f64]).collect();
        let mut ends = Vec::with_capacity(places.len());
        for (index, &at) in places.iter().enumerate() {
            let others = places.iter().enumerate().filter(|(other, _)| *other != index);
            let room_px = others.map(|(_, other)| distance_px(at, *other)).fold(f64::INFINITY, f64::min);
            let expected = |end: &End| [end.at[0] + end.step[0], end.at[1] + end.step[1]];
            let near = self
                .ends
                .iter()
                .filter(|end| distance_px(expected(end), at) < (APART * room_px).min(FARTHEST_PX));
            let near: Vec<&End> = near.collect();
            let end = match near.as_slice() {
                [one] => End { trail: one.trail, at, step: [at[0] - one.at[0], at[1] - one.at[1]] },
                _ => {
                    self.started += 1;
                    End { trail: self.started, at, step: [0.0; 2] }
                }
            };
            ends.push(end);
        }
        self.ends = ends;
        self.ends.iter().map(|end| end.trail).collect()
    }
}

fn distance_px(a: [f64; 2], b: [f64; 2]) -> f64 {
    libm::hypot(a[0] - b[0], a[1] - b[1])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn summit(column: usize, row: usize) -> Summit {
        Summit { column, row, value: 100 }
    }

    #[test]
    fn lights_that_pass_at_a_distance_keep_their_trails_and_those_that_meet_begin_new_ones() {
        let mut trails = Trails::default();
        let first = trails.follow(&[summit(10, 50), summit(200, 80)]);
        for step in 1..10 {
            // in another order, one after the other
            let next = trails.follow(&[summit(200 - 9 * step, 80), summit(10 + 6 * step, 50)]);
            assert_eq!(next, [first[1], first[0]], "{step}");
        }
        let near = trails.follow(&[summit(122, 78), summit(122, 70)]);
        assert!(near.iter().all(|trail| !first.contains(trail)), "{near:?}");
    }
}
