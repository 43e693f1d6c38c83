//! An owned 8-bit grey frame.

use photinus::frame::{FrameError, FrameView};

/// An owned 8-bit grey frame, rows without padding.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct GreyImage {
    pixels: Vec<u8>,
    width: usize,
    height: usize,
}

impl GreyImage {
    /// `height` rows of `width` pixels; bytes past the last row are dropped.
    ///
    /// # Errors
    /// [`FrameError`] when a side is zero or too long, or there are too few pixels.
    pub fn new(mut pixels: Vec<u8>, width: usize, height: usize) -> Result<Self, FrameError> {
        FrameView::packed(&pixels, width, height)?;
        pixels.truncate(width * height);
        Ok(Self { pixels, width, height })
    }

    /// A copy of a view.
    pub fn from_view(frame: &FrameView<'_>) -> Self {
        let pixels = (0..frame.height()).flat_map(|v| frame.row(v)).copied().collect();
        Self { pixels, width: frame.width(), height: frame.height() }
    }

    /// The frame as the method takes it.
    pub fn view(&self) -> FrameView<'_> {
        FrameView::packed(&self.pixels, self.width, self.height).expect("checked when it was made")
    }

    /// Columns.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> usize {
        self.height
    }

    /// The pixels, row by row.
    pub fn pixels(&self) -> &[u8] {
        &self.pixels
    }

    /// The pixels, row by row, for others to keep.
    pub fn into_pixels(self) -> Vec<u8> {
        self.pixels
    }
}
