//! Controllers, the safety layer and mutual localization, tried on point masses that share no code with them.

mod controllers;
mod flight;
mod from_camera;
mod mutual;
mod safety;
