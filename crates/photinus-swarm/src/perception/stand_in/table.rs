//! The table of errors: fitted to what rendered frames told of neighbours whose places were known.
//!
//! Whether a neighbour is followed depends on how much light reaches the camera and on how many markers show; how wrong it is told depends on its distance
//! and on how many markers show. Light is told as the distance at which one LED, straight ahead, exposed for 1000 us, gives as much.

use std::path::Path;

use photinus_io::{Result, table as toml_table};
use serde::{Deserialize, Serialize};

/// Edges between the bins of distance, m.
const EDGES_M: [f64; 8] = [4.0, 6.0, 8.0, 10.0, 12.5, 15.0, 20.0, 25.0];
/// Bins of distance: one more than edges.
pub(super) const BINS: usize = EDGES_M.len() + 1;
/// Classes of markers that show: one, two, three and more.
pub(super) const CLASSES: usize = 3;
/// A cell with fewer samples takes those of its nearest bin, too.
const FEWEST: usize = 30;

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
    /// As of [`super::super::InView`].
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
    /// Logarithms of the bounds over the true distance; `None` where there is none at that end.
    pub log_bounds: [Option<f64>; 2],
    /// Logarithms of l_A and l_B over the true distance, where they were told.
    pub log_estimates: Option<[f64; 2]>,
    /// The bound of the bearing, rad.
    pub bearing_bound_rad: f64,
    /// Whether this very frame showed it.
    pub is_fresh: bool,
}

/// Errors of neighbours at some distance that show some markers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Cell {
    /// Samples that it stands on.
    pub samples: usize,
    /// Mean and standard deviation of the logarithm of told over true distance.
    pub range_bias: f64,
    /// Its standard deviation.
    pub range_sigma: f64,
    /// For how long an error of the distance lasts, s.
    pub range_lasts_s: f64,
    /// What is said of the relative error of distance, sigma.
    pub range_sigma_told: f64,
    /// Error of the direction per axis, sigma, rad.
    pub across_sigma_rad: f64,
    /// What is said of it.
    pub across_sigma_told_rad: f64,
    /// Error of the velocity per axis, sigma, m/s.
    pub velocity_sigma_m_s: f64,
    /// What is said of it.
    pub velocity_sigma_told_m_s: f64,
    /// Median logarithm of the lower bound over the true distance, and half the width between its quartiles.
    pub lower: [f64; 2],
    /// The same of the upper bound, of those that are finite.
    pub upper: [f64; 2],
    /// Share of upper bounds that are infinite.
    pub unbounded: f64,
    /// Share of pairs of bounds that the truth leaves.
    pub broken: f64,
    /// Median logarithms of l_A and l_B over the true distance.
    pub estimates: [f64; 2],
    /// Median bound of the bearing, rad.
    pub bearing_bound_rad: f64,
    /// Share of reports that this very frame showed, of frames in which LEDs shine.
    pub fresh: f64,
}

/// Whether neighbours are followed whose light is that of some distance.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Following {
    /// Samples that it stands on.
    pub samples: usize,
    /// Share of frames in which one who is in view is followed.
    pub share: f64,
    /// For how long one is followed without a break, s.
    pub lasts_s: f64,
}

/// The table.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StandInTable {
    /// Time from when a vehicle is followed until its word is read, s.
    pub name_s: f64,
    /// Phantoms per camera and second.
    pub phantoms_per_s: f64,
    /// How long a phantom is reported, s.
    pub phantom_lasts_s: f64,
    /// By class of markers, then by bin of distance.
    pub error: Vec<Vec<Cell>>,
    /// By class of markers, then by bin of light.
    pub following: Vec<Vec<Following>>,
}

impl StandInTable {
    /// The table that the program carries, fitted by the example `fit_stand_in`.
    ///
    /// # Panics
    /// Never: a test reads it.
    pub fn carried() -> Self {
        let text = include_str!("table.toml");
        Self::parse(text, Path::new("stand_in/table.toml")).expect("the program's own table")
    }

    /// Reads a table.
    ///
    /// # Errors
    /// [`photinus_io::Error`] with the line of what is wrong, and where bins are missing.
    pub fn parse(text: &str, path: &Path) -> Result<Self> {
        let table: Self = toml_table::parse(text, path)?;
        let whole = |lengths: Vec<usize>| lengths == vec![BINS; CLASSES];
        let errors = table.error.iter().map(Vec::len).collect();
        if whole(errors) && whole(table.following.iter().map(Vec::len).collect()) {
            return Ok(table);
        }
        let reason = format!("it has not {CLASSES} classes of {BINS} bins each");
        Err(photinus_io::Error::format(path, reason).advise("fit it anew"))
    }

    /// Errors at a distance with this many markers.
    pub fn errors(&self, distance_m: f64, markers: usize) -> &Cell {
        &self.error[class(markers)][bin(distance_m)]
    }

