//! What the cameras watch -> per direction, the range within which there is nobody who was not seen.
//!
//! What is not seen is not free: a direction is known to be empty out to a range only after so many looks that somebody there would
//! have been missed in all of them with a probability below a stated one; that knowledge then grows old, and a vehicle may come in
//! at full speed. Where no camera looks, nothing is known.

use core::cmp::Ordering;

use nalgebra::{Rotation3, UnitVector3, Vector3};
use photinus::ranging::Interval;

use super::angle::{compare, widest_rad};
use super::{Sector, Shadow};

/// Cells along each edge of a cube's faces.
const EDGE: usize = 6;
const CELLS: usize = 6 * EDGE * EDGE;
/// Parts along each edge of a cell where eyes overlap.
const PARTS: usize = 6;
/// Where something hides what is behind it, absence is known to a multiple of that, m.
const STEP_M: f64 = 0.5;
/// Nobody watches farther, m.
const FARTHEST_M: f64 = 500.0;

/// All directions within an angle of an axis, in the level frame: what a camera covers, or what hides behind the own airframe.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cone {
    /// The middle.
    pub axis: UnitVector3<f64>,
    /// The angle, rad.
    pub half_angle_rad: f64,
}

impl Cone {
    /// Whether all directions of another are within it.
    fn covers(&self, other: &Self) -> bool {
        let spare_rad = self.half_angle_rad - other.half_angle_rad;
        compare(&self.axis, &other.axis, spare_rad).is_some_and(Ordering::is_le)
    }

    /// Whether surely no direction of another is within it.
    fn is_apart_from(&self, other: &Self) -> bool {
        let both_rad = self.half_angle_rad + other.half_angle_rad;
        compare(&self.axis, &other.axis, both_rad).is_some_and(Ordering::is_gt)
    }
}

/// How likely one frame shows a neighbour that is no further than a range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Detection {
    /// The range, m.
    pub range_m: f64,
    /// The probability, 0 to 1; misses of frame after frame are taken as independent.
    pub probability: f64,
}

/// A distance, and how many looks in a row it takes to know that nobody is nearer.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Ring {
    range_m: f64,
    looks: u32,
}

/// A part of the directions, in axes that do not turn.
#[derive(Clone, Debug, PartialEq)]
struct Cell {
    cone: Cone,
    /// In how many looks in a row all of it was watched as far as each ring.
    looks: Vec<u32>,
    /// Nobody was nearer than that, so long ago.
    empty_m: f64,
    age_s: f64,
}

/// The range to which absence is known, per direction.
#[derive(Clone, Debug, PartialEq)]
pub struct Watch {
    cells: Vec<Cell>,
    rings: Vec<Ring>,
    period_s: f64,
    closing_m_s: f64,
    /// How far the level frame has turned since the beginning, rad.
    turned_rad: f64,
}

impl Watch {
    /// Nothing is known yet. Frames come every `period_s` or faster, vehicles close in at `closing_m_s` or slower, and somebody is
    /// missed for good with probability `missed` at the most.
    pub fn new(detections: &[Detection], missed: f64, period_s: f64, closing_m_s: f64) -> Self {
        let looks = |d: &Detection| -> Option<Ring> {
            let p = d.probability.clamp(0.0, 1.0);
            // Written so that what is no number gives no knowledge.
            let looks = if p >= 1.0 { 1.0 } else { libm::ceil(libm::log(missed) / libm::log1p(-p)).max(1.0) };
            (p > 0.0 && d.range_m > 0.0 && looks < 1e6)
                .then_some(Ring { range_m: d.range_m.min(FARTHEST_M), looks: looks as u32 })
        };
        let rings = rings(&detections.iter().filter_map(looks).collect::<Vec<_>>());
        let looks = vec![0; rings.len()];
        let cell = |k| Cell { cone: cone(k), looks: looks.clone(), empty_m: 0.0, age_s: 0.0 };
        Self { cells: (0..CELLS).map(cell).collect(), rings, period_s, closing_m_s, turned_rad: 0.0 }
    }

    /// Somebody else answers for it that nobody unseen is nearer than `range_m`, anywhere.
    pub fn empty_to(range_m: f64) -> Self {
        let mut all = Self::new(&[], 0.0, 0.0, 0.0);
        all.cells.iter_mut().for_each(|cell| cell.empty_m = range_m);
        all
    }

