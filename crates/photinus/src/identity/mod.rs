//! Who blinks: code books, what tells their words apart, which books are best, and what a marker's light says of who it is.
//!
//! ```text
//! word        bits that an LED repeats, at unknown phase
//! book        words of one length: what a fleet blinks
//! properties  what a book truly has: distances at any shift, runs, duty, frames until a word is unique
//! design      requirements -> a book with as many words as can be found, and how many there can be at most
//! level       light of a marker, frame by frame -> what it shows when it shines all the time
//! evidence    light of a frame, or none -> how likely that is by the share of the exposure that the LED shone
//! decoder     evidence, frame by frame -> which word at which phase, or none that is known, with probability
//! ```
//!
//! A camera runs free against the clock of the LEDs and meets a word at any bit, so that every distance here is cyclic: the fewest
//! bits in which two words differ, however they are turned against each other.

mod book;
pub mod decoder;
pub mod design;
mod evidence;
mod level;
mod properties;
mod word;

pub use book::{BookError, CodeBook};
pub use evidence::Evidence;
pub(crate) use evidence::{SHARES, density_of_light, probability_of_absence};
pub use level::Level;
pub use properties::Properties;
pub use word::Word;
