//! A numpy array -> a frame that borrows its pixels, or the reason why it is none.
//!
//! Rows may be padded (a crop of a larger image is one); anything else that would need a copy is refused by name, so that
//! nobody pays for a copy that he does not know of.

use numpy::{PyArray2, PyArrayMethods, PyUntypedArray, PyUntypedArrayMethods, dtype};
use photinus::frame::FrameView;
use pyo3::prelude::*;

use crate::error::ImageError;

/// An array that is a frame. It is kept as long as this lives, and its users are told not to write to it meanwhile.
pub(crate) struct Image<'py> {
    array: Bound<'py, PyArray2<u8>>,
    height: usize,
    width: usize,
    stride: usize,
}

impl<'py> Image<'py> {
    /// Borrows an array.
    ///
    /// # Errors
    /// [`ImageError`] when it is no array, or its type, shape or strides are not those of a frame.
    pub(crate) fn borrow(object: &Bound<'py, PyAny>) -> PyResult<Self> {
        let array = object.cast::<PyArray2<u8>>().map_err(|_| what_it_is(object))?.clone();
        let [height, width] = [array.shape()[0], array.shape()[1]];
        let stride = if height * width == 0 { width } else { stride(array.shape(), array.strides())? };
        Ok(Self { array, height, width, stride })
    }

    /// The frame.
    ///
    /// # Errors
    /// [`ImageError`] when a side is zero or too long.
    pub(crate) fn view(&self) -> PyResult<FrameView<'_>> {
        let Self { height, width, stride, .. } = *self;
        let pixels = match height * width {
            0 => &[],
            // SAFETY: the array is kept by `self`; it is two-dimensional of u8, neither side is 0, and its rows begin `stride` bytes
            // after each other with pixels side by side, so that its last pixel is that many bytes after its first. NumPy cannot
            // keep another thread from writing to it: docstrings forbid that.
            #[allow(unsafe_code)]
            _ => unsafe { std::slice::from_raw_parts(self.array.data(), stride * (height - 1) + width) },
        };
        FrameView::new(pixels, width, height, stride).map_err(|error| ImageError::new_err(error.to_string()))
    }
}

/// How far rows start from each other, bytes.
fn stride(shape: &[usize], strides: &[isize]) -> PyResult<usize> {
    let refuse = |what: &str| {
        Err(ImageError::new_err(format!(
            "the image's strides are {strides:?} for the shape {shape:?}: {what}; give numpy.ascontiguousarray(image)"
        )))
    };
    let [height, width] = [shape[0], shape[1]];
    if strides.iter().any(|&stride| stride < 0) {
        return refuse("negative strides run backwards");
    }
    if width > 1 && height > 1 && strides[0] == 1 && strides[1] != 1 {
        return refuse("the array is in Fortran order");
    }
    if width > 1 && strides[1] != 1 {
        return refuse("the pixels of a row are not side by side");
    }
    match usize::try_from(strides[0]) {
        Ok(stride) if height > 1 && stride < width => refuse("rows overlap"),
        Ok(stride) if height > 1 => Ok(stride),
        // where there is one row, nothing starts after it
        _ => Ok(width),
    }
}

/// Why an object is no array of rows and columns of bytes.
fn what_it_is(object: &Bound<'_, PyAny>) -> PyErr {
    let Ok(array) = object.cast::<PyUntypedArray>() else {
        let name = object.get_type().name().map_or_else(|_| "that".to_owned(), |name| name.to_string());
        return ImageError::new_err(format!(
            "an image is a numpy array of uint8, rows by columns, not {name}"
        ));
    };
    ImageError::new_err(if array.ndim() == 2 {
        format!(
            "the image's pixels are {}: give {}, 0 to 255; samples of 16 bit are to be scaled, not cut",
            array.dtype(),
            dtype::<u8>(object.py())
        )
    } else {
        format!(
            "the image has the shape {:?}: give rows and columns of grey, such as numpy.ascontiguousarray(image[:, :, 0])",
            array.shape()
        )
    })
}