    /// Another frame of all cameras, `dt_s` after the last and `age_s` old, while the level frame turned by `turned_rad`: what
    /// `eyes` cover was watched, as far as nothing is `hidden`.
    pub fn look(&mut self, eyes: &[Cone], hidden: &[Shadow], turned_rad: f64, dt_s: f64, age_s: f64) {
        self.turned_rad += turned_rad;
        let level_from_still = Rotation3::from_axis_angle(&Vector3::z_axis(), -self.turned_rad);
        let here = |cone: &Cone| Cone { axis: level_from_still * cone.axis, ..*cone };
        let covered = |cone: &Cone| eyes.iter().any(|eye| eye.covers(cone));
        for (index, cell) in self.cells.iter_mut().enumerate() {
            cell.age_s += dt_s;
            let all = here(&cell.cone);
            let is_apart = || eyes.iter().all(|eye| eye.is_apart_from(&all));
            // Two eyes may cover a cell together, part by part.
            let is_covered = covered(&all) || !is_apart() && parts(index).all(|part| covered(&here(&part)));
            let before = hidden.iter().filter(|shadow| shadow.touches(&all)).map(Shadow::starts_m);
            let watched_m = if is_covered { before.fold(f64::INFINITY, f64::min) } else { 0.0 };
            for (Ring { range_m, looks }, in_a_row) in self.rings.iter().zip(&mut cell.looks) {
                *in_a_row = if *range_m <= watched_m { in_a_row.saturating_add(1) } else { 0 };
                if *in_a_row < *looks {
                    continue;
                }
                let since_s = age_s + f64::from(looks - 1) * self.period_s;
                if range_m - self.closing_m_s * since_s > cell.empty_m - self.closing_m_s * cell.age_s {
                    (cell.empty_m, cell.age_s) = (*range_m, since_s);
                }
            }
        }
    }

    /// How long it takes to know that somebody is gone, s.
    pub fn patience_s(&self) -> f64 {
        self.rings.iter().map(|ring| f64::from(ring.looks) * self.period_s).fold(0.0, f64::max)
    }

    /// Whether all that is known of the directions of a cone, in the level frame, was seen less than `age_s` ago: somebody who was told of then, and not since,
    /// is none of those whose absence is known from before.
    pub(super) fn is_newer(&self, cone: &Cone, age_s: f64) -> bool {
        let still_from_level = Rotation3::from_axis_angle(&Vector3::z_axis(), self.turned_rad);
        let cone = Cone { axis: still_from_level * cone.axis, ..*cone };
        self.cells.iter().all(|cell| {
            cone.is_apart_from(&cell.cone)
                || cell.age_s < age_s
                || cell.empty_m <= self.closing_m_s * cell.age_s
        })
    }

    /// How far nobody is in a direction of the level frame, m, whoever has come in since.
    pub fn empty_m(&self, direction: &UnitVector3<f64>) -> f64 {
        let still_from_level = Rotation3::from_axis_angle(&Vector3::z_axis(), self.turned_rad);
        let cell = &self.cells[index(&(still_from_level * direction))];
        (cell.empty_m - self.closing_m_s * cell.age_s).max(0.0)
    }

    /// Where somebody may be who was not seen, in the level frame of now, and how long ago that was known, s.
    pub(super) fn unknown(&self) -> impl Iterator<Item = (Sector, f64)> {
        let level_from_still = Rotation3::from_axis_angle(&Vector3::z_axis(), -self.turned_rad);
        self.cells.iter().filter_map(move |cell| {
            let distances = Interval::new(cell.empty_m.max(0.0), f64::INFINITY)?;
            let axis = level_from_still * cell.cone.axis;
            Some((Sector { axis, half_angle_rad: cell.cone.half_angle_rad, distances }, cell.age_s))
        })
    }
}

