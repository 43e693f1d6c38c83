//! Bins of distance on the command line.

use photinus_evaluate::RangeBins;

/// Edges of bins, m.
pub(super) fn parse(text: &str) -> Result<RangeBins, String> {
    let edges: Result<Vec<f64>, _> = text.split(',').map(|edge| edge.trim().parse()).collect();
    edges
        .ok()
        .and_then(RangeBins::new)
        .ok_or_else(|| "give distances in m that grow, such as 2,5,10".to_owned())
}
