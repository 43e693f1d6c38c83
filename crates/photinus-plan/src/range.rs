//! Over distance: how often spots are found and how exact what they tell can be; and the same over the aspect.

use core::f64::consts::TAU;

use photinus::airframe::Airframe;
use serde::Serialize;

use crate::bound::{Bound, Errors};
use crate::setup::Setup;
use crate::spot::SpotTable;
use crate::view::{Draw, Draws, View};

/// Ways to stand that are averaged over, and every how many of them is asked for its errors, which take longer.
const DRAWS: usize = 1500;
const ERRORS_OF: usize = 6;
/// Least distance, how many steps there are for each doubling, and the most.
const NEAREST_M: f64 = 0.5;
const PER_OCTAVE: f64 = 12.0;
const FARTHEST_M: f64 = 500.0;
/// Headings of an aspect's curve.
const ASPECTS: usize = 72;

/// What frames tell at a distance, over all ways to stand.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct AtRange {
    /// The distance, m.
    pub distance_m: f64,
    /// Share of frames with one spot or more: a direction.
    pub one: f64,
    /// Share of frames with two or more: a distance.
    pub two: f64,
    /// Half of the distances that are told are nearer to the truth than this, m.
    pub distance_error_m: Option<f64>,
    /// Root mean square of their errors, m.
    pub distance_rms_m: Option<f64>,
    /// Root mean square error of directions per axis, rad.
    pub bearing_rms_rad: Option<f64>,
    /// Root mean square error of yaws modulo the airframe's symmetry, rad.
    pub yaw_rms_rad: Option<f64>,
}

/// The least errors at an aspect, level and straight ahead; every marker that is more likely found than not is.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct AtAspect {
    /// Heading of the neighbour: the angle of its forward axis from the camera's right, rad.
    pub yaw_rad: f64,
    /// Spots that are found.
    pub spots: usize,
    /// Standard deviation of the distance, m.
    pub distance_m: Option<f64>,
    /// Standard deviation of the direction, rad.
    pub bearing_rad: Option<f64>,
}

/// How far frames have something: where the share of them first falls below a limit on the way out, m.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Reach {
    /// 95 of 100 frames.
    pub nearly_all_m: f64,
    /// One of two frames.
    pub half_m: f64,
}

/// Works out what is seen at distances and aspects.
#[derive(Debug)]
pub struct Range<'a> {
    setup: &'a Setup,
    table: &'a SpotTable,
    airframe: &'a Airframe,
    draws: Draws,
    bound: Bound<'a>,
}

impl<'a> Range<'a> {
    /// For an airframe, which need not be that of the set-up but has no more markers.
    pub fn new(setup: &'a Setup, table: &'a SpotTable, airframe: &'a Airframe) -> Self {
        let draws = Draws::new(&Setup { airframe: airframe.clone(), ..setup.clone() }, DRAWS);
        Self { setup, table, airframe, draws, bound: Bound::new(setup, table, airframe) }
    }

    /// Turns about the vertical that nothing tells apart.
    pub fn turns(&self) -> usize {
        self.bound.turns()
    }

    /// How far one spot, and two spots, are found.
    pub fn reach(&self) -> [Reach; 2] {
        let steps = (libm::log2(FARTHEST_M / NEAREST_M) * PER_OCTAVE) as usize;
        let distance_m = |step: usize| NEAREST_M * libm::exp2(step as f64 / PER_OCTAVE);
        let shares: Vec<[f64; 2]> = (0..=steps).map(|step| self.found(distance_m(step))).collect();
        [0, 1].map(|spots| {
            let ends = |limit: f64| {
                // near by markers leave the image: the way out begins where most is found
                let best = shares.iter().map(|share| share[spots]).fold(0.0, f64::max);
                if best < limit {
                    return 0.0;
                }
                let enough = |share: &[f64; 2]| share[spots] >= limit;
                let first = shares.iter().position(enough).unwrap_or(0);
                let short = shares[first..].iter().position(|share| !enough(share));
                let Some(short) = short.map(|after| first + after) else { return FARTHEST_M };
                let [above, below] = [shares[short - 1][spots], shares[short][spots]];
                let back = (limit - below) / (above - below).max(1e-12);
                distance_m(short) * libm::exp2(-back / PER_OCTAVE)
            };
            Reach { nearly_all_m: ends(0.95), half_m: ends(0.5) }
        })
    }

