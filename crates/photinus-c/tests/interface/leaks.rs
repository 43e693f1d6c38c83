//! Frame after frame, tracks and results read each time: the heap of the process, by the C library's own count, holds not a byte more.

use crate::compiled::{Program, Under};

fn many(frames: u32) {
    if let Some(program) = Program::compile("tests/interface/many.c", Under::Nothing) {
        let told = program.run(&[&frames.to_string()]);
        assert!(told.ends_with("heap +0 bytes\n"), "{told}");
    }
}

#[test]
fn thousands_of_frames_leave_nothing_behind() {
    many(5_000);
}

#[test]
#[ignore = "minutes: cargo test --release -p photinus-c --test interface -- --ignored"]
fn a_million_frames_leave_nothing_behind() {
    many(1_000_000);
}
