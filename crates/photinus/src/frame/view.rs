//! A borrowed 8-bit grey frame.

use super::FrameError;

/// A view of 8-bit grey pixels, row by row; a row may be padded to `stride` bytes.
#[derive(Clone, Copy, Debug)]
pub struct FrameView<'a> {
    data: &'a [u8],
    width: usize,
    height: usize,
    stride: usize,
}

impl<'a> FrameView<'a> {
    /// Largest width or height: coordinates fit in 16 bits everywhere.
    pub const MAX_SIDE_PX: usize = 32_767;

    /// Views `data` as `height` rows of `width` pixels, each row starting `stride` bytes after the one before.
    ///
    /// # Errors
    /// [`FrameError`] when a side is zero or too long, the stride is shorter than a row, or the data ends early.
    pub fn new(data: &'a [u8], width: usize, height: usize, stride: usize) -> Result<Self, FrameError> {
        let side = 1..=Self::MAX_SIDE_PX;
        if !side.contains(&width) || !side.contains(&height) {
            return Err(FrameError::Size { width, height });
        }
        if stride < width {
            return Err(FrameError::Stride { stride, width });
        }
        let need =
            stride.checked_mul(height - 1).and_then(|bytes| bytes.checked_add(width)).unwrap_or(usize::MAX);
        if data.len() < need {
            return Err(FrameError::Short { have: data.len(), need });
        }
        Ok(Self { data, width, height, stride })
    }

    /// Views `data` as rows without padding.
    ///
    /// # Errors
    /// As [`FrameView::new`].
    pub fn packed(data: &'a [u8], width: usize, height: usize) -> Result<Self, FrameError> {
        Self::new(data, width, height, width)
    }

    /// Columns.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> usize {
        self.height
    }

    /// The pixels of row `v`, without padding.
    ///
    /// # Panics
    /// When `v` is not below the height.
    #[inline]
    pub fn row(&self, v: usize) -> &'a [u8] {
        assert!(v < self.height, "row {v} of a frame of {} rows", self.height);
        &self.data[v * self.stride..][..self.width]
    }

    /// The pixels from row `v` on, with the padding between rows, and how far rows start from each other.
    #[inline]
    pub(crate) fn rows_from(&self, v: usize) -> (&'a [u8], usize) {
        (&self.data[v * self.stride..], self.stride)
    }
}
