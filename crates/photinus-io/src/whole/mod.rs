//! Files as a whole: all of a file is read or none of it, all of it is written or none.
//!
//! Everything but streams (video, JSON lines) goes this way. A parser sees a whole file; somebody who looks for a result, or
//! whose disk is full, never finds half of one in its place.

mod read;
mod write;

pub use read::open_regular;
pub(crate) use read::read_bytes;
pub use read::read_text;
pub use write::{Existing, WholeFile, WholeFolder, write_whole};
