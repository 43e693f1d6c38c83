//! Tracks against truth: vehicles flown by [`simulator`], located by the real locator.

mod accuracy;
mod blinking;
mod clutter;
mod manoeuvres;
mod order;
mod parts;
mod rig;
pub(crate) mod simulator;
mod told;
