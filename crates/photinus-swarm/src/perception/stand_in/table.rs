//! The table of errors: what rendered frames told of neighbours whose places were known.
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
/// Shares of bounds that are lower than the table's five numbers of them.
pub(super) const QUANTILES: [f64; 5] = [0.05, 0.25, 0.5, 0.75, 0.95];

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
    /// Logarithm of the lower bound over the true distance: 5, 25, 50, 75 and 95 % of bounds are lower.
    pub lower: [f64; 5],
    /// The same of the upper bound, of those that are finite.
    pub upper: [f64; 5],
    /// For how long bounds stay as loose as they are, s.
    pub bounds_last_s: f64,
    /// Share of upper bounds that are infinite.
    pub unbounded: f64,
    /// Share of pairs of bounds that the truth leaves.
    pub broken: f64,
    /// Median logarithms of l_A and l_B over the true distance.
    pub estimates: [f64; 2],
    /// Median bound of the bearing, rad.
    pub bearing_bound_rad: f64,
    /// Share of reports that this very frame showed.
    pub fresh: f64,
}

/// Whether neighbours are followed whose light is that of some distance.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Following {
    /// Samples that it stands on.
    pub samples: usize,
    /// How long it takes on the average until one who is in view is found, or found again, s; 0 for in the first frame.
    pub found_s: f64,
    /// For how long one is followed without a break, s.
    pub lasts_s: f64,
}

/// How neighbours are seen whose LEDs do one thing.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Eyesight {
    /// Phantoms per camera and second.
    pub phantoms_per_s: f64,
    /// How long a phantom is reported, s.
    pub phantom_lasts_s: f64,
    /// By class of markers, then by bin of distance.
    pub error: Vec<Vec<Cell>>,
    /// By class of markers, then by bin of light.
    pub following: Vec<Vec<Following>>,
}

/// The table.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StandInTable {
    /// Time from when a vehicle is followed until its word is read, s.
    pub name_s: f64,
    /// Pixels of the largest spot: so many with 1 us/m^2 of light, by which power of the light they grow, and the sigma of their logarithm.
    pub spot_px: [f64; 3],
    /// Neighbours whose LEDs shine all the time.
    pub steady: Eyesight,
    /// Neighbours whose LEDs blink words.
    pub blinking: Eyesight,
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
        let is_whole = |sight: &Eyesight| {
            whole(sight.error.iter().map(Vec::len).collect())
                && whole(sight.following.iter().map(Vec::len).collect())
        };
        if is_whole(&table.steady) && is_whole(&table.blinking) {
            return Ok(table);
        }
        let reason = format!("it has not {CLASSES} classes of {BINS} bins each");
        Err(photinus_io::Error::format(path, reason).advise("fit it anew"))
    }

    /// How neighbours are seen that blink, or do not.
    pub fn of(&self, blinks: bool) -> &Eyesight {
        if blinks { &self.blinking } else { &self.steady }
    }
}

impl Eyesight {
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
pub(super) fn as_distance_m(light: f64) -> f64 {
    (1000.0 / light).sqrt()
}

pub(super) fn class(markers: usize) -> usize {
    markers.clamp(1, CLASSES) - 1
}

pub(super) fn bin(distance_m: f64) -> usize {
    EDGES_M.iter().filter(|edge_m| distance_m > **edge_m).count()
}

/// The number that a share of all is below of, between those of [`QUANTILES`] as on straight lines and no farther out than these.
pub(super) fn between(numbers: &[f64; 5], share: f64) -> f64 {
    let part = (1..QUANTILES.len() - 1).find(|&part| share < QUANTILES[part]).unwrap_or(QUANTILES.len() - 1);
    let along = (share - QUANTILES[part - 1]) / (QUANTILES[part] - QUANTILES[part - 1]);
    numbers[part - 1] + (numbers[part] - numbers[part - 1]) * along.clamp(0.0, 1.0)
}
