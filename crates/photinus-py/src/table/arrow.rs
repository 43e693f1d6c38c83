//! The Arrow C data and stream interfaces: columns -> structures that any consumer reads in place.
//!
//! The three structures are those of <https://arrow.apache.org/docs/format/CDataInterface.html>, field by field. What they point to is
//! owned by a box behind `private_data`, which `release` drops; buffers belong to the columns, which every array keeps alive.
#![allow(unsafe_code)] // a C interface

use std::ffi::{CString, c_char, c_int, c_void};
use std::ptr;
use std::sync::Arc;

use photinus_io::results::{Cells, Column};

const NULLABLE: i64 = 2;

/// `struct ArrowSchema`.
#[repr(C)]
pub(super) struct Schema {
    format: *const c_char,
    name: *const c_char,
    metadata: *const c_char,
    flags: i64,
    n_children: i64,
    children: *mut *mut Schema,
    dictionary: *mut Schema,
    release: Option<unsafe extern "C" fn(*mut Schema)>,
    private_data: *mut c_void,
}

/// `struct ArrowArray`.
#[repr(C)]
struct Array {
    length: i64,
    null_count: i64,
    offset: i64,
    n_buffers: i64,
    n_children: i64,
    buffers: *mut *const c_void,
    children: *mut *mut Array,
    dictionary: *mut Array,
    release: Option<unsafe extern "C" fn(*mut Array)>,
    private_data: *mut c_void,
}

/// `struct ArrowArrayStream`.
#[repr(C)]
pub(super) struct Stream {
    get_schema: Option<unsafe extern "C" fn(*mut Stream, *mut Schema) -> c_int>,
    get_next: Option<unsafe extern "C" fn(*mut Stream, *mut Array) -> c_int>,
    get_last_error: Option<unsafe extern "C" fn(*mut Stream) -> *const c_char>,
    release: Option<unsafe extern "C" fn(*mut Stream)>,
    private_data: *mut c_void,
}

// SAFETY: what they point to is owned by them alone, or shared and immutable; nothing of it belongs to a thread.
unsafe impl Send for Schema {}
// SAFETY: as above.
unsafe impl Send for Stream {}

/// What a schema points to.
struct SchemaParts {
    name: CString,
    children: Vec<*mut Schema>,
}

impl Schema {
    /// A struct of these columns.
    pub(super) fn of(columns: &[Column]) -> Self {
        let children =
            columns.iter().map(|column| Box::into_raw(Box::new(Self::of_column(column)))).collect();
        Self::new(c"+s", "", 0, children)
    }

    fn of_column(column: &Column) -> Self {
        let format = match column.cells() {
            Cells::Number(_) => c"g",
            Cells::Count(_) => c"L",
            Cells::Text { .. } => c"u",
        };
        Self::new(format, column.name(), NULLABLE, Vec::new())
    }

    fn new(format: &'static std::ffi::CStr, name: &str, flags: i64, children: Vec<*mut Self>) -> Self {
        // Names of columns are ours and hold no zero byte.
        let mut parts = Box::new(SchemaParts { name: CString::new(name).unwrap_or_default(), children });
        Self {
            format: format.as_ptr(),
            name: parts.name.as_ptr(),
            metadata: ptr::null(),
            flags,
            n_children: parts.children.len() as i64,
            children: parts.children.as_mut_ptr(),
            dictionary: ptr::null_mut(),
            release: Some(release_schema),
            private_data: Box::into_raw(parts).cast(),
        }
    }
}

/// What an array points to.
struct ArrayParts {
    columns: Arc<[Column]>,
    buffers: Vec<*const c_void>,
    children: Vec<*mut Array>,
}

impl Array {
    /// A struct of these columns, none of its rows null.
    fn of(columns: &Arc<[Column]>, rows: usize) -> Self {
        let child = |column: &Column| Box::into_raw(Box::new(Self::of_column(columns, column)));
        let children = columns.iter().map(child).collect();
        Self::new(rows, 0, columns, vec![ptr::null()], children)
    }

    fn of_column(columns: &Arc<[Column]>, column: &Column) -> Self {
        let known = column.known().as_ptr().cast();
        let buffers = match column.cells() {
            Cells::Number(values) => vec![known, values.as_ptr().cast()],
            Cells::Count(values) => vec![known, values.as_ptr().cast()],
            Cells::Text { offsets, bytes } => vec![known, offsets.as_ptr().cast(), bytes.as_ptr().cast()],
        };
        Self::new(column.len(), column.nulls(), columns, buffers, Vec::new())
    }

