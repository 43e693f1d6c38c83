//! Pointers of C -> values of Rust, and back: the one place that follows them. What can be checked is: null, alignment, sizes and strides.
//!
//! Results are written through raw pointers, never through references, so that arrays of C may overlap or be uninitialised.

use std::ffi::{CStr, c_char};

use photinus::frame::FrameView;

use crate::border::{Refusal, Result, Status};

/// No row is longer, bytes: 32 for each pixel of the widest frame. More is a number that was negative once.
const LONGEST_STRIDE: isize = 1 << 20;

/// Grey pixels of a byte each, borrowed for the time of a call. Nobody may write to them meanwhile.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Image {
    /// The first pixel of the first row; the last row ends `stride * (height - 1) + width` bytes after it.
    pub pixels: *const u8,
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// From the start of a row to that of the next, bytes: `width` where rows are not padded.
    pub stride: isize,
}

impl Image {
    /// The frame, if it is of this size.
    ///
    /// # Safety
    /// The pixels are there, and nobody writes to them, as long as the view lives.
    pub(crate) unsafe fn view<'a>(self, size: [usize; 2]) -> Result<FrameView<'a>> {
        let refuse = |message: String| Err(Refusal::new(Status::Image, message));
        let Self { pixels, width, height, stride } = self;
        if [width, height] != size {
            let [columns, rows] = size;
            return refuse(format!(
                "the image is {width}x{height}, the camera {columns}x{rows}; give the calibration of this camera at this resolution"
            ));
        }
        if stride < 0 {
            return refuse(format!(
                "a stride of {stride} bytes runs backwards; copy the image so that its first row comes first"
            ));
        }
        if stride > LONGEST_STRIDE {
            return refuse(format!(
                "a stride of {stride} bytes is longer than any row; give the bytes from the start of a row to that of the next"
            ));
        }
        if pixels.is_null() {
            return Err(null("the pixels of the image"));
        }
        let stride = stride.unsigned_abs();
        // Sides of a camera's image are at least 1 and at most 32767, so this is far below isize::MAX.
        let length = stride * (height - 1) + width;
        // SAFETY: not null; the caller promises that so many bytes are there, and constant.
        let bytes = unsafe { std::slice::from_raw_parts(pixels, length) };
        FrameView::new(bytes, width, height, stride).map_err(|error| Refusal::new(Status::Image, error))
    }
}

fn null(what: &str) -> Refusal {
    Refusal::new(Status::Pointer, format!("the pointer to {what} is null"))
}

fn check<T>(pointer: *const T, what: &str) -> Result<()> {
    if pointer.is_null() {
        return Err(null(what));
    }
    if !pointer.is_aligned() {
        let bytes = align_of::<T>();
        let message = format!("the pointer to {what} is not aligned to {bytes} bytes, as its type needs");
        return Err(Refusal::new(Status::Pointer, message));
    }
    Ok(())
}

/// The value behind a pointer.
///
/// # Safety
/// Where it is not null, an initialised `T` is there.
pub(crate) unsafe fn read<T: Copy>(pointer: *const T, what: &str) -> Result<T> {
    check(pointer, what)?;
    // SAFETY: not null and aligned; the caller promises the rest.
    Ok(unsafe { pointer.read() })
}

/// The value behind a pointer that may be null.
///
/// # Safety
/// As [`read`].
pub(crate) unsafe fn read_if_any<T: Copy>(pointer: *const T, what: &str) -> Result<Option<T>> {
    if pointer.is_null() {
        return Ok(None);
    }
    // SAFETY: the caller promises what `read` needs.
    unsafe { read(pointer, what) }.map(Some)
}

/// A text that ends with a zero.
///
/// # Safety
/// Where it is not null, such a text is there as long as it is used.
pub(crate) unsafe fn text<'a>(pointer: *const c_char, what: &str) -> Result<&'a str> {
    check(pointer, what)?;
    // SAFETY: not null; the caller promises the rest.
    utf8(unsafe { CStr::from_ptr(pointer) }.to_bytes(), what)
}

/// A text without a zero, as its bytes.
pub(crate) fn utf8<'a>(bytes: &'a [u8], what: &str) -> Result<&'a str> {
    std::str::from_utf8(bytes)
        .map_err(|error| Refusal::new(Status::Text, format!("{what} is no UTF-8: {error}")))
}

/// So many bytes.
///
/// # Safety
/// Where it is not null, they are there and nobody writes to them as long as they are used.
pub(crate) unsafe fn bytes<'a>(pointer: *const u8, length: usize, what: &str) -> Result<&'a [u8]> {
    check(pointer, what)?;
    if isize::try_from(length).is_err() {
        let message =
            format!("{what} of {length} bytes is longer than memory: a length that was negative once");
        return Err(Refusal::new(Status::Setting, message));
    }
    // SAFETY: not null, and no longer than a slice may be; the caller promises the rest.
    Ok(unsafe { std::slice::from_raw_parts(pointer, length) })
}

/// Where one result goes.
#[derive(Clone, Copy)]
pub(crate) struct Place<T>(*mut T);

impl<T> Place<T> {
    /// A place.
    ///
    /// # Safety
    /// Where it is not null, there is room for a `T` as long as it is used.
    pub(crate) unsafe fn new(pointer: *mut T, what: &str) -> Result<Self> {
        check(pointer, what).map(|()| Self(pointer))
    }

    pub(crate) fn put(self, value: T) {
        // SAFETY: not null and aligned; whoever made the place promised the room.
        unsafe { self.0.write(value) }
    }
}

/// Where a list of results goes, and their number.
pub(crate) struct Places<T> {
    first: *mut T,
    capacity: usize,
    count: Place<usize>,
}

impl<T> Places<T> {
    /// Places; the list may be null where none of it is wanted.
    ///
    /// # Safety
    /// Where they are not null, there is room for `capacity` of `T`, and for the count, as long as they are used.
    pub(crate) unsafe fn new(first: *mut T, capacity: usize, count: *mut usize, what: &str) -> Result<Self> {
        if capacity > 0 {
            check(first, what)?;
        }
        // SAFETY: the caller promises the room.
        let count = unsafe { Place::new(count, "the count") }?;
        Ok(Self { first, capacity, count })
    }

    /// Puts as many as there is room for, and the number of all.
    pub(crate) fn fill(self, values: impl ExactSizeIterator<Item = T>) {
        self.count.put(values.len());
        for (index, value) in values.take(self.capacity).enumerate() {
            // SAFETY: below the capacity, for which whoever made the places promised room.
            unsafe { self.first.add(index).write(value) }
        }
    }
}

impl Places<c_char> {
    /// Puts as much of a text as fits with its closing zero, and the length of all of it without.
    pub(crate) fn fill_text(self, text: &str) {
        self.count.put(text.len());
        let Some(room) = self.capacity.checked_sub(1) else { return };
        let cut = text.floor_char_boundary(room);
        for (index, byte) in text.bytes().take(cut).chain([0]).enumerate() {
            // SAFETY: at most the last of `capacity` places, for which whoever made them promised room.
            unsafe { self.first.add(index).write(byte as c_char) }
        }
    }
}
