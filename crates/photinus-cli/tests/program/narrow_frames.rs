//! Frames of odd shapes are drawn in bounded memory: the program runs under a limit.
#![cfg(unix)]

use std::process::Command;

use photinus_io::image::read_image;

use crate::stage::Stage;

/// Address space that the program may take, kB: 120 MB for a picture, as much for its bytes as PNG, and the threads' stacks.
const LIMIT_KB: u32 = 800_000;

#[test]
fn a_narrow_frame_takes_no_more_memory_than_a_square_one() {
    let stage = Stage::new("narrow");
    for (columns, rows) in [(1_usize, 32_767_usize), (32_767, 1), (64, 4096), (1, 1), (4096, 4096)] {
        let mut bytes = format!("P5\n{columns} {rows}\n255\n").into_bytes();
        bytes.resize(bytes.len() + columns * rows, 9);
        stage.file("narrow.pgm", bytes);
        let program = env!("CARGO_BIN_EXE_photinus");
        let limited =
            format!("ulimit -v {LIMIT_KB} && exec {program} detect narrow.pgm --overlay {columns}x{rows}");
        let done = Command::new("sh").args(["-c", &limited]).current_dir(stage.path("")).output().unwrap();
        assert!(done.status.success(), "{columns}x{rows}: {}", String::from_utf8_lossy(&done.stderr));
        let picture = read_image(stage.path(&format!("{columns}x{rows}/overlay-narrow.png"))).unwrap().image;
        assert!(picture.width() >= 300 && picture.height() >= 480, "{columns}x{rows}");
        assert!(picture.width() <= 6800 && picture.height() <= 4400, "{columns}x{rows}");
    }
}