    fn new(
        length: usize,
        nulls: usize,
        columns: &Arc<[Column]>,
        buffers: Vec<*const c_void>,
        children: Vec<*mut Self>,
    ) -> Self {
        let mut parts = Box::new(ArrayParts { columns: columns.clone(), buffers, children });
        Self {
            length: length as i64,
            null_count: nulls as i64,
            offset: 0,
            n_buffers: parts.buffers.len() as i64,
            n_children: parts.children.len() as i64,
            buffers: parts.buffers.as_mut_ptr(),
            children: parts.children.as_mut_ptr(),
            dictionary: ptr::null_mut(),
            release: Some(release_array),
            private_data: Box::into_raw(parts).cast(),
        }
    }

    /// What stands at the end of a stream.
    fn end() -> Self {
        Self {
            length: 0,
            null_count: 0,
            offset: 0,
            n_buffers: 0,
            n_children: 0,
            buffers: ptr::null_mut(),
            children: ptr::null_mut(),
            dictionary: ptr::null_mut(),
            release: None,
            private_data: ptr::null_mut(),
        }
    }
}

/// What a stream points to.
struct StreamParts {
    columns: Arc<[Column]>,
    rows: usize,
    is_done: bool,
}

impl Stream {
    /// A stream of one batch with all rows of these columns.
    pub(super) fn of(columns: Arc<[Column]>, rows: usize) -> Self {
        let parts = Box::new(StreamParts { columns, rows, is_done: false });
        Self {
            get_schema: Some(get_schema),
            get_next: Some(get_next),
            get_last_error: Some(get_last_error),
            release: Some(release_stream),
            private_data: Box::into_raw(parts).cast(),
        }
    }
}

impl Drop for Schema {
    /// What a consumer has moved out or released has no `release` any more.
    fn drop(&mut self) {
        if let Some(release) = self.release {
            // SAFETY: it was made by `new` and not released.
            unsafe { release(self) }
        }
    }
}

impl Drop for Array {
    fn drop(&mut self) {
        if let Some(release) = self.release {
            // SAFETY: as for a schema.
            unsafe { release(self) }
        }
    }
}

impl Drop for Stream {
    fn drop(&mut self) {
        if let Some(release) = self.release {
            // SAFETY: as for a schema.
            unsafe { release(self) }
        }
    }
}

/// Drops what a schema points to, its children too.
unsafe extern "C" fn release_schema(schema: *mut Schema) {
    // SAFETY: the caller hands over a schema that `Schema::new` made and nobody released: `private_data` is its box, the children
    // are boxes of their own, whose `Drop` leaves alone what a consumer moved out of them.
    unsafe {
        (*schema).release = None;
        let parts = Box::from_raw((*schema).private_data.cast::<SchemaParts>());
        parts.children.iter().for_each(|child| drop(Box::from_raw(*child)));
    }
}

/// Drops what an array points to, its children too.
unsafe extern "C" fn release_array(array: *mut Array) {
    // SAFETY: as in `release_schema`.
    unsafe {
        (*array).release = None;
        let parts = Box::from_raw((*array).private_data.cast::<ArrayParts>());
        parts.children.iter().for_each(|child| drop(Box::from_raw(*child)));
        drop(parts.columns);
    }
}

unsafe extern "C" fn get_schema(stream: *mut Stream, out: *mut Schema) -> c_int {
    // SAFETY: the caller hands over a stream that was not released, and room for a schema, of which nothing is read.
    unsafe {
        let parts = &*(*stream).private_data.cast::<StreamParts>();
        ptr::write(out, Schema::of(&parts.columns));
    }
    0
}

unsafe extern "C" fn get_next(stream: *mut Stream, out: *mut Array) -> c_int {
    // SAFETY: as in `get_schema`; a stream is used by one thread at a time.
    unsafe {
        let parts = &mut *(*stream).private_data.cast::<StreamParts>();
        let is_done = std::mem::replace(&mut parts.is_done, true);
        ptr::write(out, if is_done { Array::end() } else { Array::of(&parts.columns, parts.rows) });
    }
    0
}

/// Nothing of it can fail.
unsafe extern "C" fn get_last_error(_stream: *mut Stream) -> *const c_char {
    ptr::null()
}

unsafe extern "C" fn release_stream(stream: *mut Stream) {
    // SAFETY: the caller hands over a stream that was not released: `private_data` is its box.
    unsafe {
        (*stream).release = None;
        drop(Box::from_raw((*stream).private_data.cast::<StreamParts>()));
    }
}
