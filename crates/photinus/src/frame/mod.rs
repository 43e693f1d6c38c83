//! What the camera gave: a borrowed view of grey pixels, and the mask that says where not to look.

mod mask;
mod view;

pub use mask::Mask;
pub use view::FrameView;

/// Why a buffer is not a frame or a mask.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum FrameError {
    /// A width or height of zero, or one past what a frame may have.
    #[error("a frame of {width}x{height} pixels: each side must be 1 to {max}", max = FrameView::MAX_SIDE_PX)]
    Size {
        /// Columns given.
        width: usize,
        /// Rows given.
        height: usize,
    },
    /// A stride shorter than a row.
    #[error("a stride of {stride} bytes is shorter than a row of {width} pixels")]
    Stride {
        /// Bytes from one row to the next.
        stride: usize,
        /// Columns given.
        width: usize,
    },
    /// A buffer that ends before its last row.
    #[error("the buffer holds {have} bytes, the frame needs {need}")]
    Short {
        /// Bytes given.
        have: usize,
        /// Bytes needed.
        need: usize,
    },
    /// A mask of another size than the frame.
    #[error("the mask is {mask_width}x{mask_height}, the frame {width}x{height}")]
    MaskSize {
        /// Columns of the mask.
        mask_width: usize,
        /// Rows of the mask.
        mask_height: usize,
        /// Columns of the frame.
        width: usize,
        /// Rows of the frame.
        height: usize,
    },
}