    /// Whether one is followed whose brightest marker gives such light.
    pub fn follows(&self, light: f64, markers: usize) -> &Following {
        &self.following[class(markers)][bin(as_distance_m(light))]
    }
}

/// The distance at which one LED straight ahead gives as much light in 1000 us, m.
fn as_distance_m(light: f64) -> f64 {
    (1000.0 / light).sqrt()
}

fn class(markers: usize) -> usize {
    markers.clamp(1, CLASSES) - 1
}

fn bin(distance_m: f64) -> usize {
    EDGES_M.iter().filter(|edge_m| distance_m > **edge_m).count()
}

/// Fits a table. `phantoms` are how many neighbours were reported where no vehicle was, for how many seconds in all, and how many seconds all cameras looked together;
/// `names_s` are the times until words were read; LEDs shone for the share `lit` of the time.
pub(crate) fn fit(
    samples: &[Sample],
    phantoms: (usize, f64, f64),
    names_s: &[f64],
    lit: f64,
) -> StandInTable {
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
    let errors = |class: usize| (0..BINS).map(|at| cell(&of(class, &by_distance, at), lit)).collect();
    let follows = |class: usize| (0..BINS).map(|at| following(&of(class, &by_light, at))).collect();
    let (count, told_s, looked_s) = phantoms;
    StandInTable {
        name_s: round(median(names_s.to_vec())),
        phantoms_per_s: if looked_s > 0.0 { round(count as f64 / looked_s) } else { 0.0 },
        phantom_lasts_s: if count > 0 { round(told_s / count as f64) } else { 0.0 },
        error: (0..CLASSES).map(errors).collect(),
        following: (0..CLASSES).map(follows).collect(),
    }
}

fn cell(samples: &[&Sample], lit: f64) -> Cell {
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
    let quartiles = |numbers: Vec<f64>| {
        let (middle, sigma) = core_of(numbers);
        [middle, sigma].map(round)
    };
    Cell {
        samples: told.len(),
        range_bias: round(range_bias),
        range_sigma: round(range_sigma),
        range_lasts_s: round(lasts_s(samples, range_bias)),
        range_sigma_told: round(median(numbers(&|told| told.range_sigma))),
        across_sigma_rad: round(core_of(across).1),
        across_sigma_told_rad: round(median(numbers(&|told| told.across_sigma_rad))),
        velocity_sigma_m_s: round(core_of(velocity).1),
        velocity_sigma_told_m_s: round(median(numbers(&|told| told.velocity_sigma_m_s))),
        lower: quartiles(known(&|told| told.log_bounds[0])),
        upper: quartiles(known(&|told| told.log_bounds[1])),
        unbounded: round(share(&|told| told.log_bounds[1].is_none())),
        broken: round(share(&|told| {
            told.log_bounds[0].is_some_and(|low| low > 0.0)
                || told.log_bounds[1].is_some_and(|high| high < 0.0)
        })),
        estimates: [0, 1].map(|which| round(median(known(&|told| Some(told.log_estimates?[which]))))),
        bearing_bound_rad: round(median(numbers(&|told| told.bearing_bound_rad))),
        fresh: round((share(&|told| told.is_fresh) / lit).min(1.0)),
    }
}

/// Time after which the correlation of distance errors of a pair is 1/e, from that of frames that follow on each other.
fn lasts_s(samples: &[&Sample], bias: f64) -> f64 {
    let (mut square, mut cross, mut step_s, mut pairs) = (0.0, 0.0, 0.0, 0.0);
    for (before, after) in successive(samples) {
        if let (Some(a), Some(b)) = (before.told, after.told) {
            // errors far out are cut, as in the sigma of the core
            let [a, b] = [a, b].map(|told| (told.log_range - bias).clamp(-0.5, 0.5));
            square += 0.5 * (a * a + b * b);
            cross += a * b;
            step_s += after.time_s - before.time_s;
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
    let followed = samples.iter().filter(|sample| sample.told.is_some()).count();
    let (mut on_s, mut ends) = (0.0, 0.0);
    for (before, after) in successive(samples) {
        if before.told.is_some() {
            on_s += after.time_s - before.time_s;
            ends += f64::from(u8::from(after.told.is_none()));
        }
    }
    Following {
        samples: samples.len(),
        share: round(followed as f64 / samples.len().max(1) as f64),
        lasts_s: round((on_s / (ends + 1.0)).clamp(0.05, 100.0)),
    }
}

/// Samples of a pair that follow on each other; they come in the order of time.
fn successive<'a>(samples: &[&'a Sample]) -> Vec<(&'a Sample, &'a Sample)> {
    let mut last: std::collections::BTreeMap<(usize, usize), &Sample> = std::collections::BTreeMap::new();
    let mut successive = Vec::new();
    for &sample in samples {
        if let Some(before) = last.insert(sample.pair, sample)
            && (1e-6..0.25).contains(&(sample.time_s - before.time_s))
        {
            successive.push((before, sample));
        }
    }
    successive
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
