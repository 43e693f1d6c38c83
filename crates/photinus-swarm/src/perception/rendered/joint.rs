//! Tracks of all cameras of a vehicle -> one number for each neighbour.
//!
//! Fields of cameras overlap: one who is seen by two is told once, as the camera says that is surer, and keeps the number under which it was known first.

use photinus_control::Seen;

/// Squared Mahalanobis distance within which two tracks are one: 99.9 % of three degrees of freedom.
const SAME: f64 = 16.3;
/// They are also one where their directions differ by less, rad, and their distances overlap: half an airframe at a few metres.
const SAME_DIRECTION_RAD: f64 = 0.05;
/// A camera's track that was not told for so long is forgotten, s.
const FORGOTTEN_S: f64 = 5.0;

/// Who is who among the tracks of several cameras.
#[derive(Debug, Default)]
pub(super) struct Joint {
    now_s: f64,
    taken: Vec<(usize, Seen)>,
    known: Vec<Known>,
    next: u64,
}

/// A camera's track under its common number.
#[derive(Clone, Copy, Debug)]
struct Known {
    track: u64,
    number: u64,
    last_s: f64,
}

impl Joint {
    pub(super) fn begin(&mut self, now_s: f64) {
        self.now_s = now_s;
        self.taken.clear();
        self.known.retain(|known| now_s - known.last_s < FORGOTTEN_S);
    }

    /// Takes a track of a camera.
    pub(super) fn take(&mut self, camera: usize, seen: Seen) {
        self.taken.push((camera, seen));
    }

    /// Tells each neighbour once.
    pub(super) fn tell(&mut self, seen: &mut Vec<Seen>) {
        // those that are known longest come first, so that they keep their numbers
        let mut taken = std::mem::take(&mut self.taken);
        taken.sort_by_key(|(_, track)| (self.number(track.track).unwrap_or(u64::MAX), track.track));
        let mut told: Vec<(usize, Seen)> = Vec::with_capacity(taken.len());
        for (camera, track) in &taken {
            let twin = told.iter().position(|(other, told)| other != camera && same(told, track));
            let number = match twin {
                Some(twin) => told[twin].1.track,
                None => self.number(track.track).unwrap_or_else(|| {
                    self.next += 1;
                    self.next
                }),
            };
            self.remember(track.track, number);
            let numbered = Seen { track: number, ..*track };
            match twin {
                Some(twin) if surer(track, &told[twin].1) => told[twin] = (*camera, numbered),
                Some(_) => {}
                None => told.push((*camera, numbered)),
            }
        }
        seen.extend(told.into_iter().map(|(_, track)| track));
        self.taken = taken;
    }

    fn number(&self, track: u64) -> Option<u64> {
        self.known.iter().find(|known| known.track == track).map(|known| known.number)
    }

    fn remember(&mut self, track: u64, number: u64) {
        match self.known.iter_mut().find(|known| known.track == track) {
            Some(known) => (known.number, known.last_s) = (number, self.now_s),
            None => self.known.push(Known { track, number, last_s: self.now_s }),
        }
    }
}

/// Whether two tracks of different cameras are one neighbour.
fn same(a: &Seen, b: &Seen) -> bool {
    if a.identity.is_some() && b.identity.is_some() && a.identity != b.identity {
        return false;
    }
    let (Some(place_a), Some(place_b)) = (a.position_m, b.position_m) else { return false };
    let off = place_a.mean - place_b.mean;
    let near = (place_a.covariance + place_b.covariance)
        .cholesky()
        .is_some_and(|factor| off.dot(&factor.solve(&off)) < SAME);
    let overlap = a.distance.bounds.intersect(&b.distance.bounds).is_some();
    let angle_rad = libm::acos(a.bearing.dot(&b.bearing).clamp(-1.0, 1.0));
    near || (overlap && angle_rad < SAME_DIRECTION_RAD)
}

/// Whether one is to be told rather than the other: seen lately, then with the smaller covariance.
fn surer(a: &Seen, b: &Seen) -> bool {
    let spread = |seen: &Seen| seen.position_m.map_or(f64::INFINITY, |place| place.covariance.trace());
    (a.age_s, spread(a)) < (b.age_s, spread(b))
}

#[cfg(test)]
mod tests {
    use nalgebra::{Matrix3, Vector3};

    use super::*;
    use crate::perception::hand_made;

    fn track(track: u64, place: [f64; 3], sigma_m: f64) -> Seen {
        let covariance = Matrix3::identity() * sigma_m * sigma_m;
        Seen { track, ..hand_made::seen(Vector3::from(place), covariance) }
    }

    fn tell(joint: &mut Joint, time_s: f64, tracks: &[(usize, Seen)]) -> Vec<Seen> {
        joint.begin(time_s);
        tracks.iter().for_each(|(camera, seen)| joint.take(*camera, *seen));
        let mut told = Vec::new();
        joint.tell(&mut told);
        told
    }

    #[test]
    fn one_who_passes_from_camera_to_camera_keeps_its_number() {
        let mut joint = Joint::default();
        let left = tell(&mut joint, 0.0, &[(0, track(4, [5.0, 0.0, 0.0], 0.3))]);
        let both = tell(
            &mut joint,
            0.1,
            &[(0, track(4, [5.0, 0.1, 0.0], 0.3)), (1, track(9, [5.2, 0.1, 0.0], 0.1))],
        );
        let right = tell(&mut joint, 0.2, &[(1, track(9, [5.2, 0.3, 0.0], 0.1))]);
        assert_eq!((left.len(), both.len(), right.len()), (1, 1, 1));
        assert!(left[0].track == both[0].track && both[0].track == right[0].track);
        assert!((both[0].position_m.unwrap().mean.x - 5.2).abs() < 1e-12, "as the surer camera has it");
    }

    #[test]
    fn two_of_one_camera_stay_two_and_so_do_two_apart() {
        let mut joint = Joint::default();
        let near = [(0, track(4, [5.0, 0.0, 0.0], 0.3)), (0, track(8, [5.0, 0.1, 0.0], 0.3))];
        assert_eq!(tell(&mut joint, 0.0, &near).len(), 2);
        let apart = [(0, track(4, [5.0, 0.0, 0.0], 0.1)), (1, track(9, [5.0, 2.0, 0.0], 0.1))];
        let told = tell(&mut joint, 0.1, &apart);
        assert!(told.len() == 2 && told[0].track != told[1].track);
        let named = |id, seen: Seen| Seen { identity: Some(id), ..seen };
        let others =
            [(0, named(1, track(4, [5.0, 0.0, 0.0], 0.3))), (1, named(2, track(9, [5.0, 0.1, 0.0], 0.3)))];
        assert_eq!(tell(&mut joint, 0.2, &others).len(), 2, "names that differ are two");
    }
}
