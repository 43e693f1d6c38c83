//! Results compared with ground truth: how often, how far off, and whether bounds and covariances keep their word.
//!
//! ```text
//! truth, results -> frames   every frame of truth with its result, or without one      frames
//!                -> pairing  which spot is which LED, which neighbour is which          pairing
//!                -> scores   counts and errors, over all and by range                   score
//! ```
//!
//! A frame of truth that the results do not hold counts against them: all that was in it is missed. A neighbour none of
//! whose LEDs shone into the image need not be found; found, it is neither right nor false, but its errors count. Where
//! truth lists no LED in any frame (truth of a flight, from GNSS), every neighbour counts as visible and spots have no
//! score.

pub mod alignment;
mod frames;
#[cfg(test)]
mod hand_made;
mod pairing;
#[cfg(test)]
mod properties;
mod score;

use photinus_io::dataset::TruthFrame;
use photinus_io::results::FrameRecord;
use serde::Serialize;

pub use frames::{EvaluateError, Pair, Side};
pub use score::bounds::{BoundScore, Bounds, Violation};
pub use score::classes::{ClassScore, SpotClass};
pub use score::distance::{DistanceScore, PaperScore};
pub use score::followed::FollowedScore;
pub use score::gospa::GospaScore;
pub use score::neighbours::{APART_PX, LIKELY, NeighbourScore, Neighbours, SURE};
pub use score::position::{CHI_SQUARE_3_50, CHI_SQUARE_3_95, Consistency, PositionScore};
pub use score::probability::{Decile, Kept, ProbabilityScore, expected_calibration_error};
pub use score::range::{Bin, ByRange, RangeBins};
pub use score::spots::{SpotScore, Spots};
pub use score::spread::Spread;
pub use score::tracks::{IdentityScore, TrackScore};
pub use score::{Frames, Scores};

/// What a user may choose about scoring. Begin with [`Settings::default`] and change what you must.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Settings {
    /// A spot is no farther than this from its LED, px, or than its own radius where that is more. Default 3.
    pub spot_gate_px: f64,
    /// A neighbour's bearing is no farther than this from truth, rad. Default 0.05.
    pub bearing_gate_rad: f64,
    /// Near by, a neighbour may be so far aside instead, m: about what an airframe measures. Default 0.6.
    pub lateral_gate_m: f64,
    /// Times of the same frame may differ by this, s. Default 1 ms.
    pub time_tolerance_s: f64,
    /// A vehicle farther than this from where truth has it is another one, to GOSPA, m. Default 2.
    pub gospa_cutoff_m: f64,
    /// A vehicle that shows again within this time is expected to be followed meanwhile, s. Default 2.
    pub occlusion_s: f64,
    /// How distances are binned: the edges between bins, m.
    #[serde(rename = "bins_m")]
    pub bins: RangeBins,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            spot_gate_px: 3.0,
            bearing_gate_rad: 0.05,
            lateral_gate_m: 0.6,
            time_tolerance_s: 1e-3,
            gospa_cutoff_m: 2.0,
            occlusion_s: 2.0,
            bins: RangeBins::default(),
        }
    }
}

/// What came out.
#[derive(Clone, Debug, PartialEq)]
pub struct Evaluation<'a> {
    /// Every number.
    pub scores: Scores,
    /// Each neighbour that was found, beside its truth, in the order of truth.
    pub pairs: Vec<Pair<'a>>,
}

/// Compares `results` with `truth`, both in any order.
///
/// # Errors
/// [`EvaluateError`] when there is nothing to compare, when the two are not of the same dataset, or when truth
/// contradicts itself.
pub fn evaluate<'a>(
    truth: &'a [TruthFrame],
    results: &'a [FrameRecord],
    settings: &Settings,
) -> Result<Evaluation<'a>, EvaluateError> {
    let compared = frames::Compared::new(truth, results, settings)?;
    Ok(Evaluation { scores: score::score(&compared, settings), pairs: compared.pairs })
}
