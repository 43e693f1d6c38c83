//! A long stream does not grow the program. By hand: `cargo test --release -p photinus-cli --test program -- --ignored soak`.

use std::io::Write;
use std::process::Stdio;

use crate::stage::{Stage, video};

/// Memory of a process, KiB.
fn resident_kib(process: u32) -> u64 {
    let status = std::fs::read_to_string(format!("/proc/{process}/status")).unwrap();
    let line = status.lines().find(|line| line.starts_with("VmRSS")).unwrap();
    line.split_whitespace().nth(1).unwrap().parse().unwrap()
}

/// Feeds so many frames and gives the memory after a tenth of them and at their end.
fn fed(frames: usize) -> (u64, u64) {
    let stage = Stage::new("soak");
    let words = "locate - --camera camera.toml --airframe hexa.toml --out r.jsonl -q";
    let mut child = stage.command(words).stdin(Stdio::piped()).spawn().unwrap();
    let mut input = child.stdin.take().unwrap();
    let header = video(0);
    let frame = video(1)[header.len()..].to_vec();
    input.write_all(&header).unwrap();
    let mut early_kib = 0;
    for number in 0..frames {
        input.write_all(&frame).unwrap();
        if number == frames / 10 {
            early_kib = resident_kib(child.id());
        }
    }
    let late_kib = resident_kib(child.id());
    drop(input);
    assert!(child.wait().unwrap().success());
    assert_eq!(stage.read("r.jsonl").lines().count(), frames);
    println!("{frames} frames: {early_kib} KiB after a tenth, {late_kib} KiB at the end");
    (early_kib, late_kib)
}

#[cfg(target_os = "linux")]
#[test]
fn memory_stays_flat() {
    let (early_kib, late_kib) = fed(6_000);
    // 104 bytes a frame would be 560 KiB.
    assert!(late_kib < early_kib + 256, "{early_kib} KiB grew to {late_kib} KiB");
}

#[cfg(target_os = "linux")]
#[test]
#[ignore = "minutes: by hand, with --release"]
fn soak() {
    let (early_kib, late_kib) = fed(200_000);
    assert!(late_kib < early_kib + 512, "{early_kib} KiB grew to {late_kib} KiB");
}
