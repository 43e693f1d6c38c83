//! A plan beside what frames gave.

use photinus_plan::{Range, Setup, SpotTable};

use crate::flown::{Flight, Flown};

/// Where errors are compared, against the range: changes from set-up to set-up between these.
const SHARES: [f64; 2] = [0.25, 0.7];

/// How far before and behind the planned range it is looked for, in the logarithm of distance.
const STRETCH: f64 = 0.3;

/// A number as planned and as measured.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pair {
    pub(crate) planned: f64,
    pub(crate) measured: f64,
}

impl Pair {
    /// How much more was planned than measured.
    pub(crate) fn off(&self) -> f64 {
        self.planned / self.measured - 1.0
    }
}

/// What is compared of a set-up.
pub(crate) struct Compared {
    /// Where half of the frames show two spots, m.
    pub(crate) range_m: Pair,
    /// At this distance, m,
    pub(crate) at_m: f64,
    /// the median error of distance, m,
    pub(crate) error_m: Pair,
    /// and the root mean square error, m.
    pub(crate) rms_m: Pair,
}

/// Plans a set-up and flies it, so many frames for the range and as many for the error.
pub(crate) fn compared(setup: &Setup, seed: u64, frames: u32) -> Compared {
    let table = SpotTable::new(setup);
    let mut range = Range::new(setup, &table, &setup.airframe);
    let planned_m = range.reach()[1].half_m;
    // the golden ratio spreads the shares evenly over the set-ups
    let share = SHARES[0] + (SHARES[1] - SHARES[0]) * (0.618_034 * seed as f64).fract();
    let at_m = share * planned_m;
    let at = range.at(at_m);
    let mut flight = Flight::new(setup, seed);
    let near: Vec<Flown> = (0..frames).map(|_| flight.look(at_m)).collect();
    let mut errors_m: Vec<f64> = near.iter().filter_map(|flown| flown.error_m).map(f64::abs).collect();
    errors_m.sort_unstable_by(f64::total_cmp);
    let square = errors_m.iter().map(|error| error * error).sum::<f64>() / errors_m.len().max(1) as f64;
    // a stretch about the border over which the share of frames falls nearly straight
    let way = |number: u32| libm::exp(STRETCH * (2.0 * (f64::from(number) + 0.5) / f64::from(frames) - 1.0));
    let far: Vec<Flown> = (0..frames).map(|number| flight.look(planned_m * way(number))).collect();
    let missing = f64::NAN;
    Compared {
        range_m: Pair { planned: planned_m, measured: half_m(&far) },
        at_m,
        error_m: Pair {
            planned: at.distance_error_m.unwrap_or(missing),
            measured: errors_m.get(errors_m.len() / 2).copied().unwrap_or(missing),
        },
        rms_m: Pair { planned: at.distance_rms_m.unwrap_or(missing), measured: square.sqrt() },
    }
}

/// Where half of the frames show two spots: the share of them as a straight line over the logarithm of distance, by least squares.
fn half_m(frames: &[Flown]) -> f64 {
    let count = frames.len() as f64;
    let point = |flown: &Flown| (libm::log(flown.distance_m), if flown.spots >= 2 { 1.0 } else { 0.0 });
    let mean =
        |of: &dyn Fn((f64, f64)) -> f64| frames.iter().map(|frame| of(point(frame))).sum::<f64>() / count;
    let (middle, share) = (mean(&|point| point.0), mean(&|point| point.1));
    let slope =
        mean(&|point| (point.0 - middle) * point.1) / mean(&|point| (point.0 - middle) * (point.0 - middle));
    libm::exp(middle + (0.5 - share) / slope)
}