/// Rings at each range, and in steps within the farthest, with the fewest looks that tell as much; from near to far.
fn rings(ranges: &[Ring]) -> Vec<Ring> {
    let farthest_m = ranges.iter().map(|ring| ring.range_m).fold(0.0, f64::max);
    let steps = (1..).map(|step| f64::from(step) * STEP_M).take_while(|range_m| *range_m < farthest_m);
    let mut all: Vec<f64> = steps.chain(ranges.iter().map(|ring| ring.range_m)).collect();
    all.sort_by(f64::total_cmp);
    let looks =
        |range_m: f64| ranges.iter().filter(|ring| ring.range_m >= range_m).map(|ring| ring.looks).min();
    all.into_iter().filter_map(|range_m| Some(Ring { range_m, looks: looks(range_m)? })).collect()
}

/// The cone around a cell: face by face of a cube, line by line.
fn cone(index: usize) -> Cone {
    let (line, column) = (index / EDGE % EDGE, index % EDGE);
    patch(index / (EDGE * EDGE), [line as f64, column as f64], 1.0)
}

/// The cones around the parts of a cell, which together cover it.
fn parts(index: usize) -> impl Iterator<Item = Cone> {
    let (line, column) = (index / EDGE % EDGE, index % EDGE);
    let size = 1.0 / PARTS as f64;
    (0..PARTS * PARTS).map(move |part| {
        let at = [line as f64 + size * (part / PARTS) as f64, column as f64 + size * (part % PARTS) as f64];
        patch(index / (EDGE * EDGE), at, size)
    })
}

/// The cone around a square of a cube's face, from a corner on, in lengths of a cell.
fn patch(face: usize, [row, column]: [f64; 2], size: f64) -> Cone {
    let at = |r: f64, c: f64| {
        let place = |step: f64| 2.0 * step / EDGE as f64 - 1.0;
        let mut vector = Vector3::zeros();
        vector[face / 2] = if face.is_multiple_of(2) { 1.0 } else { -1.0 };
        vector[(face / 2 + 1) % 3] = place(row + r * size);
        vector[(face / 2 + 2) % 3] = place(column + c * size);
        UnitVector3::new_normalize(vector)
    };
    let axis = at(0.5, 0.5);
    let corners = [at(0.0, 0.0), at(0.0, 1.0), at(1.0, 0.0), at(1.0, 1.0)];
    Cone { axis, half_angle_rad: widest_rad(&axis, &corners) }
}

