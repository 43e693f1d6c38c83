//! A frame in; the brightest pixels that stand out of a ring around them out. Nothing is asked of their shape: that is to be learned.

use photinus::frame::FrameView;

/// Brightest pixels nearer to each other than this are one spot, px.
const SAME_PX: f64 = 3.0;
/// Least height of a spot above the ring around it, grey levels.
const LEAST_DN: f64 = 10.0;

/// A brightest pixel.
#[derive(Clone, Copy, Debug)]
pub(super) struct Summit {
    pub(super) column: usize,
    pub(super) row: usize,
    pub(super) value: u8,
}

impl Summit {
    pub(super) fn distance_px(&self, column: usize, row: usize) -> f64 {
        libm::hypot(self.column as f64 - column as f64, self.row as f64 - row as f64)
    }
}

/// The brightest pixels that stand out, of those near each other only the brightest.
pub(super) fn find(frame: &FrameView<'_>) -> Vec<Summit> {
    let floor = background(frame).saturating_add(LEAST_DN as u8 / 2);
    let mut summits = Vec::new();
    for row in 1..frame.height().saturating_sub(1) {
        let [above, here, below] = [row - 1, row, row + 1].map(|row| frame.row(row));
        for (column, &value) in here.iter().enumerate().take(frame.width() - 1).skip(1) {
            if value <= floor {
                continue;
            }
            let near = |line: &[u8]| line[column - 1..=column + 1].iter().all(|&other| other <= value);
            if near(above) && near(here) && near(below) && stands_out(frame, column, row, value) {
                summits.push(Summit { column, row, value });
            }
        }
    }
    // brightest first; a stable order, so that plateaus keep their first pixel
    summits.sort_by_key(|summit| std::cmp::Reverse(summit.value));
    let mut kept: Vec<Summit> = Vec::new();
    for summit in summits {
        if kept.iter().all(|other| other.distance_px(summit.column, summit.row) > SAME_PX) {
            kept.push(summit);
        }
    }
    kept
}

/// Grey level that a quarter of the pixels do not reach.
fn background(frame: &FrameView<'_>) -> u8 {
    let mut counts = [0_usize; 256];
    for row in (0..frame.height()).step_by(4) {
        frame.row(row).iter().for_each(|&value| counts[usize::from(value)] += 1);
    }
    let quarter = counts.iter().sum::<usize>() / 4;
    let mut sum = 0;
    counts
        .iter()
        .position(|count| {
            sum += count;
            sum > quarter
        })
        .unwrap_or(0) as u8
}

/// Whether a pixel is well above the median of a ring around it.
fn stands_out(frame: &FrameView<'_>, column: usize, row: usize, value: u8) -> bool {
    const RING: [(isize, isize); 16] = [
        (5, 0),
        (5, 2),
        (4, 4),
        (2, 5),
        (0, 5),
        (-2, 5),
        (-4, 4),
        (-5, 2),
        (-5, 0),
        (-5, -2),
        (-4, -4),
        (-2, -5),
        (0, -5),
        (2, -5),
        (4, -4),
        (5, -2),
    ];
    let mut ring = Vec::with_capacity(RING.len());
    for (right, down) in RING {
        let place = column.checked_add_signed(right).zip(row.checked_add_signed(down));
        if let Some((column, row)) =
            place.filter(|&(column, row)| column < frame.width() && row < frame.height())
        {
            ring.push(frame.row(row)[column]);
        }
    }
    ring.sort_unstable();
    let Some(&median) = ring.get(ring.len() / 2) else { return false };
    let (height, ring) = (f64::from(value) - f64::from(median), f64::from(median));
    // the root of the light is its noise, however few electrons make a level
    height >= LEAST_DN && height * height >= 9.0 * ring
}
