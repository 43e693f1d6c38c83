//! Robots that fly by what they see, in a world that steps.
//!
//! ```text
//! scenario (TOML) -> world -> frames of every camera -> perception -> mind -> autopilot -> motion -> world
//!                      \-> metrics, records
//! ```
//!
//! A robot decides by its own frames and its own instruments alone; how it sees is one of four grades ([`perception`]). A run depends on the scenario, its
//! seed and the grade, and on nothing else: not on the number of threads.

pub mod chance;
pub mod metrics;
pub mod mind;
pub mod perception;
pub mod record;
pub mod run;
pub mod scenario;
pub mod vehicle;
pub mod world;

pub use metrics::Metrics;
pub use perception::Grade;
pub use run::{Progress, Run};
pub use scenario::Scenario;
pub use world::World;