    /// Share of frames with one spot, and with two.
    pub fn found(&self, distance_m: f64) -> [f64; 2] {
        let mut sums = [0.0; 2];
        for draw in &self.draws.0 {
            let found = View::new(self.setup, self.table, self.airframe, draw, distance_m).found();
            sums = [sums[0] + found[0], sums[1] + found[1]];
        }
        sums.map(|sum| sum / self.draws.0.len() as f64)
    }

    /// What frames tell at a distance.
    pub fn at(&mut self, distance_m: f64) -> AtRange {
        let [one, two] = self.found(distance_m);
        let mut errors: Vec<Errors> = Vec::new();
        for draw in self.draws.0.iter().step_by(ERRORS_OF) {
            let view = View::new(self.setup, self.table, self.airframe, draw, distance_m);
            errors.extend(self.bound.errors(&view, &view.seen(&draw.luck)));
        }
        let rms = |of: fn(&Errors) -> f64| {
            let square = errors.iter().map(|errors| of(errors) * of(errors)).sum::<f64>();
            (!errors.is_empty()).then(|| (square / errors.len() as f64).sqrt())
        };
        AtRange {
            distance_m,
            one,
            two,
            distance_error_m: median_of_normals(errors.iter().map(|errors| errors.distance_m)),
            distance_rms_m: rms(|errors| errors.distance_m),
            bearing_rms_rad: rms(|errors| errors.bearing_rad),
            yaw_rms_rad: rms(|errors| errors.yaw_rad),
        }
    }

    /// All aspects at a distance: one turn of those that the airframe's symmetry leaves.
    pub fn aspects(&mut self, distance_m: f64) -> Vec<AtAspect> {
        let turn_rad = TAU / self.turns() as f64;
        let mut at = |step: usize| {
            let yaw_rad = turn_rad * step as f64 / ASPECTS as f64;
            let draw = Draw::level(yaw_rad, self.airframe.markers().len());
            let view = View::new(self.setup, self.table, self.airframe, &draw, distance_m);
            let seen = view.seen(&draw.luck);
            let errors = self.bound.errors(&view, &seen);
            AtAspect {
                yaw_rad,
                spots: seen.len(),
                distance_m: errors.map(|errors| errors.distance_m),
                bearing_rad: errors.map(|errors| errors.bearing_rad),
            }
        };
        (0..=ASPECTS).map(&mut at).collect()
    }
}

/// The median of the size of normal errors, one of each standard deviation.
fn median_of_normals(sigmas: impl Iterator<Item = f64>) -> Option<f64> {
    let sigmas: Vec<f64> = sigmas.collect();
    let largest = sigmas.iter().copied().fold(0.0, f64::max);
    if largest <= 0.0 {
        return None;
    }
    let below = |error: f64| {
        let share = |sigma: &f64| libm::erf(error / (core::f64::consts::SQRT_2 * sigma));
        sigmas.iter().map(share).sum::<f64>() / sigmas.len() as f64
    };
    let (mut low, mut high) = (0.0, largest);
    for _ in 0..50 {
        let middle = 0.5 * (low + high);
        if below(middle) < 0.5 { low = middle } else { high = middle }
    }
    Some(0.5 * (low + high))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_of_normal_errors_are_below_their_median() {
        let one = median_of_normals([2.0].into_iter()).unwrap();
        assert!((one - 2.0 * 0.674_489_75).abs() < 1e-6, "{one}");
        // by integration over a mixture of 1 and 3: erf(x / sqrt 2) + erf(x / (3 sqrt 2)) = 1
        let two = median_of_normals([1.0, 3.0].into_iter()).unwrap();
        let shares = libm::erf(two / 2.0_f64.sqrt()) + libm::erf(two / (3.0 * 2.0_f64.sqrt()));
        assert!((shares - 1.0).abs() < 1e-9 && one > two, "{two}");
        assert_eq!(median_of_normals(std::iter::empty()), None);
    }
}
