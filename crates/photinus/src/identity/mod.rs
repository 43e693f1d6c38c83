//! Who blinks: code books, what tells their words apart, and which books are best.
//!
//! ```text
//! word        bits that an LED repeats, at unknown phase
//! book        words of one length: what a fleet blinks
//! properties  what a book truly has: distances at any shift, runs, duty, frames until a word is unique
//! design      requirements -> a book with as many words as can be found, and how many there can be at most
//! ```
//!
//! A camera runs free against the clock of the LEDs and meets a word at any bit, so that every distance here is cyclic: the fewest
//! bits in which two words differ, however they are turned against each other.

mod book;
pub mod design;
mod properties;
mod word;

pub use book::{BookError, CodeBook};
pub use properties::Properties;
pub use word::Word;
