//! Where not to look: the observer's own airframe, mostly.

use alloc::vec::Vec;

use super::{FrameError, FrameView};

/// Pixels to ignore, in the size of the camera.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mask {
    ignored: Vec<bool>,
    width: usize,
    height: usize,
}

impl Mask {
    /// A mask from a grey image of the camera's size: 0 means ignore, anything else means look.
    pub fn from_frame(frame: &FrameView<'_>) -> Self {
        let ignored = (0..frame.height()).flat_map(|v| frame.row(v).iter().map(|&p| p == 0)).collect();
        Self { ignored, width: frame.width(), height: frame.height() }
    }

    /// Columns.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> usize {
        self.height
    }

    /// How many pixels are ignored.
    pub fn ignored_px(&self) -> usize {
        self.ignored.iter().filter(|&&ignored| ignored).count()
    }

    /// Whether the pixel in column `u` and row `v` is to be ignored; `false` outside the mask.
    pub fn ignores(&self, u: usize, v: usize) -> bool {
        u < self.width && v < self.height && self.ignored[v * self.width + u]
    }

    /// Checks that the mask belongs to a frame of this size.
    ///
    /// # Errors
    /// [`FrameError::MaskSize`] when it does not.
    pub fn check_size(&self, width: usize, height: usize) -> Result<(), FrameError> {
        if (self.width, self.height) == (width, height) {
            return Ok(());
        }
        Err(FrameError::MaskSize { mask_width: self.width, mask_height: self.height, width, height })
    }
}
