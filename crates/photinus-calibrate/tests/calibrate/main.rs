//! Calibrations against simulations, other programs, and real photos.

mod airframe_light;
mod consistency;
mod flight;
mod grid_photos;
mod independent;
mod optics;
mod ordering;
mod photos;
mod photos_optics;
mod pose_photos;
mod rendered_leds;
mod simulation;
mod spot_sizes_of_a_simulated_led;
