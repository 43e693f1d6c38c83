//! Tracks against truth: vehicles flown by [`simulator`], located by the real locator.

mod accuracy;
mod simulator;
mod told;
