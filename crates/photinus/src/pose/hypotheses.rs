//! Which markers the spots may be, with a first guess of the pose of each assignment.

use alloc::vec::Vec;

use nalgebra::{Unit, Vector3};

use super::known::LogDistance;
use super::problem::Pose;
use super::symmetry::Symmetry;
use crate::airframe::Airframe;
use crate::camera::Bearing;

/// The branch of starts whose assignment is not settled.
const LOOSE: u8 = u8::MAX;

/// Assignments of the spots of one neighbour to markers.
#[derive(Clone, Debug, Default)]
pub struct Hypotheses {
    spots: usize,
    starts: Vec<Start>,
    markers: Vec<Option<u16>>,
}

/// Where the search for a mode starts.
#[derive(Clone, Copy, Debug)]
pub(super) struct Start {
    pub(super) pose: Pose,
    /// What the guess costs, nats.
    nats: f64,
    /// Keeps apart modes of one assignment.
    branch: u8,
}

impl Hypotheses {
    /// Most hypotheses about one neighbour: the time of a neighbour is bounded.
    pub const MOST: usize = 16;

    /// None yet, with room for this many spots.
    pub fn with_room(spots: usize) -> Self {
        let (starts, markers) = (Vec::with_capacity(Self::MOST), Vec::with_capacity(Self::MOST * spots));
        Self { spots: 0, starts, markers }
    }

    /// Forgets all hypotheses; the next are about this many spots.
    pub fn begin(&mut self, spots: usize) {
        self.spots = spots;
        self.starts.clear();
        self.markers.clear();
    }

    /// Offers an assignment, the marker of each spot, that costs `nats` by a first look; `pose` is asked only if it is kept.
    /// Of one assignment and branch the cheapest is kept, of all the cheapest few.
    pub fn offer(&mut self, markers: &[Option<u16>], nats: f64, branch: u8, pose: impl FnOnce() -> Pose) {
        let same = (0..self.starts.len())
            .find(|&index| self.starts[index].branch == branch && self.markers(index) == markers);
        let place = same.or_else(|| self.dearest());
        match place {
            Some(place) if nats >= self.starts[place].nats => {}
            Some(place) => {
                self.starts[place] = Start { pose: pose(), nats, branch };
                self.markers_mut(place).copy_from_slice(markers);
            }
            None => {
                self.starts.push(Start { pose: pose(), nats, branch });
                self.markers.extend_from_slice(markers);
            }
        }
    }

    /// Forgets all hypotheses; those that follow are that a lone spot is one marker, turned to the camera, of an airframe that is upright against `up`, or in
    /// the image: any marker that it may be, but for those that look the same.
    pub(crate) fn suppose_one_marker(
        &mut self,
        (airframe, symmetry): (&Airframe, &Symmetry),
        (bearing, distance): (&Bearing, LogDistance),
        up: Option<Unit<Vector3<f64>>>,
        may_be: impl Fn(usize) -> bool,
    ) {
        self.begin(1);
        let ahead = *bearing.vector();
        let up = up.map_or(-Vector3::y(), Unit::into_inner);
        let position_m = ahead * libm::exp(distance.mean);
        for marker in (0..airframe.markers().len()).filter(|&marker| may_be(marker)) {
            let number = marker as u16;
            if symmetry.canonical_turn(&[number]) == 0 {
                let camera_from_body = airframe.facing(marker, &ahead, &up);
                self.offer(&[Some(number)], 0.0, 0, || Pose { position_m, camera_from_body });
            }
        }
    }

    /// The one that gives way to a cheaper one; `None` while there is room for more.
    fn dearest(&self) -> Option<usize> {
        let dearer = |&a: &usize, &b: &usize| self.starts[a].nats.total_cmp(&self.starts[b].nats);
        (self.starts.len() >= Self::MOST).then(|| (0..Self::MOST).max_by(dearer))?
    }

    /// Offers a pose without an assignment: each spot becomes the marker that is nearest in the end.
    pub fn offer_loose(&mut self, pose: Pose, nats: f64) {
        let start = Start { pose, nats, branch: LOOSE };
        match self.dearest() {
            Some(place) if nats < self.starts[place].nats => self.starts[place] = start,
            Some(_) => {}
            None => {
                self.starts.push(start);
                self.markers.resize(self.markers.len() + self.spots, None);
            }
        }
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.starts.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.starts.is_empty()
    }

    pub(super) fn start(&self, index: usize) -> &Start {
        &self.starts[index]
    }

    pub(super) fn is_loose(&self, index: usize) -> bool {
        self.starts[index].branch == LOOSE
    }

    pub(super) fn markers_mut(&mut self, index: usize) -> &mut [Option<u16>] {
        &mut self.markers[index * self.spots..][..self.spots]
    }

    pub(crate) fn markers(&self, index: usize) -> &[Option<u16>] {
        &self.markers[index * self.spots..][..self.spots]
    }
}
