//! What was there and what was reported -> which goes with which, frame by frame.

pub(crate) mod assignment;
pub(crate) mod leds;
pub(crate) mod neighbours;
