//! LED boards: enters a code book and what a vehicle is to blink, leaves bytes on a serial line.
//!
//! ```text
//! command   what a board can be told                                  <-> payload
//! frame     a payload                                                 <-> bytes on the line
//! dialogue  commands, and what came back -> what to send now, or how long to wait; it reads no clock
//! port      the dialogue held on a serial line
//! ```
//! The protocol is the one that boards of UVDAR speak (the serial protocol of `mrs_serial`, commands 0x90 to 0x99 and 0xF0). These boards answer
//! nothing: whether LEDs truly blink what they were told is seen by a camera (`photinus led --verify`). A board that sends a command back
//! as it was has acknowledged it.

mod command;
mod dialogue;
mod frame;
mod port;

pub use command::{Board, Command, Mode, start};
pub use dialogue::{Dialogue, Outcome, Step};
pub use frame::{Unframer, framed};
pub use port::{drive, open};
