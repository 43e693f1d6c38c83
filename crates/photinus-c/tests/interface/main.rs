//! The library as C and C++ see it: their programs, compiled with warnings as errors, run plainly, under AddressSanitizer and under valgrind.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod compiled;
mod header;
mod installed;
mod leaks;
mod programs;
mod same_bits;
mod shown;
