//! What rendered frames told of neighbours whose places were known -> the table.

use super::table::{BINS, CLASSES, Cell, Eyesight, Following, QUANTILES, as_distance_m, bin, class};

/// A cell with fewer samples takes those of its nearest bin, too.
const FEWEST: usize = 200;

/// A pair of vehicles in a frame, one of which could see the other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Sample {
    /// Who looks, and at whom.
    pub pair: (usize, usize),
    /// When, s.
    pub time_s: f64,
    /// From the one to the other, m.
    pub distance_m: f64,
    /// Markers that show.
    pub markers: usize,
    /// As of [`crate::perception::InView`].
    pub light: f64,
    /// What was told, if the neighbour was followed.
    pub told: Option<Told>,
}

/// What was told of a neighbour, against the truth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Told {
    /// Logarithm of told over true distance.
    pub log_range: f64,
    /// Off along the two directions across the line of sight, rad: to the left, up.
    pub across_rad: [f64; 2],
    /// What it said of its relative error of distance, sigma.
    pub range_sigma: f64,
    /// What it said of its error across, sigma, rad.
    pub across_sigma_rad: f64,
    /// Error of the velocity along three axes, m/s.
    pub velocity_m_s: [f64; 3],
    /// What it said of that, sigma per axis, m/s.
    pub velocity_sigma_m_s: f64,
    /// Logarithms of the bounds over the true distance; `None` where there is none at that end, or none of this frame.
    pub log_bounds: [Option<f64>; 2],
    /// Logarithms of l_A and l_B over the true distance, where they were told.
    pub log_estimates: Option<[f64; 2]>,
    /// The bound of the bearing, rad.
    pub bearing_bound_rad: f64,
    /// Pixels of its largest spot.
    pub spot_px: Option<f64>,
    /// Whether this very frame showed it.
    pub is_fresh: bool,
}

/// Counts of phantoms.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Phantoms {
    /// Neighbours that were told of where no vehicle was.
    pub count: usize,
    /// For how long in all, s.
    pub told_s: f64,
    /// How long all cameras looked together, s.
    pub looked_s: f64,
}

/// Fits how neighbours are seen that do one thing with their LEDs.
pub(crate) fn fit(samples: &[Sample], phantoms: Phantoms) -> Eyesight {
    let of = |wanted: usize, what: &dyn Fn(&Sample) -> usize, at: usize| -> Vec<&Sample> {
        let mut near: Vec<&Sample> = Vec::new();
        // a cell that is nearly empty is like those beside it: bins are joined until there are enough, then classes
        for reach in 0..CLASSES * BINS {
            let (classes, bins) = (reach / BINS, reach % BINS);
            let is_near = |sample: &&Sample| {
                class(sample.markers).abs_diff(wanted) <= classes && what(sample).abs_diff(at) <= bins
            };
            near = samples.iter().filter(is_near).collect();
            if near.len() >= FEWEST {
                break;
            }
        }
        near
    };
    let by_distance = |sample: &Sample| bin(sample.distance_m);
    let by_light = |sample: &Sample| bin(as_distance_m(sample.light));
    let errors = |class: usize| (0..BINS).map(|at| cell(&of(class, &by_distance, at))).collect();
    let follows = |class: usize| (0..BINS).map(|at| following(&of(class, &by_light, at))).collect();
    let Phantoms { count, told_s, looked_s } = phantoms;
    Eyesight {
        phantoms_per_s: if looked_s > 0.0 { round(count as f64 / looked_s) } else { 0.0 },
        phantom_lasts_s: if count > 0 { round(told_s / count as f64) } else { 0.0 },
        error: (0..CLASSES).map(errors).collect(),
        following: (0..CLASSES).map(follows).collect(),
    }
}

