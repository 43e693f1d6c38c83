//! Frames in; windows around spots that stand alone, and patches without light, out: a bounded number, whatever the recording.
//!
//! A spot is a brightest pixel that stands out of a ring around it. Nothing is asked of its shape: that is to be learned.

use photinus::frame::{FrameView, Mask};
use rand_pcg::Pcg64;
use rand_pcg::rand_core::Rng;

use super::window::{PATCH_SIDE, Patch, REACH, SIDE, Window};

/// Windows and patches kept; of more, each has the same chance.
const MOST_WINDOWS: usize = 12_000;
const MOST_PATCHES: usize = 3_000;
const PATCHES_PER_FRAME: usize = 24;
/// Light of a spot ends for its neighbours so far away, px.
const SPOT_PX: f64 = 6.0;
/// A spot with another nearer than this is not used, px.
const ALONE_PX: f64 = 10.0;
/// Brightest pixels nearer to each other than this are one spot, px.
const SAME_PX: f64 = 3.0;
/// A patch keeps so far from every spot, px.
const UNLIT_PX: f64 = 24.0;
/// Least height of a spot above the ring around it, grey levels.
const LEAST_DN: f64 = 10.0;

/// What was collected of the frames of one camera.
#[derive(Clone, Debug)]
pub struct Collection {
    pub(super) size_px: Option<[usize; 2]>,
    pub(super) frames: u64,
    pub(super) windows: Reservoir<Window>,
    pub(super) patches: Reservoir<Patch>,
    random: Pcg64,
}

/// A fair choice of a stream (algorithm R of J. Vitter, ACM TOMS 11, 1985).
#[derive(Clone, Debug)]
pub(super) struct Reservoir<T> {
    pub(super) kept: Vec<T>,
    seen: u64,
    most: usize,
}

impl<T> Reservoir<T> {
    fn new(most: usize) -> Self {
        Self { kept: Vec::new(), seen: 0, most }
    }

    fn push(&mut self, one: T, random: &mut Pcg64) {
        self.seen += 1;
        if self.kept.len() < self.most {
            self.kept.push(one);
        } else if let Some(place) = self.kept.get_mut((random.next_u64() % self.seen) as usize) {
            *place = one;
        }
    }
}

impl Default for Collection {
    fn default() -> Self {
        Self {
            size_px: None,
            frames: 0,
            windows: Reservoir::new(MOST_WINDOWS),
            patches: Reservoir::new(MOST_PATCHES),
            random: Pcg64::new(0, 0x0b71c5),
        }
    }
}

/// A brightest pixel.
#[derive(Clone, Copy, Debug)]
struct Summit {
    column: usize,
    row: usize,
    value: u8,
}

impl Summit {
    fn distance_px(&self, column: usize, row: usize) -> f64 {
        libm::hypot(self.column as f64 - column as f64, self.row as f64 - row as f64)
    }
}

impl Collection {
    /// Frames that were added.
    pub fn frames(&self) -> u64 {
        self.frames
    }

    /// Spots that stood alone in them.
    pub fn spots(&self) -> u64 {
        self.windows.seen
    }

    /// Width and height of the frames, px.
    pub fn size_px(&self) -> Option<[usize; 2]> {
        self.size_px
    }

    /// Takes what is useful from a frame; nothing where the mask is 0. Returns false when its size is not that of the frames before.
    pub fn add(&mut self, frame: &FrameView<'_>, mask: Option<&Mask>) -> bool {
        let size = [frame.width(), frame.height()];
        if *self.size_px.get_or_insert(size) != size {
            return false;
        }
        self.frames += 1;
        let summits = summits(frame);
        for (index, summit) in summits.iter().enumerate() {
            let others = summits.iter().enumerate().filter(|(other, _)| *other != index);
            let nearest_px = others
                .map(|(_, other)| other.distance_px(summit.column, summit.row))
                .fold(f64::INFINITY, f64::min);
            let is_seen = mask.is_none_or(|mask| !mask.ignores(summit.column, summit.row));
            if nearest_px >= ALONE_PX
                && is_seen
                && let Some(window) = window(frame, summit, nearest_px)
            {
                self.windows.push(window, &mut self.random);
            }
        }
        for _ in 0..PATCHES_PER_FRAME {
            if let Some(patch) = self.patch(frame, mask, &summits) {
                self.patches.push(patch, &mut self.random);
            }
        }
        true
    }

    /// A patch at a place drawn by chance, unless a spot is near.
    fn patch(&mut self, frame: &FrameView<'_>, mask: Option<&Mask>, summits: &[Summit]) -> Option<Patch> {
        let mut place = |length: usize| {
            let room = length.checked_sub(PATCH_SIDE)?;
            Some((self.random.next_u64() % (room as u64 + 1)) as usize)
        };
        let (column, row) = (place(frame.width())?, place(frame.height())?);
        let middle = (column + PATCH_SIDE / 2, row + PATCH_SIDE / 2);
        let is_unlit = summits.iter().all(|summit| summit.distance_px(middle.0, middle.1) > UNLIT_PX);
        let is_seen = mask.is_none_or(|mask| !mask.ignores(middle.0, middle.1));
        (is_unlit && is_seen).then(|| {
            let pixel = |index: usize| frame.row(row + index / PATCH_SIDE)[column + index % PATCH_SIDE];
            Patch { pixels: std::array::from_fn(pixel) }
        })
    }
}

/// The brightest pixels that stand out, of those near each other only the brightest.
fn summits(frame: &FrameView<'_>) -> Vec<Summit> {
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

/// The window around a spot; `None` where it does not fit into the image.
fn window(frame: &FrameView<'_>, summit: &Summit, nearest_px: f64) -> Option<Window> {
    let (first, top) = (summit.column.checked_sub(REACH)?, summit.row.checked_sub(REACH)?);
    if first + SIDE > frame.width() || top + SIDE > frame.height() {
        return None;
    }
    let pixels = (top..top + SIDE).flat_map(|row| frame.row(row)[first..first + SIDE].iter().copied());
    let reach = (nearest_px.min(99.0) - SPOT_PX).floor() as usize;
    Some(Window { column: summit.column, row: summit.row, reach: reach.min(REACH), pixels: pixels.collect() })
}
