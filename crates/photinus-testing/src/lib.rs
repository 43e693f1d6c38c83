//! What a test needs and a machine may lack: enters the name of it, leaves where it is, or a line in the list of what was
//! skipped and why.
//!
//! The harness hides what a passing test prints, so a test that skips would pass for one that ran. Every test that skips
//! does it through [`Skipped`]; the last target of a run, `tests/what_was_skipped.rs`, shows the list. Beside it, how files get damaged, and files of formats that only others write.

mod bag;
mod damage;
mod data;
mod photos;
mod python;
mod skipped;

pub use bag::{BagMessage, bag};
pub use damage::damage;
pub use data::real_data;
pub use photos::natural_photos;
pub use python::python_with;
pub use skipped::Skipped;
