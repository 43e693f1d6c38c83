//! Files against the documentation, damage, and real recordings.

mod calibrations;
mod documented_examples;
mod locate_photos;
mod natural_photos;
mod parsers_never_panic;
mod photos;
