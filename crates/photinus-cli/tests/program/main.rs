//! The built program from outside: what it prints, writes and exits with.

mod bad_input;
mod commands;
mod real_photos;
mod stage;
