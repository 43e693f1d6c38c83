//! A set-up of LEDs, lens, sensor and airframe -> how far and how exactly it sees, before anybody builds it.
//!
//! ```text
//! setup    a file and parts of data sheets -> the simulator's LED, lens and sensor, the core's camera and airframe
//! spot     so much light in one place      -> how likely it is found, how exactly its centre and light are known
//! view     a neighbour somewhere           -> its markers' light, which of them make spots
//! bound    those spots                     -> the least error of distance, bearing and yaw: Fisher's information
//! range    all of it over distance         -> how far; error over distance and aspect
//! layouts  so many LEDs                    -> which way to spread them
//! battery, eyes                            -> what the light costs, and from where on it harms nobody
//! ```
//!
//! Nothing is modelled twice: light, lens and sensor are those of `photinus-sim`, geometry, priors and the information about a pose those
//! of `photinus`. Whether plans hold is tried on rendered and located frames: `examples/against_simulation`.

mod battery;
mod bound;
mod eyes;
mod layouts;
mod plan;
mod range;
mod setup;
mod spot;
mod view;

pub use battery::Battery;
pub use bound::{Bound, Errors};
pub use eyes::Eyes;
pub use layouts::Layout;
pub use plan::Plan;
pub use range::{AtAspect, AtRange, Range, Reach};
pub use setup::{EXAMPLE, Light, PARTS, Setup, Watch};
pub use spot::{Spot, SpotTable};
pub use view::{Draws, View};