/// The law of the size of spots, as of [`StandInTable::spot_px`]: a line through logarithms.
pub(crate) fn spot_law<'a>(samples: impl Iterator<Item = &'a Sample>) -> [f64; 3] {
    // spots of a pixel or two are those that could not be smaller
    let spot = |sample: &Sample| {
        let px = sample.told?.spot_px.filter(|px| *px > 2.0)?;
        Some((libm::log(sample.light), libm::log(px)))
    };
    let spots: Vec<(f64, f64)> = samples.filter_map(spot).collect();
    let count = spots.len().max(1) as f64;
    let mean = |of: &dyn Fn(&(f64, f64)) -> f64| spots.iter().map(of).sum::<f64>() / count;
    let (light, px) = (mean(&|spot| spot.0), mean(&|spot| spot.1));
    let spread = mean(&|spot| (spot.0 - light) * (spot.0 - light));
    let together = mean(&|spot| (spot.0 - light) * (spot.1 - px));
    let power = if spread > 0.0 { together / spread } else { 0.0 };
    let off = |spot: &(f64, f64)| spot.1 - px - power * (spot.0 - light);
    let sigma = core_of(spots.iter().map(off).collect()).1;
    [libm::exp(px - power * light), power, sigma].map(round)
}

/// The typical time until a word was read, s.
pub(crate) fn name_s(names_s: &[f64]) -> f64 {
    round(median(names_s.to_vec()))
}

fn cell(samples: &[&Sample]) -> Cell {
    let told: Vec<Told> = samples.iter().filter_map(|sample| sample.told).collect();
    let numbers = |of: &dyn Fn(&Told) -> f64| -> Vec<f64> { told.iter().map(of).collect() };
    let share = |of: &dyn Fn(&Told) -> bool| {
        told.iter().filter(|told| of(told)).count() as f64 / told.len().max(1) as f64
    };
    let known = |of: &dyn Fn(&Told) -> Option<f64>| -> Vec<f64> { told.iter().filter_map(of).collect() };
    // errors have long tails: quartiles give the sigma of the core, and rare ones are left to the tests of the table
    let (range_bias, range_sigma) = core_of(numbers(&|told| told.log_range));
    let across = told.iter().flat_map(|told| told.across_rad).collect();
    let velocity = told.iter().flat_map(|told| told.velocity_m_s).collect();
    let lower = known(&|told| told.log_bounds[0]);
    let upper = known(&|told| told.log_bounds[1]);
    let middle = quantiles(&lower)[2];
    Cell {
        samples: told.len(),
        range_bias: round(range_bias),
        range_sigma: round(range_sigma),
        range_lasts_s: round(lasts_s(samples, &|told| Some(told.log_range - range_bias))),
        range_sigma_told: round(median(numbers(&|told| told.range_sigma))),
        across_sigma_rad: round(core_of(across).1),
        across_sigma_told_rad: round(median(numbers(&|told| told.across_sigma_rad))),
        velocity_sigma_m_s: round(core_of(velocity).1),
        velocity_sigma_told_m_s: round(median(numbers(&|told| told.velocity_sigma_m_s))),
        lower: quantiles(&lower).map(|number| round(number.min(0.0))),
        upper: quantiles(&upper).map(|number| round(number.max(0.0))),
        bounds_last_s: round(lasts_s(samples, &|told| Some(told.log_bounds[0]? - middle))),
        unbounded: round(1.0 - upper.len() as f64 / lower.len().max(1) as f64),
        broken: round(share(&|told| {
            told.log_bounds[0].is_some_and(|low| low > 0.0)
                || told.log_bounds[1].is_some_and(|high| high < 0.0)
        })),
        estimates: [0, 1].map(|which| round(median(known(&|told| Some(told.log_estimates?[which]))))),
        bearing_bound_rad: round(median(numbers(&|told| told.bearing_bound_rad))),
        fresh: round(share(&|told| told.is_fresh)),
    }
}

