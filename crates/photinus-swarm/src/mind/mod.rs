//! How a vehicle decides: controllers that see, and scripts that the scenario writes.
//!
//! A *controller* is handed what its vehicle measures of itself and whom it sees, and nothing else: those of `photinus-control`, with or without the
//! safety layer in front. A *script* is no part of the swarm: it flies a leader along its course, or hunts, and knows the truth.

pub(crate) mod guard;
mod script;
pub(crate) mod table;

use photinus_control::Controller;

pub(crate) use guard::OnMap;
pub use guard::{Guard, SafetyPlan, Unseen};
pub(crate) use script::setpoint as script_setpoint;
pub use script::{Script, Truth};
pub use table::{Needs, Plan};

/// What decides for a vehicle.
pub enum Mind {
    /// One that sees.
    Seeing(Box<dyn Controller + Send>),
    /// One that knows.
    Scripted(Script),
}

impl core::fmt::Debug for Mind {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Seeing(_) => f.write_str("Seeing"),
            Self::Scripted(script) => script.fmt(f),
        }
    }
}

/// Gain of the velocity that a set-point asks for, 1/s: what flight controllers use.
pub const VELOCITY_GAIN_1_S: f64 = 2.0;
