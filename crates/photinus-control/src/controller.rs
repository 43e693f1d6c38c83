//! What every controller is.

use crate::{OwnState, Seen, Setpoint};

/// Neighbours in, a set-point out. A controller may remember; it knows nothing of the world but what it is handed.
pub trait Controller {
    /// How to fly for the next `dt_s` seconds, given what the vehicle knows of itself and whom it sees. Those who are seen may come
    /// in any order, and any number of them may be missing.
    fn command(&mut self, own: &OwnState, seen: &[Seen], dt_s: f64) -> Setpoint;
}
