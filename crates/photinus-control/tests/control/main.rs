//! Controllers, the safety layer and mutual localization, tried on point masses that share no code with them.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

mod controllers;
mod flight;
mod from_camera;
mod mutual;
mod safety;
