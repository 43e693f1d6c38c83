//! The experiments of the founding paper, run in simulation with the program's own code, each number beside the paper's.
//!
//! A scene (the outdoor flight of two UAVs) enters: its camera, lens, sensor, LEDs and airframe are those of every
//! experiment. [`Report`]s leave, one per figure: series to draw, and summary [`Row`]s. No files, no drawing, no printing, no threads.
//!
//! ```text
//! rig        the scene's parts, rearranged: one LED that recedes, an airframe at given poses
//! view       a frame -> what the paper's pipeline and Photinus' own see in it
//! then a module per figure, in the order of the paper:
//!            spectrum 4, layouts 7 and 8, spot_size 10 and 11, bearings 12, distances 13 and 14, flight 15 to 17,
//!            detection (the comparison of ranges), heading
//! row, panel what they return
//! ```
//!
//! "Paper" is V. Walter, M. Saska, A. Franchi, "Fast Mutual Relative Localization of UAVs using Ultraviolet LED Markers",
//! ICUAS 2018.

mod bearings;
mod detection;
mod distances;
mod experiment;
mod figure;
mod flight;
mod heading;
mod layouts;
mod panel;
mod poses;
mod rig;
mod row;
mod spectrum;
mod spot_size;
mod statistics;
mod view;

pub use experiment::{Effort, Experiment, ReproduceError};
pub use figure::Figure;
pub use panel::{Kind, Mark, Panel, Report, Role, Series};
pub use rig::Rig;
pub use row::{Row, Tolerance};
