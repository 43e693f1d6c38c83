//! Frames in; windows around spots that stand alone, patches without light, and some frames whole, out: a bounded number, whatever
//! the recording.

use photinus::camera::Camera;
use photinus::frame::{FrameView, Mask};
use rand_pcg::Pcg64;
use rand_pcg::rand_core::Rng;

use super::summits::{self, Summit};
use super::trail::Trails;
use super::window::{PATCH_SIDE, Patch, REACH, SIDE, Seen, Window};

/// Windows and patches kept; of more, each has the same chance.
const MOST_WINDOWS: usize = 12_000;
const MOST_PATCHES: usize = 3_000;
/// Frames kept whole: an odd number has a median.
const MOST_WHOLE: usize = 25;
const PATCHES_PER_FRAME: usize = 24;
/// Light of a spot ends for its neighbours so far away, px.
const SPOT_PX: f64 = 6.0;
/// A spot with another nearer than this is not used, px.
const ALONE_PX: f64 = 10.0;
/// A patch keeps so far from every spot, px.
const UNLIT_PX: f64 = 24.0;

/// What was collected of the frames of one camera.
#[derive(Clone, Debug)]
pub struct Collection {
    pub(super) size_px: Option<[usize; 2]>,
    pub(super) frames: u64,
    pub(super) windows: Reservoir<Window>,
    pub(super) patches: Reservoir<Patch>,
    pub(super) whole: Reservoir<Whole>,
    pub(super) mask: Option<Mask>,
    /// Its projection, where that is known.
    pub(super) camera: Option<Camera>,
    trails: Trails,
    random: Pcg64,
}

/// A frame as it is.
#[derive(Clone, Debug)]
pub(super) struct Whole {
    /// Row by row.
    pub(super) pixels: Box<[u8]>,
    pub(super) summits: Vec<Summit>,
}

/// A fair choice of a stream (algorithm R of J. Vitter, ACM TOMS 11, 1985).
#[derive(Clone, Debug)]
pub(super) struct Reservoir<T> {
    pub(super) kept: Vec<T>,
    seen: u64,
    most: usize,
    random: Pcg64,
}

impl<T> Reservoir<T> {
    fn new(most: usize) -> Self {
        Self { kept: Vec::new(), seen: 0, most, random: Pcg64::new(0, most as u128) }
    }

    /// Takes one of the stream, which is made only if it is kept.
    fn push(&mut self, one: impl FnOnce() -> T) {
        self.seen += 1;
        if self.kept.len() < self.most {
            self.kept.push(one());
        } else if let Some(place) = self.kept.get_mut((self.random.next_u64() % self.seen) as usize) {
            *place = one();
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
            whole: Reservoir::new(MOST_WHOLE),
            mask: None,
            camera: None,
            trails: Trails::default(),
            random: Pcg64::new(0, 0x0b71c5),
        }
    }
}

impl Collection {
    /// Nothing yet of a camera whose projection is known: only then vignetting can be told.
    pub fn of(camera: &Camera) -> Self {
        Self { camera: Some(camera.clone()), ..Self::default() }
    }

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
        let summits = summits::find(frame);
        let trails = self.trails.follow(&summits);
        for (index, (summit, trail)) in summits.iter().zip(trails).enumerate() {
            let others = summits.iter().enumerate().filter(|(other, _)| *other != index);
            let nearest_px = others
                .map(|(_, other)| other.distance_px(summit.column, summit.row))
                .fold(f64::INFINITY, f64::min);
            let is_seen = mask.is_none_or(|mask| !mask.ignores(summit.column, summit.row));
            if nearest_px >= ALONE_PX
                && is_seen
                && let Some(window) = window(frame, summit, nearest_px)
            {
                let seen = Seen { trail, frame: self.frames };
                self.windows.push(|| Window { seen, ..window });
            }
        }
        for _ in 0..PATCHES_PER_FRAME {
            if let Some(patch) = self.patch(frame, mask, &summits) {
                self.patches.push(|| patch);
            }
        }
        if self.mask.is_none() {
            self.mask = mask.cloned();
        }
        let rows = (0..frame.height()).flat_map(|row| frame.row(row).iter().copied());
        self.whole.push(|| Whole { pixels: rows.collect(), summits });
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

/// The window around a spot; `None` where it does not fit into the image.
fn window(frame: &FrameView<'_>, summit: &Summit, nearest_px: f64) -> Option<Window> {
    let (first, top) = (summit.column.checked_sub(REACH)?, summit.row.checked_sub(REACH)?);
    if first + SIDE > frame.width() || top + SIDE > frame.height() {
        return None;
    }
    let pixels = (top..top + SIDE).flat_map(|row| frame.row(row)[first..first + SIDE].iter().copied());
    let reach = (nearest_px.min(99.0) - SPOT_PX).floor() as usize;
    let (column, row) = (summit.column, summit.row);
    Some(Window { column, row, reach: reach.min(REACH), seen: Seen::default(), pixels: pixels.collect() })
}
