//! The program `photinus`.

fn main() {}
