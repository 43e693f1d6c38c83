//! Tracks against truth: vehicles flown by [`simulator`], located by the real locator.

mod accuracy;
mod blinking;
mod manoeuvres;
mod order;
mod parts;
mod rig;
pub(crate) mod simulator;
mod strangers;
mod told;
