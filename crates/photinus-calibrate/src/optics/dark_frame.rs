//! Frames as they are in; what pixels read without light out: the median of each, whatever passed over it.

use super::collect::{Collection, Whole};

/// Fewer frames have no median that a light which passes does not touch.
const FEWEST: usize = 9;

/// What each pixel reads without light, and the frames that told it.
pub(super) struct DarkFrame<'a> {
    pub(super) width: usize,
    pub(super) height: usize,
    /// Row by row, grey levels.
    pub(super) levels: Vec<u8>,
    pub(super) frames: &'a [Whole],
}

impl<'a> DarkFrame<'a> {
    /// `None` of too few frames.
    pub(super) fn of(collection: &'a Collection) -> Option<Self> {
        let [width, height] = collection.size_px?;
        let frames = collection.whole.kept.as_slice();
        let mut values = vec![0; frames.len()];
        let mut median = |index: usize| {
            values.iter_mut().zip(frames).for_each(|(value, frame)| *value = frame.pixels[index]);
            let middle = values.len() / 2;
            *values.select_nth_unstable(middle).1
        };
        (frames.len() >= FEWEST).then(|| Self {
            width,
            height,
            levels: (0..width * height).map(&mut median).collect(),
            frames,
        })
    }

    /// How far a pixel of a frame is above its darkness, grey levels.
    pub(super) fn excess(&self, frame: &Whole, column: usize, row: usize) -> f64 {
        let index = row * self.width + column;
        f64::from(frame.pixels[index]) - f64::from(self.levels[index])
    }
}
