//! A program that is killed while it records loses no more than the last second.

use std::io::{BufRead, BufReader, Write};
use std::process::{Command, Stdio};
use std::time::Duration;

use photinus_io::frames::Moved;
use photinus_io::image::GreyImage;
use photinus_link::messages::Viewpoint;
use photinus_link::recording::{Frames, Located, Recorder, Settings, recover};
use rand_pcg::Pcg64;
use rand_pcg::rand_core::Rng;

use crate::sample;

const TARGET: &str = "PHOTINUS_RECORD_UNTIL_KILLED";
/// On the clock of the recording, which runs faster than that of the room.
const FRAMES_PER_SECOND: u64 = 20;

fn pixels(frame: u64) -> GreyImage {
    GreyImage::new((0..32 * 32).map(|place| (place * 7 + frame * 31) as u8).collect(), 32, 32)
        .expect("a size")
}

/// Not a test of its own: the program that is killed. It says the number of each frame once that is handed to the recorder.
#[test]
fn the_program_that_is_killed() {
    let Some(path) = std::env::var_os(TARGET) else { return };
    let mut recorder = Recorder::create(path, Settings::default(), None).expect("a file");
    let mut said = std::io::stdout();
    for frame in 0_u64.. {
        let record = sample::record(frame, frame as f64 / FRAMES_PER_SECOND as f64);
        let image = pixels(frame);
        let located =
            Located { record: &record, image: Some(image.view()), gravity: None, moved: Moved::default() };
        let view = Viewpoint::new(Some("left"), None);
        recorder.located(&located, &view, frame * 1_000_000_000 / FRAMES_PER_SECOND).expect("it is written");
        writeln!(said, "frame {frame}").and_then(|()| said.flush()).expect("somebody listens");
    }
}

#[test]
fn all_but_the_last_second_outlives_a_kill_at_any_moment() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut random = Pcg64::new(11, 7);
    let mut longest = 0;
    for case in 0..100 {
        let path = folder.path().join(format!("{case}.mcap"));
        let mut child = Command::new(std::env::current_exe().expect("a program"))
            .args(["--exact", "killed::the_program_that_is_killed", "--nocapture"])
            .env(TARGET, &path)
            .stdout(Stdio::piped())
            .spawn()
            .expect("it starts");
        let mut said = BufReader::new(child.stdout.take().expect("a pipe")).lines().map_while(Result::ok);
        // It is under way, ...
        let begun = said.by_ref().any(|line| line.ends_with("frame 0"));
        assert!(begun, "case {case}");
        // ... and dies at any moment.
        std::thread::sleep(Duration::from_micros(u64::from(random.next_u32() % 60_000)));
        child.kill().expect("it runs");
        child.wait().expect("it is gone");
        let number = |line: String| line.strip_prefix("frame ")?.parse::<u64>().ok();
        let last = said.filter_map(number).last().unwrap_or(0);
        longest = longest.max(last);
        let mended = folder.path().join(format!("{case}.mended.mcap"));
        recover(&path, &mended).expect("it is mended");
        let frames = Frames::open(&mended, None).map(Iterator::collect::<Vec<_>>).unwrap_or_default();
        let read: Vec<u64> = frames.iter().map(|frame| frame.as_ref().expect("a frame").index).collect();
        assert!(read.iter().copied().eq(0..read.len() as u64), "case {case}: {read:?}");
        for (frame, index) in frames.iter().zip(0..) {
            assert_eq!(frame.as_ref().expect("a frame").image, pixels(index), "case {case}");
        }
        let missing = (last + 1).saturating_sub(read.len() as u64);
        assert!(missing <= FRAMES_PER_SECOND, "case {case}: {} of {}", read.len(), last + 1);
        std::fs::remove_file(&path).and_then(|()| std::fs::remove_file(&mended)).expect("they are there");
    }
    assert!(longest > 3 * FRAMES_PER_SECOND, "no run was long enough to tell: {longest} frames");
}
