//! A set-point that a controller wants -> one that leads into no collision.
//!
//! Each vehicle is always *committed*: to what it was last told to do for one more period, and to braking until it stands after that
//! (`commitment.rs`). It may renew its commitment where the new one keeps clear of every place that a neighbour can be in or
//! brake into: those seen by their strict bounds ([`Sector`]), those not seen by where absence is not known ([`Watch`]), and of what
//! a map shows ([`Obstacle`]). Where it may not, it brakes: the old commitment was clear, and stays so. Nothing needs to be said
//! between vehicles, no clock to agree, nobody to be known. The proof and what it rests upon: `docs/safety.md`.

mod alternatives;
mod angle;
mod commitment;
mod layer;
mod limits;
mod lost;
mod obstacle;
mod places;
mod sector;
mod shadow;
mod told;
mod watch;

pub use layer::{Basis, Guarded, Safety};
pub use limits::{Limits, LimitsError};
pub use obstacle::Obstacle;
pub use sector::Sector;
pub use shadow::Shadow;
pub use watch::{Cone, Detection, Watch};
