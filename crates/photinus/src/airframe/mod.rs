//! Where the LEDs of a neighbour sit and how they shine.
