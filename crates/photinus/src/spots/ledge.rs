//! Whether a part goes on past the end of its tile, where the threshold is higher: a piece of a bright background.
//!
//! At the edge of a bright sky the tiles that hold some dark ground have a low threshold and those next to them a high
//! one: the sky in between is bright on one side of a tile's border and not on the other. A marker is darker around its
//! summit on every side.

use super::Extent;
use super::background::{Background, TILE_PX};
use super::runs::Run;
use crate::frame::FrameView;

/// Whether some pixel that touches the part is higher than `half`, yet below the threshold of its own tile.
pub(super) fn goes_on(
    frame: &FrameView<'_>,
    background: &Background,
    runs: &[Run],
    extent: &Extent,
    half: u8,
) -> bool {
    let (right, bottom) = (frame.width() - 1, frame.height() - 1);
    let tile = |pixel: u32, most: usize| (pixel as usize).min(most) / TILE_PX;
    let rows = tile(extent.top.saturating_sub(1), bottom)..=tile(extent.bottom + 1, bottom);
    let columns = tile(extent.left.saturating_sub(1), right)..=tile(extent.right + 1, right);
    let is_high = |&threshold: &u16| threshold > u16::from(half);
    if !rows.into_iter().any(|row| background.row(row).0[columns.clone()].iter().any(is_high)) {
        return false;
    }
    runs.iter().any(|run| {
        let (first, last) = (usize::from(run.start).saturating_sub(1), usize::from(run.end).min(right));
        let rows = usize::from(run.v).saturating_sub(1)..=(usize::from(run.v) + 1).min(bottom);
        rows.into_iter().any(|v| {
            let thresholds = background.row(v / TILE_PX).0;
            let pixels = &frame.row(v)[first..=last];
            pixels
                .iter()
                .zip(first..)
                .any(|(&pixel, u)| pixel > half && u16::from(pixel) < thresholds[u / TILE_PX])
        })
    })
}