/// The cell of a direction.
fn index(direction: &Vector3<f64>) -> usize {
    let axis = direction.iamax();
    let face = 2 * axis + usize::from(direction[axis] < 0.0);
    let step = |x: f64| {
        let place = 0.5 * (x / direction[axis].abs() + 1.0) * EDGE as f64;
        (place.max(0.0) as usize).min(EDGE - 1)
    };
    face * EDGE * EDGE + step(direction[(axis + 1) % 3]) * EDGE + step(direction[(axis + 2) % 3])
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn towards(x: f64, y: f64, z: f64) -> UnitVector3<f64> {
        UnitVector3::new_normalize(Vector3::new(x, y, z))
    }

    proptest! {
        #[test]
        fn every_direction_is_in_the_cone_of_its_cell(x in -1.0..1.0_f64, y in -1.0..1.0_f64, z in -1.0..1.0_f64) {
            prop_assume!(Vector3::new(x, y, z).norm() > 1e-3);
            let direction = towards(x, y, z);
            let cone = cone(index(&direction));
            prop_assert!(direction.angle(&cone.axis) <= cone.half_angle_rad + 1e-9);
        }
    }

    #[test]
    fn absence_takes_looks_and_grows_old() {
        let (near, far) =
            (Detection { range_m: 5.0, probability: 0.99 }, Detection { range_m: 10.0, probability: 0.5 });
        // Missed twice in a million: 3 looks at 0.99, 19 at 0.5.
        let mut watch = Watch::new(&[near, far], 2e-6, 0.1, 4.0);
        let ahead = Cone { axis: towards(1.0, 0.0, 0.0), half_angle_rad: 1.6 };
        let dead = Cone { axis: towards(0.0, 0.0, -1.0), half_angle_rad: 0.3 };
        let mut known = Vec::new();
        for _ in 0..30 {
            watch.look(&[ahead], &[dead.into()], 0.0, 0.1, 0.0);
            known.push(watch.empty_m(&towards(1.0, 0.1, 0.1)));
        }
        assert!(known[1].abs() < 1e-12 && (known[2] - (5.0 - 4.0 * 0.2)).abs() < 1e-9, "{known:?}");
        // After 19 looks they came in for 1.8 s: 2.8 m is less than what three looks tell.
        assert!(known[3..].iter().all(|m| (m - 4.2).abs() < 1e-9), "{known:?}");
        for direction in [towards(-1.0, 0.0, 0.0), towards(0.0, 0.0, -1.0), towards(0.3, 0.0, -1.0)] {
            assert!(watch.empty_m(&direction).abs() < 1e-12, "{direction:?}");
        }
        // Turned to the left by a right angle, what was ahead is on the right, and no longer looked at by an eye that is narrow.
        let narrow = Cone { half_angle_rad: 0.6, ..ahead };
        watch.look(&[narrow], &[], core::f64::consts::FRAC_PI_2, 0.1, 0.0);
        assert!((watch.empty_m(&towards(0.0, -1.0, 0.1)) - (4.2 - 0.4)).abs() < 1e-9);
        assert!(watch.empty_m(&towards(-1.0, 0.0, 0.1)).abs() < 1e-12);
    }

    #[test]
    fn behind_a_post_absence_is_known_as_far_as_the_post_and_from_before() {
        let mut watch = Watch::new(&[Detection { range_m: 8.0, probability: 1.0 }], 1e-6, 0.1, 1.0);
        let all = Cone { axis: towards(1.0, 0.0, 0.0), half_angle_rad: 4.0 };
        let limits = crate::safety::Limits::small_multirotor();
        let (from, to) = (Vector3::new(3.0, 0.0, -5.0), Vector3::new(3.0, 0.0, 5.0));
        let body = crate::safety::Obstacle::Capsule { from, to, radius_m: 0.2 };
        let post = Shadow::of_obstacle(&body, 0.0, &limits).unwrap();
        let (ahead, aside) = (towards(1.0, 0.01, 0.01), towards(0.0, 1.0, 0.1));
        // one who is hidden is 0.6 m or more from the middle of the post: at 3.5 m
        watch.look(&[all], &[post], 0.0, 0.1, 0.0);
        assert!((watch.empty_m(&ahead) - 3.5).abs() < 1e-9 && (watch.empty_m(&aside) - 8.0).abs() < 1e-9);
        // what was seen before the post came in between is known still, and grows old
        watch.look(&[all], &[], 0.0, 0.1, 0.0);
        watch.look(&[all], &[post], 0.0, 0.1, 0.0);
        assert!((watch.empty_m(&ahead) - 7.9).abs() < 1e-9, "{}", watch.empty_m(&ahead));
        // that says nothing of one who was seen there later, and is not any more; beside the post nobody is left
        let cone = |axis| Cone { axis, half_angle_rad: 0.01 };
        assert!(!watch.is_newer(&cone(ahead), 0.05) && watch.is_newer(&cone(ahead), 0.15));
        assert!(watch.is_newer(&cone(aside), 0.05));
    }

    #[test]
    fn two_lenses_of_185_degrees_leave_no_gap_and_two_of_178_do() {
        for (degrees, gap) in [(185.0_f64, false), (178.0, true)] {
            let sure = Detection { range_m: 5.0, probability: 1.0 };
            let mut watch = Watch::new(&[sure], 1e-6, 0.1, 4.0);
            let eye =
                |x: f64| Cone { axis: towards(x, 0.2 * x, 0.0), half_angle_rad: 0.5 * degrees.to_radians() };
            watch.look(&[eye(1.0), eye(-1.0)], &[], 0.0, 0.1, 0.0);
            assert_eq!(watch.unknown().any(|(sector, _)| sector.distances.min_m() < 5.0), gap, "{degrees}");
        }
    }

    #[test]
    fn what_is_no_probability_gives_no_knowledge() {
        for probability in [0.0, -1.0, f64::NAN] {
            let mut watch = Watch::new(&[Detection { range_m: 5.0, probability }], 1e-6, 0.1, 4.0);
            let all = Cone { axis: towards(1.0, 0.0, 0.0), half_angle_rad: 4.0 };
            (0..100).for_each(|_| watch.look(&[all], &[], 0.0, 0.1, 0.0));
            assert!(watch.empty_m(&towards(1.0, 0.0, 0.0)).abs() < 1e-12);
        }
    }
}
