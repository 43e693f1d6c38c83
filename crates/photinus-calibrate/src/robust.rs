//! What deviates too far: weights that let it count little, and the line past which it is left out.

/// A residual this many times the typical one is left out.
const OUTLIER: f64 = 5.0;
/// Median length of a two-dimensional normal residual, in sigmas of one axis: the root of 2 log 2.
const MEDIAN_OF_TWO_AXES: f64 = 1.177_410_022_515_474_6;

/// How residuals count.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Loss {
    /// By their squares.
    Squares,
    /// As Cauchy has it: by their squares far below this scale, hardly at all far above.
    Cauchy(f64),
}

impl Loss {
    /// What a residual of this squared length costs, and the weight of its square in a step.
    pub(crate) fn cost_and_weight(self, squared: f64) -> (f64, f64) {
        match self {
            Self::Squares => (squared, 1.0),
            Self::Cauchy(scale) => {
                let ratio = squared / (scale * scale);
                (scale * scale * libm::log1p(ratio), 1.0 / (1.0 + ratio))
            }
        }
    }
}

/// Sigma of one axis of two-dimensional residuals, from the median of their lengths, which outliers hardly move.
pub(crate) fn sigma(lengths: impl Iterator<Item = f64>) -> f64 {
    let mut lengths: Vec<f64> = lengths.collect();
    lengths.sort_unstable_by(f64::total_cmp);
    lengths.get(lengths.len() / 2).map_or(0.0, |median| median / MEDIAN_OF_TWO_AXES)
}

/// Whether a residual of this length is an outlier among those of this sigma.
pub(crate) fn is_outlier(length: f64, sigma: f64) -> bool {
    length.is_nan() || length > OUTLIER * sigma
}
