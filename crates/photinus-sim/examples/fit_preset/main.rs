//! Fits the presets: the paper's camera to the paper's numbers, another one to photos.

#![allow(clippy::print_stdout, reason = "a program that reports")]

mod paper;
mod photos;
mod search;

fn main() {
    paper::fit();
    photos::fit();
}
