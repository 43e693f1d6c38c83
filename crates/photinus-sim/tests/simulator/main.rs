//! The simulator as others use it.

mod datasets;
mod independence;
mod parsers_never_panic;
mod stepping;