/// Time after which the correlation of errors of a pair is 1/e, from that of frames that follow on each other.
fn lasts_s(samples: &[&Sample], error: &dyn Fn(&Told) -> Option<f64>) -> f64 {
    let (mut square, mut cross, mut step_s, mut pairs) = (0.0, 0.0, 0.0, 0.0);
    let cut = |sample: &Sample| sample.told.as_ref().and_then(error).map(|error| error.clamp(-0.5, 0.5));
    for (before, after) in successive(samples) {
        // errors far out are cut, as in the sigma of the core
        if let (Some(a), Some(b)) = (before.and_then(cut), cut(after)) {
            square += 0.5 * (a * a + b * b);
            cross += a * b;
            step_s += after.time_s - before.map_or(after.time_s, |before| before.time_s);
            pairs += 1.0;
        }
    }
    if pairs < 1.0 || square <= 0.0 {
        return 0.5;
    }
    let correlation = (cross / square).clamp(0.05, 0.999);
    (-(step_s / pairs) / libm::log(correlation)).clamp(0.02, 10.0)
}

fn following(samples: &[&Sample]) -> Following {
    let (mut followed, mut ends, mut searched, mut finds, mut step_s) = (0.0, 0.0, 0.0, 0.0, 0.0_f64);
    for (before, after) in successive(samples) {
        let is_followed = f64::from(u8::from(after.told.is_some()));
        if let Some(before) = before {
            step_s = after.time_s - before.time_s;
        }
        if before.is_some_and(|before| before.told.is_some()) {
            followed += 1.0;
            ends += 1.0 - is_followed;
        } else {
            searched += 1.0;
            finds += is_followed;
        }
    }
    // of none that ended it is not known how long they last: twice as long as they did
    let lasts_s = followed * step_s / f64::max(ends, 0.5);
    let found_s =
        if finds < searched { -step_s / libm::log1p(-f64::max(finds, 0.5) / searched) } else { 0.0 };
    Following { samples: samples.len(), found_s: round(found_s), lasts_s: round(lasts_s.clamp(0.05, 1e3)) }
}

/// Samples of a pair that follow on each other, `None` before one that came into view; they come in the order of time.
fn successive<'a>(samples: &[&'a Sample]) -> Vec<(Option<&'a Sample>, &'a Sample)> {
    let mut last: std::collections::BTreeMap<(usize, usize), &Sample> = std::collections::BTreeMap::new();
    let follow = |&sample: &&'a Sample| {
        let before = last.insert(sample.pair, sample);
        let is_next = |before: &&Sample| (1e-6..0.25).contains(&(sample.time_s - before.time_s));
        (before.filter(is_next), sample)
    };
    samples.iter().map(follow).collect()
}

/// The numbers that [`QUANTILES`] of all are below of.
fn quantiles(numbers: &[f64]) -> [f64; 5] {
    let mut sorted: Vec<f64> = numbers.iter().copied().filter(|number| number.is_finite()).collect();
    sorted.sort_unstable_by(f64::total_cmp);
    let last = sorted.len().saturating_sub(1) as f64;
    QUANTILES.map(|share| sorted.get((last * share).round() as usize).copied().unwrap_or(0.0))
}

fn median(numbers: Vec<f64>) -> f64 {
    core_of(numbers).0
}

/// Median, and the sigma of a normal distribution with the same quartiles.
fn core_of(mut numbers: Vec<f64>) -> (f64, f64) {
    numbers.retain(|number| number.is_finite());
    if numbers.is_empty() {
        return (0.0, 0.0);
    }
    numbers.sort_unstable_by(f64::total_cmp);
    let quantile = |share: f64| numbers[((numbers.len() - 1) as f64 * share).round() as usize];
    (quantile(0.5), (quantile(0.75) - quantile(0.25)) / 1.349)
}

/// To four digits: what is left is noise.
fn round(value: f64) -> f64 {
    if value.abs() <= 0.0 || !value.is_finite() {
        return 0.0;
    }
    let scale = libm::pow(10.0, 3.0 - libm::floor(libm::log10(value.abs())));
    (value * scale).round() / scale
}
