//! Whether a part goes on past the end of its tile, where the threshold is higher: a piece of a bright background.
//!
//! At the edge of a bright sky the tiles that hold some dark ground have a low threshold and those next to them a high
//! one: the sky in between is bright on one side of a tile's border and not on the other. A marker is darker around its
//! summit on every side.

use super::Extent;
use super::background::Background;
use super::runs::Run;
use super::tiles::TILE_PX;
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
    let is_low = |u: usize, v: usize| background.threshold(u, v) <= u16::from(half);
    let across = tiles(extent.left, extent.right, right);
    if tiles(extent.top, extent.bottom, bottom).all(|v| across.clone().all(|u| is_low(u, v))) {
        return false;
    }
    runs.iter().any(|run| {
        let (first, last) = (usize::from(run.start).saturating_sub(1), usize::from(run.end).min(right));
        let rows = usize::from(run.v).saturating_sub(1)..=(usize::from(run.v) + 1).min(bottom);
        rows.into_iter().any(|v| {
            let pixels = &frame.row(v)[first..=last];
            pixels
                .iter()
                .zip(first..)
                .any(|(&pixel, u)| pixel > half && u16::from(pixel) < background.threshold(u, v))
        })
    })
}

/// A coordinate in each tile that a stretch of pixels, and those that touch it, lies in.
fn tiles(first: u32, last: u32, most: usize) -> impl Iterator<Item = usize> + Clone {
    let [first, last] = [first.saturating_sub(1), last + 1].map(|at| (at as usize).min(most) / TILE_PX);
    (first..=last).map(|tile| tile * TILE_PX)
}
