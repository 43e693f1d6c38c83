//! A pose -> which spot is which marker: the nearest, each marker once.

use alloc::vec::Vec;

use super::observation::Observation;
use super::problem::Pose;
use crate::airframe::Airframe;

/// Room for gaps between spots and markers.
#[derive(Clone, Debug, Default)]
pub(crate) struct Assignment {
    /// The markers that shine towards the camera.
    shining: Vec<u16>,
    /// By spot: its squared gap to each of them, as a difference of directions.
    gaps: Vec<f64>,
    /// By place among those: the spot that has it.
    holders: Vec<Option<u16>>,
}

impl Assignment {
    /// Room for this many spots and markers.
    pub(crate) fn with_room(markers: usize) -> Self {
        Self {
            shining: Vec::with_capacity(markers),
            gaps: Vec::with_capacity(markers * markers),
            holders: Vec::with_capacity(markers),
        }
    }

    /// Gives every spot the nearest marker that shines towards the camera and is not yet taken, the nearest pairs first;
    /// `None` where no marker is left. Returns whether any spot changed.
    pub(crate) fn assign(
        &mut self,
        airframe: &Airframe,
        pose: &Pose,
        observations: &[Observation],
        markers: &mut [Option<u16>],
    ) -> bool {
        let camera_in_body_m = pose.camera_in_body_m();
        let shines = |&marker: &u16| airframe.is_visible(usize::from(marker), &camera_in_body_m);
        self.shining.clear();
        self.shining.extend((0..airframe.markers().len() as u16).filter(shines));
        self.gaps.clear();
        self.gaps.resize(self.shining.len() * observations.len(), 0.0);
        for (place, &marker) in self.shining.iter().enumerate() {
            let position_m = airframe.markers()[usize::from(marker)].position_m;
            let direction = (pose.camera_from_body * position_m + pose.position_m).normalize();
            for (spot, seen) in observations.iter().enumerate() {
                self.gaps[spot * self.shining.len() + place] =
                    (seen.bearing.vector() - direction).norm_squared();
            }
        }
        self.match_nearest(observations.len());
        let mut changed = false;
        for (spot, marker) in (0_u16..).zip(markers) {
            let place = self.holders.iter().position(|&holder| holder == Some(spot));
            let nearest = place.map(|place| self.shining[place]);
            changed |= *marker != nearest;
            *marker = nearest;
        }
        changed
    }

    /// Matches the nearest pairs first. Gaps are the same from both sides, so that this is the one stable matching: every spot asks the nearest marker, and
    /// the next where a nearer spot has it or takes it away (D. Gale, L. Shapley, Am. Math. Mon. 69, 1962). Of equal gaps the lower number is the nearer.
    fn match_nearest(&mut self, spots: usize) {
        let Self { shining, gaps, holders } = self;
        holders.clear();
        holders.resize(shining.len(), None);
        let gap = |spot: u16, place: usize| gaps[usize::from(spot) * shining.len() + place];
        for spot in 0..spots as u16 {
            let (mut asking, mut asked) = (spot, None);
            loop {
                let is_next =
                    |&place: &usize| asked.is_none_or(|asked| is_nearer(asked, (gap(asking, place), place)));
                let nearer =
                    |&a: &usize, &b: &usize| gap(asking, a).total_cmp(&gap(asking, b)).then(a.cmp(&b));
                let Some(place) = (0..shining.len()).filter(is_next).min_by(nearer) else { break };
                asked = Some((gap(asking, place), place));
                match holders[place] {
                    None => {
                        holders[place] = Some(asking);
                        break;
                    }
                    Some(holder) if is_nearer((gap(asking, place), asking), (gap(holder, place), holder)) => {
                        holders[place] = Some(asking);
                        (asking, asked) = (holder, Some((gap(holder, place), place)));
                    }
                    Some(_) => {}
                }
            }
        }
    }
}

/// Whether the first of two is nearer, or as near and of a lower number.
fn is_nearer<T: Ord>((gap, number): (f64, T), (other, others): (f64, T)) -> bool {
    gap.total_cmp(&other).then(number.cmp(&others)).is_lt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The obviously right version: all pairs, the nearest first.
    fn nearest_first(gaps: &[f64], shining: usize) -> Vec<Option<u16>> {
        let mut pairs: Vec<(f64, u16, usize)> = gaps
            .iter()
            .enumerate()
            .map(|(index, &gap)| (gap, (index / shining) as u16, index % shining))
            .collect();
        pairs.sort_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
        let mut holders = vec![None; shining];
        for (_, spot, place) in pairs {
            if holders[place].is_none() && !holders.contains(&Some(spot)) {
                holders[place] = Some(spot);
            }
        }
        holders
    }

    proptest! {
        #[test]
        fn the_nearest_pairs_are_matched_first(
            spots in 1usize..12, shining in 1usize..12, steps in prop::collection::vec(0u8..40, 12 * 12),
        ) {
            // Few steps: many gaps are equal.
            let gaps: Vec<f64> = steps[..spots * shining].iter().map(|&step| f64::from(step)).collect();
            let expected = nearest_first(&gaps, shining);
            let mut assignment = Assignment { shining: (0..shining as u16).collect(), gaps, holders: Vec::new() };
            assignment.match_nearest(spots);
            prop_assert_eq!(assignment.holders, expected);
        }
    }
}
