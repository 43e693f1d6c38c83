//! Areas over distance, bin by bin.

use super::Sample;

/// Twelve bins to a factor of ten in distance.
const BINS_PER_DECADE: f64 = 12.0;

/// The spots between two distances.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bin {
    /// Nearest distance, m.
    pub from_m: f64,
    /// Farthest distance, m.
    pub to_m: f64,
    /// Samples, with and without a spot.
    pub samples: usize,
    /// Samples without a spot.
    pub unseen: usize,
    /// Smallest area, px; 0 when there is no spot at all.
    pub min_px: u32,
    /// Median area, px.
    pub median_px: u32,
    /// Largest area, px.
    pub max_px: u32,
}

/// Bins of equal ratios of distance, nearest first; empty ones are left out, and so are `outliers` (ascending).
pub(super) fn bins(samples: &[Sample], outliers: &[usize]) -> Vec<Bin> {
    let number = |sample: &Sample| (BINS_PER_DECADE * libm::log10(sample.distance_m)).floor();
    let kept = samples.iter().enumerate().filter(|(index, _)| outliers.binary_search(index).is_err());
    let mut binned: Vec<(f64, u32)> = kept.map(|(_, sample)| (number(sample), sample.area_px)).collect();
    binned.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    binned
        .chunk_by(|a, b| a.0.total_cmp(&b.0).is_eq())
        .map(|bin| {
            let unseen = bin.iter().filter(|sample| sample.1 == 0).count();
            let seen = &bin[unseen..];
            let area_px = |index: usize| seen.get(index).map_or(0, |sample| sample.1);
            Bin {
                from_m: libm::exp10(bin[0].0 / BINS_PER_DECADE),
                to_m: libm::exp10((bin[0].0 + 1.0) / BINS_PER_DECADE),
                samples: bin.len(),
                unseen,
                min_px: area_px(0),
                median_px: area_px(seen.len() / 2),
                max_px: area_px(seen.len().saturating_sub(1)),
            }
        })
        .collect()
}
